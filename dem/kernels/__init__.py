"""The step of the discs on flat arrays: contacts, motion, energies; they know NumPy and Numba only."""
