"""Sections made from borings and drawings."""
