"""The discs: the same question, then the slide."""
