"""Follows equilibrium paths: gravity first, then a load whose multiplier is an unknown, by Newton's method with arc
length."""
