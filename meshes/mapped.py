"""Makes mapped meshes: columns and rows through the layers, where the rows follow the interfaces."""

import gmsh
import numpy as np

from meshes.blocks import Blocks, band_thickness, blocks_of, divisions, share_out
from meshes.errors import InputError
from meshes.section.naming import group_names
from meshes.section.section import Section
from meshes.settings import MeshSettings


def build_mapped(section: Section, settings: MeshSettings) -> None:
    """Mesh the section in the current gmsh model as columns by rows, each cell divided into ``refine`` x ``refine``
    cells.

    Missing numbers of columns and rows follow from the size or a default. Columns are divided among the blocks by their
    widths, rows among the bands by their mean thickness. Raises InputError if the section cannot be mapped or has more
    kinks than columns or more layers than rows.
    """
    blocks = blocks_of(section)
    if isinstance(blocks, str):
        expected = 'expected the same layers all along, or method = "free"'
        raise InputError(section.name, [f'mesh, method = "mapped": not possible, {blocks}; {expected}'])
    widths, thickness = np.diff(blocks.x), band_thickness(blocks)
    columns, rows = divisions(blocks, settings.columns, settings.rows, settings.size, settings.max_cells)
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
    fine = settings.refine
    _transfinite(section, blocks, fine * share_out(columns, widths), fine * share_out(rows, thickness))


def _transfinite(section: Section, blocks: Blocks, columns: np.ndarray, rows: np.ndarray) -> None:
    """Make one transfinite gmsh surface for every block and band, with the given numbers of cells."""
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
    """Name physical groups: stratum k of the section is surface group k + 1, then the boundaries are curve groups."""
    for k, group in enumerate(group_names([stratum.name for stratum in section.strata])):
        gmsh.model.addPhysicalGroup(2, surfaces[k], tag=k + 1, name=group)
    for number, (name, curves) in enumerate(boundaries.items(), start=1):
        gmsh.model.addPhysicalGroup(1, curves, tag=len(section.strata) + number, name=name)
