"""Computes Kh against displacement: the equilibrium path of a slope with associated flow and by Davis's estimate."""

import matplotlib.pyplot as plt

from fem import FemSettings, critical_coefficient
from meshes import MeshSettings, Section, generate
from meshes.shipped import file_of

section = Section.read(file_of("slope_2to1"))
mesh = generate(section, MeshSettings(method="mapped", columns=20, rows=8))
figure, axes = plt.subplots(figsize=(5.0, 3.2), layout="constrained")
for flow in ("associated", "davis"):
    settings = FemSettings(direction="downhill", flow=flow, element="bilinear")
    critical = critical_coefficient(section, mesh, settings)
    axes.plot(
        [step.displacement for step in critical.steps], [step.factor for step in critical.steps], ".-", label=flow
    )
    print(f"{flow}: critical Kh {critical.kc:.3f}, {critical.verdict}")
axes.set(xlabel="mean horizontal displacement (m)", ylabel="Kh")
axes.legend()
figure.savefig("equilibrium_path.png", dpi=110)
