"""Layers liquefy and the ground slides: how far, where along the surface, and on which slip surface."""
