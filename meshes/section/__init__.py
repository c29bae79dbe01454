"""Describes the ground in a section file: strata between lines, quantities with units, water."""

from meshes.section.layering import Layering
from meshes.section.naming import BOUNDARIES
from meshes.section.polyline import Line
from meshes.section.section import Model, Section, Stratum
from meshes.section.toml_file import read_toml

__all__ = ["BOUNDARIES", "Layering", "Line", "Model", "Section", "Stratum", "read_toml"]
