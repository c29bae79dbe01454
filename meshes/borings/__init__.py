"""Reads borings: their places, the layers that they met, and the blow counts of the standard penetration test."""
