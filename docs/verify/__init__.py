"""Comparison of the program with published slopes (`python -m docs.verify`)."""
