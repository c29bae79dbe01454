"""Translates the texts of reports, pictures and the console from one catalogue."""
