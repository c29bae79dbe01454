"""The discs: the same question, then the slide."""

from meshes.compiled import keep_compiled_kernels

keep_compiled_kernels()
