"""Mapped meshes: columns by rows through the layers, the rows following the interfaces."""

from collections.abc import Sequence
from dataclasses import dataclass

import gmsh
import numpy as np

from meshes.errors import InputError
from meshes.section.section import Section


@dataclass(frozen=True, eq=False)
class Mapping:
    """Blocks of columns by bands of rows: ``x`` (blocks + 1,), the ``left`` and ``right`` elevations of the bands'
    borders (blocks, bands + 1), and the ``stratum`` in every band of every block (blocks, bands)."""

    x: np.ndarray
    left: np.ndarray
    right: np.ndarray
    stratum: np.ndarray


def mapping(section: Section) -> Mapping | str:
    """The blocks and bands of a section, or the reason why it has none.

    A section can be mapped if the same number of layers lies under every point, all of them thicker than
    zero, with borders that meet from block to block; lateral neighbours share their band.
    """
    layers = section.layering
    at_left, at_right = layers.thickness()
    present = layers.present()
    thin = present & ((at_left <= 0.0) | (at_right <= 0.0))
    if thin.any():
        i, k = np.argwhere(thin)[0]
        x = layers.x[i] if at_left[i, k] <= 0.0 else layers.x[i + 1]
        return f'stratum "{section.strata[k].name}" thins out to nothing at x = {x:g} m'
    counts = present.sum(axis=1)
    if len(set(counts)) > 1:
        i = int(np.flatnonzero(np.diff(counts))[0])
        return f"the number of layers changes from {counts[i]} to {counts[i + 1]} at x = {layers.x[i + 1]:g} m"
    stratum = np.array([np.flatnonzero(row) for row in present])
    first = layers.left[:, :1]
    left = np.hstack([first, np.take_along_axis(layers.left[:, 1:], stratum, axis=1)])
    right = np.hstack([layers.right[:, :1], np.take_along_axis(layers.right[:, 1:], stratum, axis=1)])
    steps = np.abs(right[:-1] - left[1:]) > 0.0
    if steps.any():
        i, _ = np.argwhere(steps)[0]
        return f"there is a vertical step at x = {layers.x[i + 1]:g} m"
    return Mapping(x=layers.x, left=left, right=right, stratum=stratum)


def share_out(total: int, weights: Sequence[float] | np.ndarray) -> np.ndarray:
    """``total`` whole things shared out by weight (largest remainder), at least one for each.

    Raises ValueError if there are more weights than things.
    """
    weights = np.asarray(weights, dtype=float)
    if total < len(weights):
        raise ValueError(f"{total} cannot be shared by {len(weights)}")
    share = weights / weights.sum() * total
    count = np.maximum(np.floor(share).astype(int), 1)
    while count.sum() < total:
        count[np.argmax(share - count)] += 1
    while count.sum() > total:
        count[np.argmin(np.where(count > 1, share - count, np.inf))] -= 1
    return count


def divisions(blocks: Mapping, columns: int | None, rows: int | None, size: float | None) -> tuple[int, int]:
    """Columns and rows as asked for; else from ``size`` (m); else 12 rows or one for each layer, and columns that
    make the cells half as wide again as high."""
    widths, thickness = np.diff(blocks.x), _thickness(blocks)
    if size is not None:
        rows = rows or max(round(thickness.sum() / size), len(thickness))
        columns = columns or max(round(widths.sum() / size), len(widths))
    rows = rows or max(12, len(thickness))
    return columns or max(round(widths.sum() / (1.5 * thickness.sum() / rows)), len(widths)), rows


def _thickness(blocks: Mapping) -> np.ndarray:
    """Mean thickness (m) of every band."""
    borders = 0.5 * (blocks.left + blocks.right)
    return np.average(borders[:, :-1] - borders[:, 1:], axis=0, weights=np.diff(blocks.x))


def build_mapped(section: Section, columns: int | None, rows: int | None, size: float | None, refine: int) -> None:
    """Mesh the section in the current gmsh model as columns by rows, each cell divided ``refine`` x ``refine``.

    What is not given of columns and rows follows from ``size`` (m) or a default. Columns go to the blocks by their
    widths, rows to the bands by their mean thickness. Raises InputError if the section cannot be mapped or has more
    kinks than columns or more layers than rows.
    """
    blocks = mapping(section)
    if isinstance(blocks, str):
        wish = 'expected the same layers all along, or method = "free"'
        raise InputError(section.name, [f'mesh, method = "mapped": not possible, {blocks}; {wish}'])
    widths, thickness = np.diff(blocks.x), _thickness(blocks)
    columns, rows = divisions(blocks, columns, rows, size)
    problems = [
        f"mesh, {key} = {have}: expected at least {need}, one for each {what}"
        for key, have, need, what in (
            ("columns", columns, len(widths), "stretch between two kinks"),
            ("rows", rows, len(thickness), "layer"),
        )
        if have < need
    ]
    if problems:
        raise InputError(section.name, problems)
    _transfinite(section, blocks, refine * share_out(columns, widths), refine * share_out(rows, thickness))


def _transfinite(section: Section, blocks: Mapping, columns: np.ndarray, rows: np.ndarray) -> None:
    """One transfinite gmsh surface for every block and band, with the given numbers of cells."""
    geo = gmsh.model.geo
    elevation = np.vstack([blocks.left, blocks.right[-1:]])
    n_blocks, n_bands = blocks.stratum.shape
    point = [[geo.addPoint(blocks.x[i], z, 0.0) for z in elevation[i]] for i in range(n_blocks + 1)]
    across = [[geo.addLine(point[i][j], point[i + 1][j]) for j in range(n_bands + 1)] for i in range(n_blocks)]
    down = [[geo.addLine(point[i][j], point[i][j + 1]) for j in range(n_bands)] for i in range(n_blocks + 1)]
    surfaces: dict[int, list[int]] = {k: [] for k in range(len(section.strata))}
    for i in range(n_blocks):
        for j in range(n_bands):
            loop = geo.addCurveLoop([across[i][j + 1], -down[i + 1][j], -across[i][j], down[i][j]])
            surface = geo.addPlaneSurface([loop])
            geo.mesh.setTransfiniteSurface(surface)
            geo.mesh.setRecombine(2, surface)
            surfaces[int(blocks.stratum[i, j])].append(surface)
    for i, curves in enumerate(across):
        for curve in curves:
            geo.mesh.setTransfiniteCurve(curve, int(columns[i]) + 1)
    for curves in down:
        for j, curve in enumerate(curves):
            geo.mesh.setTransfiniteCurve(curve, int(rows[j]) + 1)
    geo.synchronize()
    name_groups(
        section,
        surfaces,
        {
            "surface": [curves[0] for curves in across],
            "base": [curves[-1] for curves in across],
            "left": down[0],
            "right": down[-1],
        },
    )
    gmsh.model.mesh.generate(2)


def name_groups(section: Section, surfaces: dict[int, list[int]], boundaries: dict[str, list[int]]) -> None:
    """Physical groups: stratum k of the section as surface group k + 1, then the boundaries as curve groups."""
    for k, stratum in enumerate(section.strata):
        gmsh.model.addPhysicalGroup(2, surfaces[k], tag=k + 1, name=stratum.name)
    for number, (name, curves) in enumerate(boundaries.items(), start=1):
        gmsh.model.addPhysicalGroup(1, curves, tag=len(section.strata) + number, name=name)
