"""Answers in words: the page, the terminal, the summary, the table of the paper."""
