"""Provides meshes of several kinds for tests."""

from typing import Any

from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support import SECTIONS

SHIPPED = sorted(SECTIONS.glob("*.toml"))


def s13() -> Section:
    return Section.read(SECTIONS / "s13.toml")


def grid(columns: int = 47, rows: int = 13, **values: Any) -> MeshSettings:
    return MeshSettings(method="mapped", columns=columns, rows=rows, **values)


def free(section: Section, cells: float = 300.0, **values: Any) -> MeshSettings:
    """Return a free mesh with about this number of cells."""
    return MeshSettings(method="free", size=float(section.layering.areas().sum() / cells) ** 0.5, **values)
