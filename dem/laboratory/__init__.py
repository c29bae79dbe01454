"""A patch of discs tested as a sample of soil is: stiffness, strength, dilation."""
