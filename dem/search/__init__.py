"""Finds the critical Kh of discs, and calibrates their constants to a given critical Kh."""
