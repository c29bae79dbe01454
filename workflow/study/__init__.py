"""Studies: many runs of one section, and what they say of it together. What if, and does it converge?"""
