"""Draws the layers of S-13, and prints the area of each."""

import matplotlib.pyplot as plt

from meshes import Section
from meshes.shipped import file_of

section = Section.read(file_of("s13"))
figure, axes = plt.subplots(figsize=(8.0, 2.6), layout="constrained")
for number, stratum in enumerate(section.strata):
    for outline in section.layering.polygons(number):
        axes.fill(*outline.T, color=plt.cm.terrain(0.15 + 0.07 * number), ec="k", lw=0.5)
    area = section.layering.areas()[number]
    print(f"{stratum.name:8} {area:6.0f} m2, liquefies in {list(stratum.liquefies_in) or 'no case'}")
axes.set(xlabel="x (m)", ylabel="elevation (m)", aspect="equal")
figure.savefig("layers.png", dpi=110)
