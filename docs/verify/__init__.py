"""Published slopes: what others found, what this program finds, and whether that is right (`python -m docs.verify`)."""
