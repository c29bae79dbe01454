"""Slides known by theory, experiment or the field, compared with predictions (`noshiro verify --slides`)."""
