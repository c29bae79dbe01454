"""Runs the kernels: packs a model, integrates its motion, checks it and keeps its energy balance."""
