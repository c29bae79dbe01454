"""Estimates to compare slides with: sliding blocks, regressions over observed cases, limit equilibrium of slices."""
