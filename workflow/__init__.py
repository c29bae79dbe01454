"""What a person runs: commands, pictures, results on disk."""
