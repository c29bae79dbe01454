"""Computes the slide of Newmark's block under a decaying record for several yield coefficients."""

import matplotlib.pyplot as plt
import numpy as np

from workflow.estimates.sliding_block import newmark

time = np.linspace(0.0, 20.0, 2001)
record = 3.0 * np.sin(2.0 * np.pi * 1.2 * time) * np.exp(-0.15 * time)  # m/s2
yields = np.linspace(0.02, 0.3, 15)
slides = [newmark(time, record, float(kc)).permanent for kc in yields]
for kc, slide in list(zip(yields, slides, strict=True))[::5]:
    print(f"kc = {kc:.2f}: {100.0 * slide:.1f} cm")
figure, (above, below) = plt.subplots(2, figsize=(5.0, 4.0), layout="constrained")
above.plot(time, record, lw=0.8)
above.set(xlabel="time (s)", ylabel="acceleration (m/s²)")
below.semilogy(yields, np.maximum(slides, 1e-4), "o-")
below.set(xlabel="yield coefficient kc", ylabel="slide (m)")
figure.savefig("newmark.png", dpi=110)
