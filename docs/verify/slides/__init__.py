"""Slides known by theory, experiment or the field, compared with predictions (`python -m docs.verify --slides`)."""
