"""Draws the pictures of the results."""
