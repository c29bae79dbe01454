"""Computes one step of the discs on flat arrays: contacts, motion and energies (kernels), and imports only NumPy and
Numba."""
