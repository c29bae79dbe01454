"""Finds the contact friction with which discs have the friction angle of a soil."""

import matplotlib.pyplot as plt
import numpy as np

import dem

angles = np.arange(20.0, 45.0, 2.5)
figure, axes = plt.subplots(figsize=(5.0, 3.2), layout="constrained")
for stress in (50e3, 200e3):  # vertical effective stress (Pa)
    contacts = [dem.soil_contacts(0.0, np.radians(angle), stress, youngs_modulus=30e6) for angle in angles]
    axes.plot(angles, [contact.friction for contact in contacts], ".-", label=f"{stress / 1e3:.0f} kPa")
    print(f"{stress / 1e3:.0f} kPa: contact friction {contacts[0].friction:.2f} to {contacts[-1].friction:.2f}")
axes.plot(angles, np.tan(np.radians(angles)), "k:", label="tan φ")
axes.set(xlabel="friction angle of the soil (degrees)", ylabel="contact friction μ")
axes.legend()
figure.savefig("strength_of_discs.png", dpi=110)
