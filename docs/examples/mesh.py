"""Makes a free mesh with smaller cells in one layer."""

import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

from meshes import MeshSettings, Section, generate
from meshes.shipped import file_of

section = Section.read(file_of("natural_slope"))
mesh = generate(section, MeshSettings(method="free", size=4.0, sizes={section.strata[1].name: 2.0}))
print(mesh.quality())
figure, axes = plt.subplots(figsize=(8.0, 3.0), layout="constrained")
cells = PolyCollection(mesh.points[mesh.cells], array=mesh.stratum, cmap="Set3", ec="k", lw=0.3)
axes.add_collection(cells)
axes.set(xlabel="x (m)", ylabel="elevation (m)", aspect="equal")
axes.autoscale()
figure.savefig("mesh.png", dpi=110)
