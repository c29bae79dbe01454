"""Reads and writes sections as DXF drawings: decides which shapes of a drawing are ground and water, and divides the
ground into strata."""
