"""The answers that stages leave behind, each read and written in one place."""
