"""Equilibrium paths: gravity first, then a load that is an unknown, followed by Newton with arc length."""
