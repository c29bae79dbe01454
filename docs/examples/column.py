"""Computes the collapse of a column of dry sand: the discs before and after, and the run-out."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection

import dem

WIDTH, RADIUS = 10.0, 0.35  # m
# cohesion (Pa), friction angle (rad), vertical stress (Pa)
sand = dem.soil_contacts(0.0, np.radians(33.0), stress=1800.0 * 9.81 * 5.0)
column = dem.SoilColumn(WIDTH, WIDTH, RADIUS, lambda voids: [sand.discs("sand", 1800.0, RADIUS, voids)], reach=4.0)
column.settle()
figure, axes = plt.subplots(2, sharex=True, sharey=True, figsize=(7.0, 4.5), layout="constrained")
for axis, release in zip(axes, (False, True), strict=True):
    if release:
        column.release()
    model = column.model
    size, places = 2.0 * model.radius, np.column_stack([model.x, model.z])
    discs = EllipseCollection(size, size, 0.0, units="x", offsets=places, transOffset=axis.transData, ec="k", lw=0.3)
    axis.add_collection(discs)
    axis.set(xlim=(0.0, 35.0), ylim=(-1.5, 12.0), aspect="equal", ylabel="z (m)")
axes[1].set_xlabel("x (m)")
run_out = dem.run_out(column.model)
print(f"run-out over width {run_out.front / WIDTH - 1.0:.2f}; sand in a channel 1.2 (Lube et al. 2005)")
figure.savefig("column.png", dpi=110)
