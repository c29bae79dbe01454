"""Computes the slide of a few hundred discs of S-13 after layers 4 and 6 have liquefied."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection

from dem import Case, DemSettings, Slider, SlideSettings, deposit
from meshes import Section
from meshes.shipped import file_of

section = Section.read(file_of("s13"))
box = deposit(section, DemSettings(elements=300))
liquefied = [number for number, stratum in enumerate(section.strata) if 2 in stratum.liquefies_in]
slider = Slider(box.settled, box.ground, liquefied, Case(stiffness=0.02, residual=0.15), SlideSettings(duration=6.0))
end = slider.run().rows[-1]
print(f"after {end.time_s:.0f} s: slides {end.slide_max_m:.1f} m, settles {end.settlement_uphill_m:.1f} m uphill")
model, free = slider.model, ~slider.model.fixed
x, z = box.ground.to_section(model.x[free], model.z[free])
moved = np.hypot(model.x - box.settled.x, model.z - box.settled.z)[free]
figure, axes = plt.subplots(figsize=(8.0, 2.8), layout="constrained")
size = 2.0 * model.radius[free]
discs = EllipseCollection(
    size, size, 0.0, units="x", offsets=np.column_stack([x, z]), transOffset=axes.transData, array=moved, ec="k", lw=0.2
)
axes.add_collection(discs)
axes.set(xlabel="x (m)", ylabel="elevation (m)", aspect="equal")
axes.autoscale()
discs.set_clim(0.0, 1.0)
figure.colorbar(discs, label="displacement (m)")
figure.savefig("liquefied_slide.png", dpi=110)
