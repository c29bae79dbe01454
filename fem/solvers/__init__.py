"""Solves linear systems and cone programs, and provides the interface to dolfinx and the control of BLAS threads."""
