"""Sections as DXF drawings: what of a drawing is ground and water, and how the ground lies in strata."""
