"""Handles uncertain numbers of the input: their distributions, their places, and samples of them."""
