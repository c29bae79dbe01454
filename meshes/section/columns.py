"""Divides outlines into columns at all their corners, and stacks them to strata from the top down."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshes.section.numbering import Piece, Stack, stacked
from meshes.section.simplified import needed

# Corners whose x differ by less (m) are at one x; what is thinner is nothing.
SNAP = 1e-4
# Thickness (m) up to which gaps and overlaps are inaccuracies of the drawing.
JOINED = 0.01
# An outline lies inside another if the other contains this share of its area.
CONTAINED_SHARE = 0.999


@dataclass(frozen=True)
class Columns:
    """Holds the ground between breakpoints, column by column.

    Attributes
    ----------
    x (columns + 1,) : the breakpoints (m)
    pieces : pieces of layers in every column, from the top down
    stack : strata to which the pieces belong
    tally : overlaps and gaps of the outlines
    problems : reasons why the outlines do not form a section
    """

    x: np.ndarray
    pieces: list[list[Piece]]
    stack: Stack
    tally: "ColumnFindings"
    problems: list[str]

    def interfaces(self, bare: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return the ground surface (columns, 2), and the bottoms of the strata (strata, columns, 2): elevations (m) at
        both ends.

        A stratum that is absent has the bottom of the stratum above. ``bare`` (columns, 2): elevation of the ground in
        columns that have no pieces, as where the base comes out of the ground.
        """
        ground = np.full((len(self.pieces), 2), np.nan) if bare is None else bare.copy()
        for column, pieces in enumerate(self.pieces):
            if pieces:
                ground[column] = pieces[0].left[0], pieces[0].right[0]
        bottoms = np.full((len(self.stack.names), *ground.shape), np.nan)
        for column, (pieces, numbers) in enumerate(zip(self.pieces, self.stack.numbers, strict=True)):
            for piece, number in zip(pieces, numbers, strict=True):
                bottoms[number, column] = piece.left[1], piece.right[1]
        above = ground
        for bottom in bottoms:
            bottom[:] = np.where(np.isnan(bottom), above, bottom)
            above = bottom
        return ground, bottoms

    def points(self, line: np.ndarray) -> np.ndarray:
        """Return a line, given at both ends (columns, 2) of every column, as points (n, 2), with two points where the
        line steps."""
        chain = np.column_stack([np.repeat(self.x, 2)[1:-1], line.ravel()])
        chain = chain[np.isfinite(chain[:, 1])]  # without columns that have no pieces and nothing bare
        again = np.concatenate([[False], np.all(np.abs(np.diff(chain, axis=0)) <= SNAP, axis=1)])
        chain = chain[~again]
        return chain[needed(chain, SNAP)]


def columns_of(
    names: Sequence[str], outlines: Sequence[np.ndarray], rank: Sequence[float] | None = None, without: str = ""
) -> Columns:
    """Divide outlines into columns at all their corners, and return the strata that they form.

    Parameters
    ----------
    names : names of the outlines; several may have one name
    outlines (n, 2) : closed polygons, one for each name (m)
    rank : number of each outline; a place inside several outlines belongs to the one of the lowest rank, by default to
        the smallest outline
    without : name of outlines that leave their place empty; none if empty

    Returns
    -------
    The ground column by column, with overlaps, gaps and problems. A gap between two outlines belongs to the stratum
    below.
    """
    areas = [polygon_area(points) for points in outlines]
    x = _breakpoints(outlines)
    edges = _edges(outlines, x)
    tally = ColumnFindings(list(names), areas, x)
    pieces, problems = [], []
    for column in range(len(x) - 1):
        cells = _cells(edges, x, column, areas if rank is None else rank, tally)
        cells = [cell for cell in cells if not without or cell.owner < 0 or names[cell.owner] != without]
        pieces.append(_layer_pieces(cells, tally, column))
        if not pieces[-1]:
            problems.append(
                f"nothing is drawn from x = {x[column]:.6g} to {x[column + 1]:.6g} m; expected ground there"
            )
    return Columns(x, pieces, stacked(pieces), tally, problems)


class ColumnFindings:
    """Holds findings of all columns: gaps, and the numbers of outlines that overlap."""

    def __init__(self, names: list[str], areas: list[float], x: np.ndarray) -> None:
        self.names, self.areas, self.x = names, areas, x
        self.owned, self.covered = [0.0] * len(names), [0.0] * len(names)
        self.shared: dict[tuple[int, int], list[float]] = {}  # area, and x from and to
        self.gaps: dict[tuple[str, str], list[float]] = {}  # height, and x from and to

    def add(self, inside: Sequence[int], owner: int, area: float, column: int) -> None:
        """Add a cell that lies in several outlines to the strata that claim it.

        ``inside``: strata whose outlines contain the cell; ``owner``: the stratum to which the cell belongs; ``area``:
        area of the cell (m²); ``column``: number of the column.
        """
        self.owned[owner] += area
        for other in inside:
            self.covered[other] += area
            if other != owner and self.names[other] != self.names[owner]:
                whole = self.shared.setdefault((owner, other), [0.0, self.x[column], self.x[column + 1]])
                whole[0], whole[2] = whole[0] + area, self.x[column + 1]

    def gap(self, above: str, below: str, height: float, column: int) -> None:
        """Record a gap between two strata.

        ``above``, ``below``: names of the strata; ``height``: height of the gap (m); ``column``: number of the column.
        """
        gap_entry = self.gaps.setdefault((above, below), [0.0, self.x[column], self.x[column + 1]])
        gap_entry[0], gap_entry[2] = max(gap_entry[0], height), self.x[column + 1]

    def sentences(self) -> list[str]:
        sentences = [
            f'between "{above}" and "{below}" there is a gap, up to {height:.3g} m high from x = {start:.6g} to '
            f'{end:.6g} m: it is filled with "{below}"'
            for (above, below), (height, start, end) in self.gaps.items()
            if height > JOINED
        ]
        for (owner, other), (area, start, end) in self.shared.items():
            nested = area >= CONTAINED_SHARE * min(self.owned[owner], self.areas[other])
            if not nested and area > JOINED * (end - start):
                sentences.append(f'"{self.names[owner]}" and "{self.names[other]}" overlap by {area:.3g} m² from x = '
                            f'{start:.6g} to {end:.6g} m: this area is given to "{self.names[owner]}"')  # fmt: skip
        sentences += [f'the outline on layer "{name}" is covered by other outlines, and not used'
                 for name, area in zip(self.names, self.owned, strict=True) if area <= 0.0]  # fmt: skip
        sentences += [f'the outline on layer "{name}" crosses itself; expected its corners in order'
                      for name, covered, area in zip(self.names, self.covered, self.areas, strict=True)
                      if abs(covered - area) > (1.0 - CONTAINED_SHARE) * covered]  # fmt: skip
        return sentences


def polygon_area(points: np.ndarray) -> float:
    """Return the area (m²) of a closed polygon (n, 2), in either sense of rotation."""
    (x, z), (x1, z1) = points.T, np.roll(points, -1, axis=0).T
    return abs(float(0.5 * (x * z1 - x1 * z).sum()))


def _breakpoints(outlines: Sequence[np.ndarray]) -> np.ndarray:
    """Return x (m) of all corners and of the crossings of edges; places within SNAP of each other are returned once."""
    starts = np.vstack(outlines)
    ends = np.vstack([np.roll(points, -1, axis=0) for points in outlines])
    swap = starts[:, 0] > ends[:, 0]
    left, right = np.where(swap[:, None], ends, starts), np.where(swap[:, None], starts, ends)
    slanted = right[:, 0] - left[:, 0] > SNAP
    every = np.sort(np.concatenate([starts[:, 0], _crossings(left[slanted], right[slanted])]))
    return every[np.concatenate([[True], np.diff(every) > SNAP])]


def _crossings(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return x (m) where edges, from left (n, 2) to right (n, 2), cross by more than SNAP."""
    order = np.argsort(left[:, 0])
    left, right = left[order], right[order]
    slope = (right[:, 1] - left[:, 1]) / (right[:, 0] - left[:, 0])
    crossings = [np.empty(0)]
    for i in range(len(left)):
        after = slice(i + 1, int(np.searchsorted(left[:, 0], right[i, 0])))
        start, end = left[after, 0], np.minimum(right[after, 0], right[i, 0])
        gap = [left[i, 1] + slope[i] * (x - left[i, 0]) - left[after, 1] - slope[after] * (x - left[after, 0])
               for x in (start, end)]  # fmt: skip
        crossed = (gap[0] * gap[1] < 0.0) & (np.minimum(np.abs(gap[0]), np.abs(gap[1])) > SNAP)
        share = gap[0][crossed] / (gap[0][crossed] - gap[1][crossed])
        crossings.append(start[crossed] + share * (end[crossed] - start[crossed]))
    return np.concatenate(crossings)


@dataclass(frozen=True)
class _Edges:
    """Holds the edges of all outlines: number of the outline, numbers of the first and last breakpoint, and elevations
    (m) at both ends."""

    outline: np.ndarray
    first_breakpoint: np.ndarray
    last_breakpoint: np.ndarray
    z_first: np.ndarray
    z_last: np.ndarray


def _edges(outlines: Sequence[np.ndarray], x: np.ndarray) -> _Edges:
    rows = []
    for k, points in enumerate(outlines):
        at = np.searchsorted(0.5 * (x[1:] + x[:-1]), points[:, 0])  # the nearest one
        there, z = np.roll(at, -1), np.roll(points[:, 1], -1)
        for a, b, za, zb in zip(at, there, points[:, 1], z, strict=True):
            if a != b:
                rows.append((k, a, b, za, zb) if a < b else (k, b, a, zb, za))
    table = np.array(rows, dtype=float)
    return _Edges(*table[:, :3].astype(int).T, *table[:, 3:].T)


@dataclass(frozen=True)
class _Cell:
    """Holds the cell between two edges of a column: number of the outline that owns it (-1 for none), and elevations
    (m) of top and bottom at the left and right end."""

    owner: int
    top: np.ndarray
    bottom: np.ndarray


def _cells(edges: _Edges, x: np.ndarray, column: int, rank: Sequence[float], tally: ColumnFindings) -> list[_Cell]:
    """Return the cells of a column, from the top down."""
    crossing = np.flatnonzero((edges.first_breakpoint <= column) & (edges.last_breakpoint > column))
    start, end = x[edges.first_breakpoint[crossing]], x[edges.last_breakpoint[crossing]]
    share = (x[[column, column + 1]][:, None] - start) / (end - start)
    lines = (edges.z_first[crossing] + share * (edges.z_last[crossing] - edges.z_first[crossing])).T
    order = np.argsort(-lines.sum(axis=1), kind="stable")
    inside: set[int] = set()
    cells = []
    width = float(x[column + 1] - x[column])
    for upper, lower in pairwise(order):
        inside ^= {int(edges.outline[crossing[upper]])}
        top, bottom = lines[upper], lines[lower]
        thick = float((top - bottom).mean())
        if thick <= SNAP:
            continue
        owner = min(inside, key=lambda k: (rank[k], k)) if inside else -1
        if owner >= 0:
            tally.add(sorted(inside), owner, thick * width, column)
        cells.append(_Cell(owner, top, bottom))
    return cells


def _layer_pieces(cells: Sequence[_Cell], tally: ColumnFindings, column: int) -> list[Piece]:
    """Return the cells of a column as pieces of layers. Neighbouring cells of one name are one piece, and gaps belong
    to the piece below."""
    pieces: list[Piece] = []
    gap: _Cell | None = None
    for cell in cells:
        if cell.owner < 0:
            gap = cell if pieces else None
            continue
        name, top = tally.names[cell.owner], cell.top
        if gap is not None and pieces:
            tally.gap(pieces[-1].name, name, float((gap.top - gap.bottom).max()), column)
            top, gap = gap.top, None
        left, right = ((float(top[end]), float(cell.bottom[end])) for end in (0, 1))
        if pieces and pieces[-1].name == name:
            above = pieces.pop()
            left, right = (above.left[0], left[1]), (above.right[0], right[1])
        pieces.append(Piece(name, left, right))
    return pieces
