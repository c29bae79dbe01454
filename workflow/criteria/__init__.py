"""Criteria: limits with their sources, and verdicts on them."""
