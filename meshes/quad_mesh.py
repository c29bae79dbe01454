"""The quadrilaterals of a section as arrays, with named strata and boundaries; checked, and read back from a file."""

from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np

from meshes.errors import InputError, NoAnswerError
from meshes.quality import Quality, areas, quality, scaled_jacobians
from meshes.section.section import BOUNDARIES


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Quadrilaterals of a section.

    Attributes
    ----------
    points : (n, 2) x and elevation (m)
    cells : (m, 4) corners of every cell, counter-clockwise
    stratum : (m,) index into ``strata``
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
        """Number of cells and nodes, and the worst of the cells."""
        return quality(self.points, self.cells)

    def stratum_areas(self) -> np.ndarray:
        """Area (m²) of the cells of each stratum."""
        return np.bincount(self.stratum, weights=areas(self.points, self.cells), minlength=len(self.strata))


class BadMeshError(NoAnswerError):
    """A mesh with a cell that cannot be computed with; says which and where."""


def check(mesh: QuadMesh) -> None:
    """Raise BadMeshError if a cell has a Jacobian that is not positive."""
    jacobians = scaled_jacobians(mesh.points, mesh.cells)
    worst = int(np.argmin(jacobians))
    if jacobians[worst] > 0.0:
        return
    x, z = mesh.points[mesh.cells[worst]].mean(axis=0)
    raise BadMeshError(
        f"{int((jacobians <= 0).sum())} of {len(mesh.cells)} cells are folded, the worst near x = {x:.2f} m, "
        f'z = {z:.2f} m in stratum "{mesh.strata[mesh.stratum[worst]]}" (scaled Jacobian {jacobians[worst]:.2g}); '
        "try a smaller size there"
    )


def read(path: Path | str) -> QuadMesh:
    """A mesh written by ``generate``, by the names of its groups; raises InputError if those are missing."""
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
