"""Solvers of linear systems and cone programs, the interface to dolfinx, and threads of BLAS."""
