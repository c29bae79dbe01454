"""Runs element tests on a patch of discs, as on a soil sample: stiffness, strength, dilation."""
