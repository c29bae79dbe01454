"""Represents the ground as a discretised continuum: elements, loads, strengths and fields."""
