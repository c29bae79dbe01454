"""Computes strict lower and upper bounds of the critical Kh by limit analysis, without dolfinx."""
