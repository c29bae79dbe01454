"""The continuum: at which seismic coefficient the section fails, and where."""
