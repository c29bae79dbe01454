"""Contains the kernels of the finite elements, which work on flat arrays. They import only NumPy and Numba."""
