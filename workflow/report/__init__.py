"""States results in words: report page, terminal, summary, comparison with the paper."""
