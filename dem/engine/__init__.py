"""The engine around the kernels: it packs a model, integrates its motion, checks it and keeps its energy balance."""
