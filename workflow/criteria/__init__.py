"""Compares results with limits that have a source, and returns verdicts."""
