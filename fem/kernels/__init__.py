"""Kernels of the finite elements, which work on flat arrays. They import only NumPy and Numba."""
