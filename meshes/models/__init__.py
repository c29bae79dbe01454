"""Models of other programs, read as sections."""
