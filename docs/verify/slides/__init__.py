"""Compares predictions with slides known from theory, experiments and the field (`python -m docs.verify --slides`)."""
