"""Makes mapped or free meshes of a section by gmsh, all quadrilaterals, with named strata and boundaries."""

import errno
import math
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import product
from pathlib import Path
from threading import Lock
from typing import Any

import gmsh
import numpy as np

from meshes.edges import without_cells
from meshes.errors import InputError
from meshes.executor import LostError, Processes
from meshes.free import ALGORITHMS, Sizes, build_free
from meshes.mapped import build_mapped
from meshes.quad_mesh import BadMeshError, QuadMesh, check
from meshes.quality import corner_angles
from meshes.section.layering import Layering
from meshes.section.naming import BOUNDARIES, group_names
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.wide_corners import with_wider_corners

GMSH_QUADRILATERAL, GMSH_LINE = 3, 1
AREA_TOLERANCE = 1e-7  # relative difference of areas and lengths of a mesh from those of the ground

# Factors on the requested sizes, which are tried if no algorithm makes a free mesh with these sizes.
SCALES = (1.0, 0.8, 0.64)

# If a free mesh has a corner below this angle (deg), the next algorithm is tried, up to this number; the best mesh is
# used.
NARROW_ANGLE, MOST_ALGORITHMS = 15.0, 4
WIDENED_ANGLE = 20.0  # deg: corners below it are made wider, if nodes inside their stratum can be moved

# gmsh has one state for all of a process.
_one_session = Lock()
# gmsh keeps nodes in the order of their addresses, and where two are equally near to a place takes the first one: what
# else a process had done decided between meshes of 5,184 and 5,156 cells of one section. So each free mesh is made in a
# process that has done nothing but import, in fresh memory. What ends gmsh ends that process and not the program.
_FRESH = {"PYTHONHASHSEED": "0", "PYTHONDONTWRITEBYTECODE": "1", "OPENBLAS_NUM_THREADS": "1"}
# All that it takes over of the environment: where libraries and bytecode lie.
_INHERITED = ("LD_LIBRARY_PATH", "PYTHONPYCACHEPREFIX")
_in_fresh_processes = Processes(
    1, _FRESH | {name: os.environ[name] for name in _INHERITED if name in os.environ}, __name__, forks=True, tries=1
)

# Where nothing is said of sizes, a mesh of more than so many times the most cells, as many thin layers make it, is made
# anew with larger ones, up to so many times.
TOO_MANY, COARSER_TRIES = 2.0, 2

# Ratio of the size of cells far beyond the ends of a section to the size inside.
DISTANT_SIZE_RATIO = 3.0


def generate(section: Section, settings: MeshSettings | None = None, path: Path | str | None = None) -> QuadMesh:
    """Mesh a section with quadrilaterals.

    Parameters
    ----------
    section : Section
        The section to be meshed.
    settings : MeshSettings, optional
        Method and sizes of cells; default settings if left out.
    path : Path or str, optional
        File to which the mesh is written, in the format of gmsh.

    Returns
    -------
    QuadMesh

    Raises
    ------
    InputError
        If the settings do not fit the section.
    BadMeshError
        If gmsh leaves a cell without a positive Jacobian.
    """
    settings = settings or MeshSettings()
    problems = settings.unknown_names([s.name for s in section.strata]) + settings.problems(section)
    if problems:
        raise InputError(section.name, problems)
    if settings.method_for(section) == "free":
        mesh = free_mesh(section, settings, sizes_of(section, settings), path)
        by_default = settings.size is None and not settings.sizes and not settings.towards
        for _ in range(COARSER_TRIES if by_default else 0):
            surplus = len(mesh.cells) / (settings.max_cells * settings.refine**2)
            if surplus <= TOO_MANY:
                break
            settings = settings.changed(size=settings.cell_size(section) * math.sqrt(surplus))
            mesh = free_mesh(section, settings, sizes_of(section, settings), path)
        return mesh

    return _built(section, "mapped", partial(build_mapped, section, settings), path)


def sizes_of(section: Section, settings: MeshSettings) -> Sizes:
    """Return the sizes of a free mesh by its settings."""
    far = DISTANT_SIZE_RATIO if section.beyond is not None else 1.0
    sizes = Sizes(settings.cell_size(section), settings.sizes_in(section), settings.towards_in(section), far_factor=far)
    return sizes.times(1.0 / settings.refine)


def free_mesh(section: Section, settings: MeshSettings, sizes: Sizes, path: Path | str | None = None) -> QuadMesh:
    """Make a free mesh of the given sizes, or of somewhat smaller ones, by the first of gmsh's algorithms that makes no
    bad cell.

    Of the settings, only the thickness matters at which a layer that thins out ends. If every attempt makes a bad cell,
    the function raises the BadMeshError of the first attempt. ``section``: the section of the ground; ``sizes``: sizes
    of cells (m); ``path``: path of the .msh file to write, or None.
    """
    try:
        return _in_fresh_processes.submit(
            make_free_mesh, section, settings, sizes, path and Path(path).absolute()
        ).result()
    except LostError as error:
        raise BadMeshError("the process of gmsh ended without a mesh; try another size of cells") from error


def make_free_mesh(section: Section, settings: MeshSettings, sizes: Sizes, path: Path | str | None = None) -> QuadMesh:
    """Make a free mesh in this process.

    ``section``, ``settings``, ``sizes``, ``path``: as in ``free_mesh``.
    """
    layers, _ = settings.meshed_layers(section)
    failure: BadMeshError | None = None
    best: QuadMesh | None = None
    tries = 0
    for scale, algorithm in product(SCALES, ALGORITHMS):
        build = partial(build_free, section, layers, sizes.times(scale), algorithm)
        try:
            mesh = _built(section, "free", build, path, layers, best)
        except BadMeshError as error:
            failure = failure or error
            continue
        tries += 1
        if best is None or _narrowest(mesh) > _narrowest(best):
            best = mesh
        if _narrowest(best) >= NARROW_ANGLE or tries == MOST_ALGORITHMS:
            break
    if best is None:
        assert failure is not None
        raise failure
    return best


def _narrowest(mesh: QuadMesh) -> float:
    """Return the smallest angle (deg) at a corner of a cell."""
    return float(corner_angles(mesh.points, mesh.cells).min())


def _built(
    section: Section,
    method: str,
    build: Callable[[], None],
    path: Path | str | None,
    layers: Layering | None = None,
    best: QuadMesh | None = None,
) -> QuadMesh:
    """Mesh in a separate gmsh session, and check the mesh, also against ``layers`` if they are given. If a path is
    given, write the mesh, unless the ``best`` mesh so far, which is already written there, has a wider narrowest
    corner.
    """
    with session(section.name):
        try:
            build()
        except InputError:
            raise
        except Exception as error:  # gmsh raises plain Exception with its last error message
            raise BadMeshError(f"gmsh gave up: {error}; try another size") from error
        mesh, tags = _from_gmsh(section, method)
        check(mesh)
        if method == "free":
            mesh = _with_wider_corners(mesh, tags)
        if layers is not None:
            refuse_other_ground(mesh, layers)
        if path is not None and (best is None or _narrowest(mesh) > _narrowest(best)):
            gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
            _write(Path(path), section)
    return mesh


@contextmanager
def session(name: str) -> Iterator[Any]:
    """Provide a quiet gmsh session with one empty model, which is closed after any error. All threads together have one
    session at a time."""
    with _one_session:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("General.NumThreads", 1)  # the same mesh on every machine
            gmsh.model.add(name)
            yield gmsh
        finally:
            gmsh.finalize()


def _with_wider_corners(mesh: QuadMesh, tags: np.ndarray) -> QuadMesh:
    """Return the mesh with wider corners, and move the nodes of the gmsh model; ``tags`` are gmsh's numbers of the
    nodes."""
    wider = with_wider_corners(mesh, WIDENED_ANGLE)
    for node in np.flatnonzero((wider.points != mesh.points).any(axis=1)):
        gmsh.model.mesh.setNode(int(tags[node]), [*wider.points[node], 0.0], [])
    return wider


def _from_gmsh(section: Section, method: str) -> tuple[QuadMesh, np.ndarray]:
    """Return the meshed gmsh model as arrays, its nodes numbered from 0 without gaps, and gmsh's numbers of the
    nodes."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    types, _, _ = gmsh.model.mesh.getElements(2)
    others = set(types) - {GMSH_QUADRILATERAL}
    if others:
        kind = gmsh.model.mesh.getElementProperties(next(iter(others)))[0]
        _, node_tags = gmsh.model.mesh.getElementsByType(next(iter(others)))
        place = coordinates.reshape(-1, 3)[np.flatnonzero(tags == node_tags[0])[0]]
        raise BadMeshError(f"gmsh made a {kind} near x = {place[0]:.2f} m, z = {place[1]:.2f} m; try another size")

    cells, stratum, boundaries = [], [], {}
    for k, group in enumerate(group_names([layer.name for layer in section.strata])):
        nodes = group_nodes(2, group, GMSH_QUADRILATERAL, 4)
        cells.append(nodes)
        stratum.append(np.full(len(nodes), k))
    for name in BOUNDARIES:
        boundaries[name] = group_nodes(1, name, GMSH_LINE, 2)
    quads = np.concatenate(cells)
    used = np.unique(quads)
    refuse_bare_ground(quads, np.concatenate(list(boundaries.values())), tags, coordinates)
    points = coordinates.reshape(-1, 3)[np.argsort(tags)][np.searchsorted(np.sort(tags), used), :2]
    mesh = QuadMesh(
        points=points,
        cells=np.searchsorted(used, quads),
        stratum=np.concatenate(stratum),
        strata=tuple(layer.name for layer in section.strata),
        boundaries={name: np.searchsorted(used, edges) for name, edges in boundaries.items()},
        method=method,
    )
    return mesh, used


def refuse_bare_ground(cells: np.ndarray, boundary: np.ndarray, tags: np.ndarray, coordinates: np.ndarray) -> None:
    """Raise BadMeshError unless the outer edges of the cells are the edges (n, 2) of the boundary.

    ``tags``, ``coordinates``: tags and coordinates of all nodes, as gmsh lists them.
    """
    bare = without_cells(cells, boundary)
    if len(bare):
        x, z, _ = coordinates.reshape(-1, 3)[np.flatnonzero(tags == bare[0, 0])[0]]
        raise BadMeshError(f"gmsh made no cells near x = {x:.2f} m, z = {z:.2f} m; try another size")


def refuse_other_ground(mesh: QuadMesh, layers: Layering) -> None:
    """Raise BadMeshError unless every stratum has the same area as in the layers, and the outline has the same length.

    Near the tip of a wedge gmsh has assigned ground to the wrong stratum, and has left a slit between two strata.
    """
    areas, wanted = mesh.stratum_areas(), layers.areas()
    worst = int(np.argmax(np.abs(areas - wanted)))
    if abs(areas[worst] - wanted[worst]) > AREA_TOLERANCE * wanted.sum():
        raise BadMeshError(
            f'gmsh meshed {areas[worst]:.6g} m² of stratum "{mesh.strata[worst]}", whose area is '
            f"{wanted[worst]:.6g} m²; try another size"
        )
    length = layers.perimeter()
    ends = mesh.points[np.concatenate(list(mesh.boundaries.values()))]
    around = float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())
    if abs(around - length) > AREA_TOLERANCE * length:
        raise BadMeshError(
            f"gmsh left a gap in the mesh: the outline of the mesh is {around:.6g} m long, that of the section "
            f"{length:.6g} m; try another size"
        )


def group_nodes(dimension: int, name: str, element_type: int, corners: int) -> np.ndarray:
    """Return the node tags (n, corners) of a named group, in the order of its entities.

    ``dimension``: dimension of the group; ``name``: name of the group; ``element_type``: gmsh's number; ``corners``:
    corners of an element.
    """
    for group_dimension, tag in gmsh.model.getPhysicalGroups(dimension):
        if gmsh.model.getPhysicalName(group_dimension, tag) == name:
            entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
            parts = [gmsh.model.mesh.getElementsByType(element_type, int(entity))[1] for entity in entities]
            return np.concatenate(parts).reshape(-1, corners)
    return np.empty((0, corners), dtype=np.uint64)


def _write(path: Path, section: Section) -> None:
    """Write the gmsh file, which also states whether a section is a reconstruction.

    Raises OSError if the file could not be written completely: gmsh itself would not report it.
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
