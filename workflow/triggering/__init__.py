"""Whether ground liquefies: the factor F_L at every blow count and in every stratum, and what follows from it."""
