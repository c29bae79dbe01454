"""Makes the first triangles of a search for bounds, about as large as the layers are thick."""

import numpy as np

from fem.continuum.repetition import refuse_other_sides
from fem.limit.bracket import COST_EXPONENT
from fem.settings import Sides
from meshes.bisection import fan_out
from meshes.section.cutting import whole_soil, without_film
from meshes.section.section import Section
from meshes.triangles import TriMesh, triangulate

# Cells in the height of the section to start from, and in the thickness of a layer.
CELLS_IN_HEIGHT, CELLS_IN_LAYER = 5.0, 0.8
# Smallest edge of the triangles of a thin part of a soil, which water or cracks cut off, as a share of the largest
# edge: the part has triangles as thin as itself. With edges as long as a part of 4 cm is thick all triangles went into
# this part.
SMALLEST_SHARE_OF_SIZE = 1.0 / 12.0
# The first mesh has at most this share of the cells allowed.
FIRST_SHARE = 0.15
# Both bounds on CELLS_SOLVED triangles take SECONDS_SOLVED (s on the reference machine of ``cone_program``).
CELLS_SOLVED, SECONDS_SOLVED = 2900, 1.4
# Angle (rad) of triangles above which those where a smooth side meets the ground, or a surcharge ends, are halved.
WIDE_CORNER = 0.5
# The same where ground without strength at its surface bends, at the MOST_BENDS points with the largest bends of at
# least LEAST_BEND (rad). With 0.25 the lower bound of a clay slope stays 15 % smaller.
NARROW_CORNER, MOST_BENDS, LEAST_BEND = 0.1, 6, 0.1
# Cohesion (Pa) below which ground has no strength.
NO_STRENGTH = 1.0


def cells_of_first_search(max_cells: int, seconds: float) -> int:
    """Return the largest number of triangles with which `first_mesh` can be solved in ``seconds`` on the reference
    machine of ``cone_program``."""
    cells = CELLS_SOLVED * (max(seconds, 0.0) / SECONDS_SOLVED) ** (1.0 / COST_EXPONENT)
    return int(min(max_cells, cells / FIRST_SHARE + 1.0))


def first_mesh(section: Section, max_cells: int, sides: Sides = "free-field") -> TriMesh:
    """Make triangles about as large as the layers are thick, or larger if there would be too many triangles. If the
    ``sides`` are periodic, both are divided into equal edges; raises InputError if the layers of both sides differ.

    Where the water table divides a stratum, triangles of a thin part are as thin as this part and as long as other
    triangles of the stratum. Several triangles meet at the point where a smooth side reaches the ground surface: under
    a seismic force bare sand has shear stress along the surface and none along the side, and a single triangle at this
    point has an admissible stress at Kh = 0 only. Several triangles also meet at the ends of surcharges: two triangles
    on straight ground balance a vertical step of the load only if the stress jumps along their common edge, and cannot
    balance a step with a horizontal (seismic) component, since the stress tensor is symmetric. Many triangles meet
    where clay without strength at its surface bends: stresses are zero at this point, so that the stress of each
    triangle is proportional to the distance, and turns from triangle to triangle only.
    """
    repeats = sides == "periodic"
    if repeats:
        refuse_other_sides(section)
    layers = section.layering
    areas = layers.areas()
    across = (layers.present() * layers.width[:, None]).sum(axis=0)
    height = float(np.ptp(section.outline()[:, 1]))
    names = [stratum.name for stratum in section.strata]
    soils = [whole_soil(without_film(name)) for name in names]
    largest = height / CELLS_IN_HEIGHT
    smallest = [SMALLEST_SHARE_OF_SIZE * largest if soils.count(soil) > 1 else 0.0 for soil in soils]
    sizes = np.clip(areas / across / CELLS_IN_LAYER, smallest, largest)
    sizes = sizes[[names.index(without_film(name)) for name in names]]
    expected = float((areas / (0.43 * sizes**2)).sum())
    sizes *= max(1.0, np.sqrt(expected / (FIRST_SHARE * max_cells)))
    named = {name: float(h) for name, h in zip(names, sizes, strict=True)}
    mesh = _with_fans(section, triangulate(section, float(sizes.max()), named, repeats))
    fanned = [x for load in section.surcharges for x in (load.start, load.end)]
    fanned += list(section.extent) if sides == "smooth" else []
    if not fanned:
        return mesh
    at_ends, surface = np.zeros(len(mesh.points), dtype=bool), np.unique(mesh.boundaries["surface"])
    near = np.abs(mesh.points[surface, 0][:, None] - np.array(fanned)).min(axis=1)
    at_ends[surface] = near <= layers.tolerance
    return fan_out(mesh, at_ends, WIDE_CORNER)[0]


def _with_fans(section: Section, mesh: TriMesh) -> TriMesh:
    """Return the mesh with narrow triangles around the points where ground without strength bends."""
    field, ground = section.cohesion_field, section.ground
    clay = np.array([stratum.friction_angle == 0.0 for stratum in section.strata])
    if not (field.varies & clay).any():
        return mesh
    bend = np.abs(np.diff(np.arctan2(*np.diff(ground, axis=0).T[::-1])))
    largest = np.argsort(-bend, kind="stable")[:MOST_BENDS]
    bends = ground[1:-1][largest[bend[largest] >= LEAST_BEND]]
    strength = field.corners(mesh.points[mesh.cells], mesh.stratum, above=False)
    strength = np.where(clay[mesh.stratum][:, None], strength, np.inf).ravel()
    strongest = np.zeros(len(mesh.points))
    np.maximum.at(strongest, mesh.cells.ravel(), strength)
    at = np.zeros(len(mesh.points), dtype=bool)
    for place in bends:
        nearest = int(np.argmin(np.hypot(*(mesh.points - place).T)))
        at[nearest] = strongest[nearest] < NO_STRENGTH
    cells = 0
    while at.any() and len(mesh.cells) > cells:
        cells = len(mesh.cells)
        mesh, _ = fan_out(mesh, np.append(at, np.zeros(len(mesh.points) - len(at), dtype=bool)), NARROW_CORNER)
    return mesh
