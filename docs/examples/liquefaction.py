"""Computes the factor against liquefaction F_L over depth from blow counts (Idriss & Boulanger 2008)."""

import matplotlib.pyplot as plt

from workflow.earthquake.triggering.blow_count import BlowCount, SurfaceMotion
from workflow.earthquake.triggering.idriss_boulanger import assess

shaking = SurfaceMotion(magnitude=7.7, peak=0.2)  # peak acceleration over g
figure, axes = plt.subplots(figsize=(4.0, 3.6), layout="constrained")
for count in (6, 12, 20):
    depths = [2.0 + step for step in range(12)]
    tests = [BlowCount(z, count, 19.0 * z, 19.0 * z - 9.81 * (z - 1.0), fines=5.0) for z in depths]
    safety = [assess(test, shaking, 60.0, 1.5).factor for test in tests]
    axes.plot(safety, depths, ".-", label=f"N = {count}")
    print(f"N = {count}: F_L from {min(safety):.2f} to {max(safety):.2f}")
axes.axvline(1.0, color="k", lw=0.8)
axes.set(xlabel="F_L", ylabel="depth (m)", xlim=(0.0, 2.0))
axes.invert_yaxis()
axes.legend()
figure.savefig("liquefaction.png", dpi=110)
