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
    balance a step with a horizontal (seismic) component, since the stress tensor is symmetric.
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
    mesh = triangulate(section, float(sizes.max()), named, repeats)
    fanned = [x for load in section.surcharges for x in (load.start, load.end)]
    fanned += list(section.extent) if sides == "smooth" else []
    if not fanned:
        return mesh
    at_ends, surface = np.zeros(len(mesh.points), dtype=bool), np.unique(mesh.boundaries["surface"])
    near = np.abs(mesh.points[surface, 0][:, None] - np.array(fanned)).min(axis=1)
    at_ends[surface] = near <= layers.tolerance
    return fan_out(mesh, at_ends, WIDE_CORNER)[0]
