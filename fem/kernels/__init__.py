"""The laws and sums of the finite elements on flat arrays; they know NumPy and Numba only."""
