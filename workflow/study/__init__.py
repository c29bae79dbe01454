"""Computes studies: many samples of one section, their statistics, and convergence."""
