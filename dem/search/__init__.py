"""At which Kh discs fail, and which of their constants make them fail at a Kh that is given."""
