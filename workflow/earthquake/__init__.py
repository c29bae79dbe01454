"""Provides the earthquake at the site: magnitude, distance, peak acceleration, records and site response."""
