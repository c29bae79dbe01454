"""Reads lines across a section: points from left to right, as elevations or as depths below the surface."""

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer, PlainValidator, model_validator

from meshes.section.quantity import COORDINATE, NUMBER_AND_UNIT, Quantity

Points = tuple[tuple[float, float], ...]
SAME_PLACE = 1e-9  # m: points that are no farther apart along x lie at one place
MOST_ALIKE = 3  # points out of order that are named one by one


def read_points(value: Any) -> Points:
    """Read points [[x, z], ...] in metres from left to right; two points may have the same x to make a vertical step.

    Raises ValueError with every problem of the line, one on each line of the message.
    """
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise ValueError("expected two or more points [[x, z], ...] from left to right")
    points = pairs_of(value)
    if problems := _order_problems(points):
        raise ValueError("\n".join(problems))
    return tuple(points)


def pairs_of(value: Sequence[Any]) -> list[tuple[float, float]]:
    """Return the points (m) in a list. Raises ValueError with every entry that is no pair of coordinates."""
    problems: list[str] = []
    points: list[tuple[float, float]] = []
    for number, point in enumerate(value, start=1):
        if not isinstance(point, list | tuple) or len(point) != 2:
            problems.append(f"point {number} = {point!r}: expected a pair [x, z]")
            continue
        pair = []
        for name, entry in zip("xz", point, strict=True):
            try:
                pair.append(COORDINATE.read(entry))
            except ValueError as error:
                problems.append(f"point {number}, {name} = {entry!r}: {error}")
        if len(pair) == 2:
            points.append((pair[0], pair[1]))
    if problems or (problems := _unit_problems(value)):
        raise ValueError("\n".join(problems))
    return points


def _unit_problems(value: Sequence[Any]) -> list[str]:
    """Return the coordinates of a list in which some have a unit other than metres, and others no unit: a plain number
    is in metres, and the person who wrote it probably meant the unit beside it."""
    problems = []
    for column, name in enumerate("xz"):
        entries = [COORDINATE.read(pair[column]) for pair in value]
        plain = [place for place, entry in enumerate(entries) if entry and not isinstance(entry.written, str)]
        foreign = [entry.written for entry in entries if isinstance(entry.written, str) and _is_foreign(entry)]
        if plain and foreign:
            problems.append(
                f"point {plain[0] + 1}, {name} = {entries[plain[0]]:g}: has no unit, beside {foreign[0]!r}; "
                f'expected one unit for every {name} of the line (a plain number is in m; write "... m" to mix units)'
            )
    return problems


def _is_foreign(entry: Quantity) -> bool:
    """Return whether a coordinate was written in a unit other than metres; 0 is 0 in all units."""
    parts = NUMBER_AND_UNIT.fullmatch(str(entry.written))
    return bool(entry) and parts is not None and float(parts[1]) != float(entry)


def _order_problems(points: Sequence[tuple[float, float]]) -> list[str]:
    problems = []
    x = [point[0] for point in points]
    for i in range(1, len(x)):
        if x[i] < x[i - 1]:
            problems.append(
                f"point {i + 1} at x = {x[i]:g} m stands after x = {x[i - 1]:g} m: expected points from left to right"
            )
        if i > 1 and x[i] == x[i - 1] == x[i - 2]:
            problems.append(f"three points at x = {x[i]:g} m: expected at most two, which make a vertical step")
    if (more := len(problems) - MOST_ALIKE) > 0:
        problems[MOST_ALIKE:] = [f"and {more:,} more points of this kind"]
    if not problems and x[0] == x[-1]:
        problems.append(f"all points at x = {x[0]:g} m: expected a line from left to right")
    if not problems and (x[0] == x[1] or x[-1] == x[-2]):
        problems.append(
            "a vertical step at the end of the line: expected the line to continue horizontally after the step"
        )
    return problems


def _read_points_or_level(value: Any) -> Points | float:
    return read_points(value) if isinstance(value, list | tuple) else COORDINATE.read(value)


def written(value: Any) -> Any:
    """Return points or a number in the form of a file."""
    if isinstance(value, tuple):
        return [written(entry) for entry in value]
    return getattr(value, "written", value)


Polyline = Annotated[Points, PlainValidator(read_points), PlainSerializer(written)]
PolylineOrLevel = Annotated[Any, PlainValidator(_read_points_or_level), PlainSerializer(written)]


class Line(BaseModel):
    """Holds a line given as ``elevation`` or as ``depth`` below the ground surface (m, positive downwards).

    Elevation and depth are each a list of points [[x, z], ...], or one number that applies across the section.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    elevation: PolylineOrLevel | None = Field(default=None, description="elevations (m): points [[x, z], ...] or one")
    depth: PolylineOrLevel | None = Field(
        default=None, description="depths below the ground (m): points [[x, depth], ...] or one, 0 or more"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> "Line":
        if (self.elevation is None) == (self.depth is None):
            raise ValueError("expected either elevation or depth")
        if any(depth < 0 for depth in (z for _, z in self.depth_points)):
            raise ValueError("a negative depth is above the ground: expected depths of 0 or more")
        return self

    @property
    def depth_points(self) -> Points:
        """Return the points of a line given as depth, of which a constant is one point; nothing for elevations."""
        if self.depth is None:
            return ()
        return self.depth if isinstance(self.depth, tuple) else ((0.0, self.depth),)

    def points(self, left: float, right: float) -> np.ndarray:
        """Return the points as an (n, 2) array. A constant reaches from ``left`` to ``right`` (m)."""
        value = self.elevation if self.depth is None else self.depth
        if isinstance(value, tuple):
            return np.array(value, dtype=float)
        return np.array([[left, value], [right, value]], dtype=float)


def _elevation_or_line(value: Any) -> Any:
    return value if isinstance(value, dict | Line) else {"elevation": value}


# A line that may be written as its elevation alone: points, or one number.
ElevationOrLine = Annotated[Line, BeforeValidator(_elevation_or_line)]


def limits(points: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the values of a polyline (n, 2) just left and just right of each x; they differ at its vertical steps.

    Outside the range of the polyline its end segments continue; callers cut them off.
    """
    px, pz = points[:, 0], points[:, 1]

    def on_segment(first: np.ndarray) -> np.ndarray:
        first = np.clip(first, 0, len(px) - 2)
        # At the ends of a line the clipped segment may be a vertical step only if input was not validated.
        share = (x - px[first]) / (px[first + 1] - px[first])
        return (1.0 - share) * pz[first] + share * pz[first + 1]

    left = on_segment(np.searchsorted(px, x, side="left") - 1)
    right = on_segment(np.searchsorted(px, x, side="right") - 1)
    return left, right


def crossings(
    x: np.ndarray, first: np.ndarray, last: np.ndarray, least: float = 0.0, *, snap: float = -np.inf
) -> np.ndarray:
    """Return the x (m) where two lines cross between breakpoints ``x`` (n,), more than ``snap`` (m) from both of them.

    The distances of the lines at the ends of the intervals are ``first`` and ``last`` (n - 1,) in m. Lines nearer than
    ``least`` (m) at an end do not count as crossing there.
    """
    i = np.flatnonzero((first * last < 0.0) & (np.minimum(abs(first), abs(last)) > least))
    at = x[i] + (x[i + 1] - x[i]) * first[i] / (first[i] - last[i])
    return np.asarray(at[(at - x[i] > snap) & (x[i + 1] - at > snap)])


def points_at(line: np.ndarray, x: float) -> np.ndarray:
    """Return the points of a line at a place.

    Parameters
    ----------
    line (n, 2) : points of the line from left to right (m)
    x : place (m)

    Returns
    -------
    Points (k, 2) in m from left to right: both ends of a vertical step, or one point.
    """
    there = line[np.abs(line[:, 0] - x) < SAME_PLACE]
    return there if len(there) else np.array([[x, np.interp(x, *line.T)]])


def without_repeats(points: np.ndarray) -> np.ndarray:
    """Return the points of a line without those that are equal to the point before them.

    Parameters
    ----------
    points (n, 2) : points of the line

    Returns
    -------
    Points (k, 2).
    """
    return points[np.concatenate([[True], np.any(np.diff(points, axis=0) != 0.0, axis=1)])]


def downhill(ground: np.ndarray) -> int:
    """Return the direction in which a surface falls from one end to the other.

    Slides of discs and of material points, and the shaking that drives them, are positive in this direction, in
    whichever direction the finite elements fail.

    Parameters
    ----------
    ground (n, 2) : points of the surface from left to right (m)

    Returns
    -------
    +1 if the right end is as high as the left one or lower, -1 if it is higher.
    """
    return 1 if ground[0, 1] >= ground[-1, 1] else -1


def level_at(level: np.ndarray, x: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Return the elevations (n,) of a level (k, 2) at x. The level continues horizontally beyond its ends; at a step
    the elevation is that on the side of ``near`` (n,)."""
    if (np.diff(level[:, 0]) > 0.0).all():
        return np.asarray(np.interp(x, *level.T))
    before, after = limits(level, np.clip(x, level[0, 0], level[-1, 0]))
    return np.where(near < x, before, after)


def lower_line(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the line of the lower one of two lines at every x.

    Parameters
    ----------
    first, second (n, 2) : points of the lines from left to right (m), with vertical steps

    Returns
    -------
    Points (k, 2) in m, also where the lines cross.
    """

    def sides(x: np.ndarray) -> list[np.ndarray]:
        middle = 0.5 * (x[1:] + x[:-1])
        return [np.stack([level_at(line, at, middle) for line in (first, second)]) for at in (x[:-1], x[1:])]

    x = np.union1d(first[:, 0], second[:, 0])
    left, right = sides(x)
    x = np.union1d(x, crossings(x, left[0] - left[1], right[0] - right[1]))
    lower = np.column_stack([pair.min(axis=0) for pair in sides(x)]).ravel()
    return without_repeats(np.column_stack([np.repeat(x, 2)[1:-1], lower]))
