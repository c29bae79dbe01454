"""Searches the critical Kh and the factor of safety over meshes, and checks both."""
