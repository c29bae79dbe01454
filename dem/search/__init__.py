"""Critical Kh of discs, and calibration of their constants to a given critical Kh."""
