"""Numbers of the input that are not known for sure: their distributions, where they stand, and samples of them."""
