"""Divides a section into blocks of columns and bands of rows for a mapped mesh, if it can be."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshes.section.section import Section

# Where nothing is said: cells in the height of a section, and how much wider than high those of a mapped mesh are.
ROWS, WIDER = 12, 1.5


@dataclass(frozen=True, eq=False)
class Blocks:
    """Holds the blocks of columns, and the bands of rows, of a mapped mesh.

    Attributes
    ----------
    x (blocks + 1,) : the borders between blocks (m)
    left, right (blocks, bands + 1) : elevation (m) of the borders between bands at both ends of every block
    stratum (blocks, bands) : index of the stratum
    """

    x: np.ndarray
    left: np.ndarray
    right: np.ndarray
    stratum: np.ndarray


def blocks_of(section: Section) -> Blocks | str:
    """Return the blocks and bands of a section, or the reason why it has none.

    A section can be mapped if the same number of layers lies under every point, if all layers are thicker than zero,
    and if their borders meet from block to block. Neighbouring blocks then lie in one band of rows.
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
    return Blocks(x=layers.x, left=left, right=right, stratum=stratum)


def share_out(total: int, weights: Sequence[float] | np.ndarray) -> np.ndarray:
    """Divide ``total`` items in proportion to weights (largest remainder), with at least one item for each weight.

    Raises ValueError if there are more weights than items.
    """
    weights = np.asarray(weights, dtype=float)
    if total < len(weights):
        raise ValueError(f"{total} items cannot be divided among {len(weights)} weights: each weight needs one item")
    share = weights / weights.sum() * total
    count = np.maximum(np.floor(share).astype(int), 1)
    while count.sum() < total:
        count[np.argmax(share - count)] += 1
    while count.sum() > total:
        count[np.argmin(np.where(count > 1, share - count, np.inf))] -= 1
    return count


def divisions(blocks: Blocks, columns: int | None, rows: int | None, size: float | None, most: int) -> tuple[int, int]:
    """Return the given numbers of columns and rows; else numbers that follow from ``size`` (m); else 12 rows, or one
    for each layer if there are more layers, and columns that make the cells one and a half times as wide as high.
    ``blocks``: blocks of the section; ``columns``, ``rows``: given numbers, or None; ``most``: largest number of cells
    if nothing is given; with fewer rows the cells are longer.
    """
    widths, thickness = np.diff(blocks.x), band_thickness(blocks)
    if size is not None:
        rows = rows or max(round(thickness.sum() / size), len(thickness))
        columns = columns or max(round(widths.sum() / size), len(widths))
    shape = widths.sum() / (WIDER * thickness.sum())  # columns a row
    if rows is None and columns is None:
        rows = max(min(ROWS, math.floor(math.sqrt(most / shape))), len(thickness))
        columns = max(min(round(shape * rows), most // rows), len(widths))
    rows = rows or max(ROWS, len(thickness))
    return columns or max(round(shape * rows), len(widths)), rows


def band_thickness(blocks: Blocks) -> np.ndarray:
    """Return the mean thickness (m) of every band."""
    borders = 0.5 * (blocks.left + blocks.right)
    return np.average(borders[:, :-1] - borders[:, 1:], axis=0, weights=np.diff(blocks.x))


def largest_corner(blocks: Blocks) -> float:
    """Return the largest angle (deg) in the corners of a mapped mesh's cells: between the vertical and the steepest
    border."""
    rise = (blocks.right - blocks.left) / np.diff(blocks.x)[:, None]
    return 90.0 + float(np.degrees(np.arctan(np.abs(rise).max())))
