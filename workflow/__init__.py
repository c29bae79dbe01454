"""Provides the program that a user runs: commands, stages, pictures, report, results on disk."""
