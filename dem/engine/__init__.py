"""The machine around the kernels: it packs a model, steps it, checks it and keeps its energy balance."""
