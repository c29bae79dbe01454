"""Kernels that compute one step of the discs on flat arrays: contacts, motion and energies. They import only NumPy and
Numba."""
