"""Limit analysis: strict lower and upper bounds of the critical Kh; it does without dolfinx."""
