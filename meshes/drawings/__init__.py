"""Sections as DXF drawings: which shapes of a drawing are ground and water, and how the ground is divided into
strata."""
