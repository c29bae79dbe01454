"""What an answer is compared with: structures that matter, limits with their sources, and the verdict."""
