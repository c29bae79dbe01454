"""The stored answers of the stages, each read and written in one place."""
