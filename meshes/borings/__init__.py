"""What was bored: where, which layers were met, and the blow counts of the standard penetration test."""
