"""Assesses liquefaction triggering: the factor F_L at every blow count and in every stratum, and its consequences."""
