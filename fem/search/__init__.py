"""The search for the critical Kh and the factor of safety over meshes, and the checks of both."""
