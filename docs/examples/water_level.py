"""Computes the factor of safety of a river bank, without shaking, for several levels of the river."""

import matplotlib.pyplot as plt

from fem import FemSettings, safety_factor
from meshes import MeshSettings, Section, generate

SILT = {
    "name": "silt", "density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3", "cohesion": "8 kPa",
    "friction_angle": "30 deg", "youngs_modulus": "20 MPa", "poissons_ratio": 0.33,
}  # fmt: skip
levels, factors = (0.0, 4.0, 8.0), []
for level in levels:
    water = {"table": [[0.0, 8.0], [20.0, 8.0], [20.0 + 2.0 * (10.0 - level), level], [60.0, level]]}
    surface = [[0.0, 10.0], [20.0, 10.0], [40.0, 0.0], [60.0, 0.0]]
    data = {"name": "bank", "surface": surface, "base": {"elevation": -4.0}, "water": water, "strata": [SILT]}
    section = Section.parse(data)
    mesh = generate(section, MeshSettings(method="free", size=2.5))
    factors.append(safety_factor(section, mesh, FemSettings(direction="downhill"), 0.0).factor)
    print(f"river at {level:.0f} m: factor of safety {factors[-1]:.2f}")
figure, axes = plt.subplots(figsize=(5.0, 3.2), layout="constrained")
axes.plot(levels, factors, "o-")
axes.set(xlabel="level of the river above the toe (m)", ylabel="factor of safety (ψ = φ)")
figure.savefig("water_level.png", dpi=110)
