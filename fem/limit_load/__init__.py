"""Computes the limit load of a mesh without an equilibrium path, by second-order cone programming."""
