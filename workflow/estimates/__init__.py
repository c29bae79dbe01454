"""Estimates displacements with which slides are compared: sliding blocks, regressions over observed cases, limit
equilibrium of slices."""
