"""gmsh: mapped or free meshes of a section, all quadrilaterals, with named strata and boundaries."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import gmsh
import meshio
import numpy as np
from pydantic import Field

from meshes.errors import InputError
from meshes.free import ALGORITHMS, GROWTH_REACH, build_free
from meshes.mapped import build_mapped, divisions, mapping
from meshes.quality import Quality, areas, quality, scaled_jacobians
from meshes.section.quantity import Length
from meshes.section.section import BOUNDARIES, Model, Section

GMSH_QUADRILATERAL, GMSH_LINE = 3, 1

# More quadrilaterals than this need more memory than most machines have (gmsh alone takes about 1 kB for each).
MOST_QUADRILATERALS = 5_000_000


class MeshSettings(Model):
    """How to mesh a section. Sizes are lengths of cell edges (m)."""

    method: Literal["auto", "mapped", "free"] = Field(
        default="auto", description="mapped columns and rows, free, or whichever the layers allow"
    )
    columns: int | None = Field(default=None, ge=1, description="columns of a mapped mesh")
    rows: int | None = Field(default=None, ge=1, description="rows of a mapped mesh")
    size: Length | None = Field(default=None, description="target cell size, a length such as 2.0")
    sizes: dict[str, Length] = Field(default={}, description='target cell size in a stratum, "name" = size')
    towards: dict[str, Length] = Field(
        default={}, description='cell size at "surface", "base" or the bottom of the named stratum'
    )
    refine: int = Field(default=1, ge=1, le=64, description="a whole number that divides every cell size")

    def problems(self, section: Section) -> list[str]:
        """What does not fit the section, one sentence each."""
        names = [stratum.name for stratum in section.strata]
        known = {"sizes": names, "towards": [*names, "surface", "base"]}
        problems = [
            f'mesh, {table}: there is no "{name}"; expected one of {", ".join(known[table])}'
            for table in known
            for name in getattr(self, table)
            if name not in known[table]
        ]
        counted, graded = bool(self.columns or self.rows), bool(self.sizes or self.towards)
        if self.method == "free" and counted:
            problems.append('mesh, columns and rows: expected none with method = "free", which goes by size')
        if graded and (self.method == "mapped" or counted):
            problems.append('mesh, sizes and towards: expected none with columns and rows; they need method = "free"')
        if self.size and self.columns and self.rows:
            problems.append("mesh, size: expected either a size or both columns and rows")
        largest = float(np.ptp(section.outline(), axis=0).max())
        if self.size and self.size > largest:
            problems.append(f"mesh, size = {self.size:g} m: expected at most the section's own size, {largest:g} m")
        if not problems and (count := self.expected_quadrilaterals(section)) > MOST_QUADRILATERALS:
            problems.append(
                f"mesh: sizes and refine would make about {count:.1g} quadrilaterals; expected at most "
                f"{MOST_QUADRILATERALS:,}"
            )
        return problems

    def method_for(self, section: Section) -> Literal["mapped", "free"]:
        """The method as set; for "auto", mapped if columns or rows are set or if the layers allow it."""
        if self.method != "auto":
            return self.method
        if self.sizes or self.towards:
            return "free"
        return "mapped" if self.columns or self.rows or not isinstance(mapping(section), str) else "free"

    def expected_quadrilaterals(self, section: Section) -> float:
        """About how many quadrilaterals a mesh will have; 0 where mapping will be refused anyhow."""
        if self.method_for(section) == "mapped":
            blocks = mapping(section)
            if isinstance(blocks, str):
                return 0.0
            columns, rows = divisions(blocks, self.columns, self.rows, self.size)
            return float(columns) * rows * self.refine**2
        size = default_size(section, self)
        wanted = [min(self.sizes.get(stratum.name, size), size) for stratum in section.strata]
        count = float((section.layering.areas() / np.square(wanted)).sum())
        left, right = section.extent
        for name, near in self.towards.items():
            # On one side of a line of length L the size grows from s to S over GROWTH_REACH S: GROWTH_REACH L / s
            sides = 1.0 if name in ("surface", "base") else 2.0
            count += sides * GROWTH_REACH * (right - left) / near if near < size else 0.0
        return count * self.refine**2


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Quadrilaterals of a section: ``points`` (n, 2) in m, ``cells`` (m, 4) counter-clockwise.

    ``stratum`` (m,) is an index into ``strata``; ``boundaries`` holds the edges (k, 2) of every named boundary.
    """

    points: np.ndarray
    cells: np.ndarray
    stratum: np.ndarray
    strata: tuple[str, ...]
    boundaries: dict[str, np.ndarray]
    method: str = ""

    def quality(self) -> Quality:
        return quality(self.points, self.cells)

    def stratum_areas(self) -> np.ndarray:
        """Area (m²) of the cells of each stratum."""
        return np.bincount(self.stratum, weights=areas(self.points, self.cells), minlength=len(self.strata))


class BadMeshError(RuntimeError):
    """A mesh with a cell that cannot be computed with; says which and where."""


def generate(section: Section, settings: MeshSettings | None = None, path: Path | str | None = None) -> QuadMesh:
    """Mesh a section and, if ``path`` is given, write it there as a gmsh file.

    Raises InputError if the settings do not fit the section, BadMeshError if gmsh leaves a bad cell.
    """
    settings = settings or MeshSettings()
    problems = settings.problems(section)
    if problems:
        raise InputError(section.name, problems)
    method = settings.method_for(section)
    failure: BadMeshError | None = None
    for algorithm in ALGORITHMS if method == "free" else (0,):
        try:
            return _build(section, settings, method, algorithm, path)
        except BadMeshError as error:
            failure = failure or error
    assert failure is not None
    raise failure


def _build(section: Section, settings: MeshSettings, method: str, algorithm: int, path: Path | str | None) -> QuadMesh:
    """Mesh in a gmsh session of its own, check the mesh, and write it if a path is given."""
    with model(section.name):
        try:
            if method == "mapped":
                build_mapped(section, settings.columns, settings.rows, settings.size, settings.refine)
            else:
                size = default_size(section, settings)
                build_free(section, size, settings.sizes, settings.towards, settings.refine, algorithm)
        except InputError:
            raise
        except Exception as error:  # gmsh raises plain Exception with its last error message
            raise BadMeshError(f"gmsh gave up: {error}; try another size") from error
        mesh = _from_gmsh(section, method)
        check(mesh)
        if path is not None:
            gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
            _write(Path(path), section)
    return mesh


def default_size(section: Section, settings: MeshSettings) -> float:
    """The target size as set, or else a twelfth of the section's mean height."""
    if settings.size is not None:
        return settings.size
    left, right = section.extent
    return float(section.layering.areas().sum()) / (right - left) / 12.0


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


@contextmanager
def model(name: str) -> Iterator[Any]:
    """A quiet gmsh session with one empty model, closed again whatever happens."""
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)  # the same mesh on every machine
        gmsh.model.add(name)
        yield gmsh
    finally:
        gmsh.finalize()


def _from_gmsh(section: Section, method: str) -> QuadMesh:
    """The meshed gmsh model as arrays, its nodes numbered from 0 without gaps."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    types, _, _ = gmsh.model.mesh.getElements(2)
    others = set(types) - {GMSH_QUADRILATERAL}
    if others:
        kind = gmsh.model.mesh.getElementProperties(next(iter(others)))[0]
        _, node_tags = gmsh.model.mesh.getElementsByType(next(iter(others)))
        place = coordinates.reshape(-1, 3)[np.flatnonzero(tags == node_tags[0])[0]]
        raise BadMeshError(f"gmsh left a {kind} near x = {place[0]:.2f} m, z = {place[1]:.2f} m; try another size")

    cells, stratum, boundaries = [], [], {}
    for k, layer in enumerate(section.strata):
        nodes = group_nodes(2, layer.name, GMSH_QUADRILATERAL, 4)
        cells.append(nodes)
        stratum.append(np.full(len(nodes), k))
    for name in BOUNDARIES:
        boundaries[name] = group_nodes(1, name, GMSH_LINE, 2)
    quads = np.concatenate(cells)
    used = np.unique(quads)
    points = coordinates.reshape(-1, 3)[np.argsort(tags)][np.searchsorted(np.sort(tags), used), :2]
    return QuadMesh(
        points=points,
        cells=np.searchsorted(used, quads),
        stratum=np.concatenate(stratum),
        strata=tuple(layer.name for layer in section.strata),
        boundaries={name: np.searchsorted(used, edges) for name, edges in boundaries.items()},
        method=method,
    )


def group_nodes(dimension: int, name: str, element_type: int, corners: int) -> np.ndarray:
    """Node tags (n, corners) of a named group, in the order of its entities."""
    for group_dimension, tag in gmsh.model.getPhysicalGroups(dimension):
        if gmsh.model.getPhysicalName(group_dimension, tag) == name:
            entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
            parts = [gmsh.model.mesh.getElementsByType(element_type, int(entity))[1] for entity in entities]
            return np.concatenate(parts).reshape(-1, corners)
    return np.empty((0, corners), dtype=np.uint64)


def _write(path: Path, section: Section) -> None:
    """Write the gmsh file, which says, too, if a section is a reconstruction.

    Raises OSError if the disk did not take all of it: gmsh itself would not say so.
    """
    path.touch()  # gmsh does not say why a file cannot be written, this does
    gmsh.write(str(path))
    end = b"$EndElements\n"
    with path.open("rb+") as file:
        file.seek(-min(len(end), path.stat().st_size), os.SEEK_END)
        if file.read() != end:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        if section.reconstruction:
            note = " ".join(section.reconstruction_note.replace("$", "").split())
            file.write(f"$Comments\nReconstruction. {note}\n$EndComments\n".encode())
