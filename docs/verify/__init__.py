"""Compares the program with published slopes and known slides (`python -m docs.verify`)."""
