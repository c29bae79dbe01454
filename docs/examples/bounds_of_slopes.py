"""Computes strict bounds of the critical Kh of a slope 10 m high for several inclinations."""

import matplotlib.pyplot as plt

from fem import BoundsSettings, FemSettings, kh_bounds
from meshes import Section

SOIL = {
    "name": "soil", "density": "1.9 t/m^3", "cohesion": "15 kPa", "friction_angle": "25 deg",
    "youngs_modulus": "20 MPa", "poissons_ratio": 0.3,
}  # fmt: skip
inclinations, rows = (20.0, 30.0, 40.0), []
for beta in inclinations:
    width = {20.0: 27.5, 30.0: 17.3, 40.0: 11.9}[beta]
    surface = [[0.0, 10.0], [20.0, 10.0], [20.0 + width, 0.0], [40.0 + width, 0.0]]
    data = {"name": "slope", "surface": surface, "base": {"elevation": -5.0}, "strata": [SOIL]}
    settings = FemSettings(sides="fixed", direction="downhill")
    bounds = kh_bounds(Section.parse(data), settings, BoundsSettings(gap=0.1, max_cells=1500, davis=False))
    rows.append((bounds.lower, bounds.upper))
    print(f"{beta:.0f} degrees: {bounds.lower:.3f} to {bounds.upper:.3f}")
figure, axes = plt.subplots(figsize=(5.0, 3.2), layout="constrained")
axes.fill_between(inclinations, *zip(*rows, strict=True), alpha=0.4)
axes.set(xlabel="inclination (degrees)", ylabel="critical Kh", title="lower and upper bound")
figure.savefig("bounds_of_slopes.png", dpi=110)
