"""What an answer is held against: structures that matter, limits with their sources, and the verdict."""
