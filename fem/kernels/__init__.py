"""Contains the kernels of the finite elements, which work on flat arrays and import only NumPy and Numba."""
