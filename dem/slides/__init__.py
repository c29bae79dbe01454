"""Computes slides after liquefaction of layers: displacement along the surface, and slip surface."""
