"""Stores the answers of the stages; each answer is read and written in one place."""
