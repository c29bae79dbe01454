"""The continuum: at which seismic coefficient the section fails, and where."""

from meshes.compiled import keep_compiled_kernels

keep_compiled_kernels()
