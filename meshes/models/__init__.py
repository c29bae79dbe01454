"""Reads models of other programs as sections."""
