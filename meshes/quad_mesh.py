"""Holds the quadrilaterals of a section as arrays, with named strata and boundaries; checks them, and reads them from a
file."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meshes.edges import edges_of
from meshes.errors import InputError, NoAnswerError
from meshes.quality import Quality, areas, quality, scaled_jacobians
from meshes.section.naming import BOUNDARIES, group_names


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Holds the quadrilaterals of a section.

    Attributes
    ----------
    points (n, 2) : x and elevation (m)
    cells (m, 4) : corners of every cell, counter-clockwise
    stratum (m,) : index into ``strata``
    strata : names of the strata from the top down
    boundaries : edges (k, 2) by the name of their boundary
    method : "mapped", "free", or "given" for a mesh made elsewhere
    """

    points: np.ndarray
    cells: np.ndarray
    stratum: np.ndarray
    strata: tuple[str, ...]
    boundaries: dict[str, np.ndarray]
    method: str = ""

    def quality(self) -> Quality:
        """Return the numbers of cells and nodes, and the worst measures of quality."""
        return quality(self.points, self.cells)

    def stratum_areas(self) -> np.ndarray:
        """Return the area (m²) of the cells of each stratum."""
        return np.bincount(self.stratum, weights=areas(self.points, self.cells), minlength=len(self.strata))


def divided(mesh: QuadMesh) -> QuadMesh:
    """Return the mesh with every cell divided into four at the middles of its edges.

    Parameters
    ----------
    mesh : the quadrilaterals

    Returns
    -------
    The mesh; the parts of one cell follow each other.
    """
    edges, of_cell = edges_of(mesh.cells)
    middle = len(mesh.points) + of_cell
    centre = len(mesh.points) + len(edges) + np.arange(len(mesh.cells))
    points = np.vstack([mesh.points, mesh.points[edges].mean(axis=1), mesh.points[mesh.cells].mean(axis=1)])
    parts = [np.column_stack([mesh.cells[:, k], middle[:, k], centre, middle[:, k - 1]]) for k in range(4)]
    key = np.array([len(mesh.points), 1])

    def halves(boundary: np.ndarray) -> np.ndarray:
        between = len(mesh.points) + np.searchsorted(edges @ key, np.sort(boundary, axis=1) @ key)
        return np.vstack([np.column_stack([boundary[:, 0], between]), np.column_stack([between, boundary[:, 1]])])

    return replace(
        mesh,
        points=points,
        cells=np.stack(parts, axis=1).reshape(-1, 4),
        stratum=np.repeat(mesh.stratum, 4),
        boundaries={name: halves(boundary.astype(np.int64)) for name, boundary in mesh.boundaries.items()},
    )


class BadMeshError(NoAnswerError):
    """The mesh has a cell that cannot be used for computing.

    Attributes
    ----------
    reason : str
        Description of the cell, its place, and what is wrong with it.
    remedy : str
        What the user can try.
    """

    MISSING = "No usable mesh"


def check(mesh: QuadMesh) -> None:
    """Raise an error if a mesh cannot be used for computing.

    Parameters
    ----------
    mesh : the quadrilaterals

    Raises
    ------
    BadMeshError
        If a cell has a Jacobian that is not positive; the error names the worst cell.
    """
    jacobians = scaled_jacobians(mesh.points, mesh.cells)
    worst = int(np.argmin(jacobians))
    if jacobians[worst] > 0.0:
        return
    x, z = mesh.points[mesh.cells[worst]].mean(axis=0)
    folded = int((jacobians <= 0).sum())
    raise BadMeshError(
        f"{folded} of {len(mesh.cells)} cells {'is' if folded == 1 else 'are'} folded, the worst near x = {x:.2f} m, "
        f'z = {z:.2f} m in stratum "{mesh.strata[mesh.stratum[worst]]}" (scaled Jacobian {jacobians[worst]:.2g}); '
        "try a smaller size there"
    )


def read(path: Path | str) -> QuadMesh:
    """Read a mesh of quadrilaterals from a gmsh file.

    Parameters
    ----------
    path : Path or str
        A file that `generate` or `save` wrote, with the names of strata and boundaries as physical groups.

    Returns
    -------
    QuadMesh

    Raises
    ------
    InputError
        If there is no such file, or if it lacks a group.
    """
    import meshio

    path = Path(path)
    if not path.is_file():
        raise InputError(str(path), ["there is no such file"])
    try:
        raw = meshio.gmsh.read(path)  # meshio.read would leave the program where it cannot read
    except Exception as error:  # it raises many kinds for a file that is no mesh
        raise InputError(str(path), [f"is not a gmsh file that can be read: {error}"]) from None
    groups: dict[int, dict[int, str]] = {1: {}, 2: {}}
    for name, (tag, dimension) in raw.field_data.items():
        groups.setdefault(int(dimension), {})[int(tag)] = name
    missing = [name for name in BOUNDARIES if name not in groups[1].values()]
    problems = [f'there is no boundary group "{name}"' for name in missing]
    if not groups[2]:
        problems.append("there is no surface group; expected one for each stratum")
    kinds = {block.type for block in raw.cells}
    problems += [f"there are cells of type {kind}; expected quadrilaterals" for kind in kinds - {"quad", "line"}]
    if problems or "gmsh:physical" not in raw.cell_data:
        raise InputError(str(path), problems or ["there are no physical groups"])
    tags = raw.cell_data_dict["gmsh:physical"]
    strata = tuple(groups[2][tag] for tag in sorted(groups[2]))
    position = {tag: index for index, tag in enumerate(sorted(groups[2]))}
    lines = raw.cells_dict["line"]
    return QuadMesh(
        points=raw.points[:, :2],
        cells=raw.cells_dict["quad"],
        stratum=np.array([position[tag] for tag in tags["quad"]]),
        strata=strata,
        boundaries={name: lines[tags["line"] == tag] for tag, name in groups[1].items()},
    )


def save(mesh: QuadMesh, path: Path | str) -> None:
    """Write a mesh as a gmsh file that `read` reads.

    Parameters
    ----------
    mesh : QuadMesh
        The mesh; its strata are physical groups from 1 on, then come its boundaries.
    path : Path or str
        The file.
    """
    import meshio

    # A side where the ground thins out to nothing has no edges; it keeps its name, which `read` requires.
    edges = {name: np.reshape(ends, (-1, 2)) for name, ends in mesh.boundaries.items()}
    tags = {name: len(mesh.strata) + number for number, name in enumerate(edges, start=1)}
    of_lines = np.concatenate([np.full(len(ends), tags[name]) for name, ends in edges.items()])
    physical = [mesh.stratum + 1, of_lines]
    raw = meshio.Mesh(
        np.column_stack([mesh.points, np.zeros(len(mesh.points))]),
        [("quad", mesh.cells.astype(np.int64)), ("line", np.concatenate(list(edges.values())).astype(np.int64))],
        cell_data={"gmsh:physical": physical, "gmsh:geometrical": physical},
        field_data={
            **{name: np.array([k, 2]) for k, name in enumerate(group_names(mesh.strata), start=1)},
            **{name: np.array([tag, 1]) for name, tag in tags.items()},
        },
    )
    meshio.gmsh.write(path, raw, fmt_version="2.2", binary=False)
