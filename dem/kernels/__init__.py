"""Computes one step of the discs on flat arrays: contacts, motion and energies (kernels). It imports only
NumPy and Numba."""
