"""Slides known by theory, experiment or the field, and how far discs have them run (`noshiro verify --slides`)."""
