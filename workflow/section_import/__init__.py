"""Makes sections from borings and drawings."""
