"""Searches the critical Kh and the factor of safety on a sequence of meshes, and checks both."""
