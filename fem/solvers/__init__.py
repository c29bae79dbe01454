"""What solves: linear and conic solvers, the two interfaces of dolfinx, threads, and work side by side."""
