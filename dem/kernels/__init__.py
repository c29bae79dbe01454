"""Computes one step of the discs on flat arrays: contacts, motion and energies (kernels). The package imports only NumPy
and Numba."""
