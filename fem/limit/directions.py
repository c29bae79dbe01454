"""Finds bounds of Kh with the seismic force to either side: the smaller Kh counts, and the bounds of both directions
are stored.

The two directions share the allowed computing work. The next mesh is always made for the direction whose lower bound is
the smaller one, until the bounds of the smaller Kh are within the required gap. For the other direction the search only
proves that its critical Kh is larger.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fem.continuum.loads import Direction, counting_directions
from fem.limit.adaptive_bounds import BoundSearch
from fem.limit.bracket import Bracket, Limits, Mechanism
from fem.limit.limit_problem import RigidPlasticBody
from fem.settings import Sides
from meshes.section.section import Section
from meshes.triangles import TriMesh

# A mechanism leaves the section through a side that moves with at least this share of the largest velocity.
LEAVING_VELOCITY = 0.1

SectionSide = Literal["left", "right"]


@dataclass(frozen=True, eq=False)
class DirectionBounds(Bracket):
    """Holds the bounds of Kh in one direction of the seismic force.

    Attributes
    ----------
    direction : direction of the seismic force, "downhill" or "uphill" by the ends of the surface
    towards : side of the section, "left" or "right", towards which the seismic force acts
    leaves : sides through which the mechanism leaves the section
    """

    direction: Direction = "downhill"
    towards: SectionSide = "right"
    leaves: tuple[SectionSide, ...] = ()


@dataclass(frozen=True, eq=False)
class SmallerKhBounds(Bracket):
    """Holds the bounds of the smallest critical Kh over the directions of the seismic force.

    As in the finite elements, directions whose mechanisms leave the section through a side count as in
    `counting_directions`: the side is where the section was cut off.

    Attributes
    ----------
    directions : the bounds of every direction, first those of the direction that fails at the smaller Kh
    """

    directions: tuple[DirectionBounds, ...] = ()


# Called with the bounds after every mesh.
KhObserver = Callable[[SmallerKhBounds], None]


class DirectionSearch(BoundSearch):
    """Searches the bounds in one direction of the seismic force."""

    def __init__(
        self, mesh: TriMesh, body: RigidPlasticBody, limits: Limits, direction: Direction, towards: SectionSide
    ) -> None:
        """Prepare the search on ``mesh`` for the bounds of ``body``, within ``limits``; the seismic force acts in
        ``direction``, on the side ``towards``.
        """
        super().__init__(mesh, body, limits)
        self.direction, self.towards = direction, towards

    @property
    def bounds(self) -> DirectionBounds:
        """Return the best bounds of the search so far."""
        leaves = sides_left_through(self.bracket.mechanism) if self.bracket.mechanism else ()
        return DirectionBounds(**vars(self.bracket), direction=self.direction, towards=self.towards, leaves=leaves)


def sides_left_through(mechanism: Mechanism) -> tuple[SectionSide, ...]:
    """Return the sides of the section that move by more than a tenth of the largest velocity; none if the section
    repeats."""
    mesh = mechanism.problem.mesh
    if mesh.repeats:
        return ()
    speed = np.zeros(len(mesh.points))
    speed[mesh.cells] = np.hypot(*np.moveaxis(mechanism.velocity[:, :3], -1, 0))
    sides: tuple[SectionSide, ...] = ("left", "right")
    return tuple(
        side for side in sides if speed[mesh.boundaries[side]].max(initial=0.0) > LEAVING_VELOCITY * speed.max()
    )


def smaller_of(section: Section, side_condition: Sides, directions: Iterable[DirectionBounds]) -> SmallerKhBounds:
    """Return the bounds of the smallest critical Kh of a section over the directions that `counting_of` selects.

    Computing work and meshes are those of the direction with the smallest upper bound.
    """
    order = sorted(directions, key=lambda bounds: (bounds.upper, bounds.lower))
    counting = counting_of(section, side_condition, order)
    weakest = min(counting, key=lambda bounds: bounds.lower)
    first = counting[0]
    rest = tuple(bounds for bounds in order if bounds is not first)
    return SmallerKhBounds(
        stress=weakest.stress,
        mechanism=first.mechanism,
        meshes=first.meshes,
        mesh=first.mesh,
        end_reason=weakest.end_reason,
        open_at=weakest.open_at,
        directions=(first, *rest),
    )


def counting_of(
    section: Section, side_condition: Sides, directions: Sequence[DirectionBounds]
) -> list[DirectionBounds]:
    """Return the directions whose bounds count for the smaller Kh of a section."""
    counting = counting_directions(section, side_condition, {bounds.direction: bounds.leaves for bounds in directions})
    return [bounds for bounds in directions if bounds.direction in counting]


def search_all(
    section: Section,
    side_condition: Sides,
    searches: Sequence[DirectionSearch],
    limits: Limits,
    observer: KhObserver | None = None,
) -> SmallerKhBounds:
    """Find the bounds of the smallest Kh of a section over all ``searches``, which share the work of ``limits``.

    ``side_condition``: condition on the sides, by which a direction counts or not; ``observer`` is called with the
    bounds found so far.
    """
    while True:
        for search in searches:
            if not search.bracket.meshes:
                search.advance(_work_of_others(search, searches))
        smaller = smaller_of(section, side_condition, [search.bounds for search in searches])
        if observer:
            observer(smaller)
        if limits.open(smaller.lower, smaller.upper) <= 1.0:
            return replace(smaller, end_reason="gap", open_at=None)
        counting = {bounds.direction for bounds in counting_of(section, side_condition, smaller.directions)}
        open_searches = [
            search
            for search in searches
            if search.bracket.end_reason is None
            and search.bracket.lower < smaller.upper
            and search.direction in counting
        ]
        if smaller.upper < limits.sufficient_upper or not open_searches:
            return smaller
        search = min(open_searches, key=lambda candidate: candidate.bracket.lower)
        search.advance(_work_of_others(search, searches))


def _work_of_others(search: DirectionSearch, searches: Sequence[DirectionSearch]) -> float:
    return sum(other.work for other in searches if other is not search)
