"""Describes structures of a section, each a table [[structures]], at which a failure matters."""

from collections.abc import Sequence
from typing import Literal

from pydantic import ConfigDict, Field

from meshes.section.model import Model
from meshes.section.quantity import Coordinate

Kind = Literal["levee", "embankment", "dam", "quay", "bank", "building", "other"]


class Structure(Model):
    """Holds a structure, or ground that carries one, between two places of the section."""

    model_config = ConfigDict(populate_by_name=True)

    name: str = Field(min_length=1, description="name of the structure, such as main levee")
    start: Coordinate = Field(alias="from", description="x of the left foot of the structure, such as 56.0")
    end: Coordinate = Field(alias="to", description="x of the right foot of the structure, such as 86.0")
    kind: Kind = Field(
        default="other",
        description='kind of the structure: "levee", "embankment", "dam", "quay", "bank", "building" or "other"',
    )


def structure_problems(structures: Sequence[Structure], extent: tuple[float, float]) -> list[str]:
    """Return what is wrong with structures of a section that reaches from ``extent[0]`` to ``extent[1]`` (m)."""
    left, right = extent
    problems = []
    for k, structure in enumerate(structures, start=1):
        key = f'structures {k} "{structure.name}", from = {structure.start:g} m, to = {structure.end:g} m'
        if not structure.end > structure.start:
            problems.append(f"{key}: expected the left foot, then the right foot")
        elif structure.start < left or structure.end > right:
            problems.append(f"{key}: lies off the section, which reaches from {left:g} to {right:g} m")
    names = [structure.name for structure in structures]
    return problems + [
        f'structures: {names.count(name)} structures are called "{name}"; expected different names'
        for name in dict.fromkeys(names)
        if names.count(name) > 1
    ]
