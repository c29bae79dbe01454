"""Defines the settings of meshes, the table [mesh] of the input file."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import Field

from meshes.blocks import ROWS, WIDER, blocks_of, divisions, largest_corner
from meshes.section.cutting import BELOW_WATER, unknown_strata, value_of_stratum
from meshes.section.layering import Layering
from meshes.section.quantity import Length
from meshes.section.section import Model, Section
from meshes.thinning import stepped, without_needless

# More quadrilaterals than this need more memory than most machines have (gmsh alone takes about 1 kB for each).
MOST_QUADRILATERALS = 5_000_000

# How far the refinement towards an interface reaches, in sizes there, before the ordinary size is back.
GROWTH_REACH = 10.0

# The largest angle (deg) in the corners of a mapped mesh that is made where nothing is said. Columns under a face are
# sheared by as much as it is steep, and bands of shear cannot follow sheared cells: with about 600 cells a free mesh
# gives the same critical Kh at 30 deg (120 in the corners), 2 % less at 45, 7 % less at 60, 24 % less at 75.
LARGEST_CORNER = 130.0

# A layer that thins out ends where it is this share of the size of cells thick.
THINNEST = 1.0 / 3.0


class MeshSettings(Model):
    """Holds the settings of meshes, the table [mesh] of the input file. Sizes are edge lengths (m)."""

    method: Literal["auto", "mapped", "free"] = Field(
        default="auto",
        description=(
            'kind of mesh: "mapped" (in columns and rows), "free", or "auto" (mapped where the layers '
            "allow it, else free)"
        ),
    )
    columns: int | None = Field(default=None, ge=1, description="number of columns of a mapped mesh")
    rows: int | None = Field(default=None, ge=1, description="number of rows of a mapped mesh")
    size: Length | None = Field(default=None, description="target size of the cells, a length such as 2.0")
    sizes: dict[str, Length] = Field(
        default={}, description='target sizes of the cells in strata, each as "name" = size'
    )
    towards: dict[str, Length] = Field(
        default={},
        description=(
            'target sizes of the cells along "surface", "base" or the bottom of a stratum, each as "name" = size'
        ),
    )
    least_thickness: Length | None = Field(
        default=None,
        description=(
            "thickness at which a layer that thins out ends in a step, in a free mesh; by default a third "
            "of the size of a cell"
        ),
    )
    max_cells: int = Field(
        default=3000,
        ge=100,
        le=MOST_QUADRILATERALS,
        description="approximate largest number of cells of a mesh without given size or columns and rows, "
        "before refine; by default 3000, or fem.max_cells if that is smaller",
    )
    refine: int = Field(default=1, ge=1, le=64, description="whole number by which all sizes of cells are divided")

    def unknown_names(self, strata: Sequence[str]) -> list[str]:
        """Return the names in settings that are none of the ``strata``, one sentence each."""
        known = {"sizes": [*strata], "towards": [*strata, "surface", "base"]}
        return [
            f'mesh, {table}: there is no "{name}"; expected one of {", ".join(known[table])}'
            for table in known
            for name in unknown_strata(getattr(self, table), known[table])
        ]

    def problems(self, section: Section) -> list[str]:
        """Return settings that do not fit the section or each other, one sentence each."""
        problems = []
        counted, graded = bool(self.columns or self.rows), bool(self.sizes or self.towards)
        if self.method == "free" and counted:
            problems.append('mesh, columns and rows: expected none with method = "free", whose cells follow from sizes')
        if graded and (self.method == "mapped" or counted):
            problems.append('mesh, sizes and towards: expected none with columns and rows; they need method = "free"')
        if self.size and self.columns and self.rows:
            problems.append("mesh, size: expected either a size or both columns and rows")
        largest = float(np.ptp(section.outline(), axis=0).max())
        if self.size and self.size > largest:
            problems.append(f"mesh, size = {self.size:g} m: expected at most the section's own size, {largest:g} m")
        names = [stratum.name for stratum in section.strata]
        if (
            not problems
            and not self.unknown_names(names)
            and (count := self.expected_quadrilaterals(section)) > MOST_QUADRILATERALS
        ):
            problems.append(
                f"mesh: sizes and refine would make about {count:.1g} quadrilaterals; expected at most "
                f"{MOST_QUADRILATERALS:,}"
            )
        return problems

    def at_most(self, cells: int) -> "MeshSettings":
        """Return the settings with at most so many ``cells``, unless they state a number."""
        if "max_cells" in self.model_fields_set or cells >= self.max_cells:
            return self
        return self.changed(max_cells=cells)

    def method_for(self, section: Section) -> Literal["mapped", "free"]:
        """Return the method in the settings. For "auto", it is mapped if columns or rows are set, or if layers and
        slopes allow it."""
        if self.method != "auto":
            return self.method
        if self.sizes or self.towards:
            return "free"
        if self.columns or self.rows:
            return "mapped"
        blocks = blocks_of(section)
        return "free" if isinstance(blocks, str) or largest_corner(blocks) > LARGEST_CORNER else "mapped"

    def expected_quadrilaterals(self, section: Section) -> float:
        """Return the approximate number of quadrilaterals of a mesh; 0 if a mapped mesh will be refused."""
        if self.method_for(section) == "mapped":
            blocks = blocks_of(section)
            if isinstance(blocks, str):
                return 0.0
            columns, rows = divisions(blocks, self.columns, self.rows, self.size, self.max_cells)
            return float(columns) * rows * self.refine**2
        size = self.cell_size(section)
        wanted = [min(self.sizes_in(section).get(stratum.name, size), size) for stratum in section.strata]
        count = float((section.layering.areas() / np.square(wanted)).sum())
        left, right = section.extent
        for name, near in self.towards.items():
            # On one side of a line of length L the size grows from s to S over GROWTH_REACH S: GROWTH_REACH L / s
            sides = 1.0 if name in ("surface", "base") else 2.0
            count += sides * GROWTH_REACH * (right - left) / near if near < size else 0.0
        return count * self.refine**2

    def cell_size(self, section: Section) -> float:
        """Return the target size (m) in the settings. Without one, it is a twelfth of the mean height of the section,
        or more because of ``max_cells``."""
        if self.size is not None:
            return self.size
        left, right = section.extent
        area = float(section.layering.areas().sum())
        return max(area / (right - left) / ROWS, math.sqrt(area / self.max_cells))

    def sizes_in(self, section: Section) -> dict[str, float]:
        """Return `sizes` by the names of all strata with a size of their own, including parts that water cut off."""
        sizes = {stratum.name: value_of_stratum(self.sizes, stratum.name) for stratum in section.strata}
        return {name: size for name, size in sizes.items() if size is not None}

    def towards_in(self, section: Section) -> dict[str, float]:
        """Return `towards` by the names of all lines. The bottom of a stratum that water divides is that of its lower
        part."""
        names = [stratum.name for stratum in section.strata]
        lower = {name: name + BELOW_WATER for name in names if name + BELOW_WATER in names}
        return {lower.get(name, name): size for name, size in self.towards.items()}

    def meshed_layers(self, section: Section) -> tuple[Layering, list[str]]:
        """Return the layers as they are meshed, and their differences from the layers of the section, one sentence
        each."""
        names = [stratum.name for stratum in section.strata]
        if self.method_for(section) == "mapped":
            return section.layering, []
        least = self.least_thickness or THINNEST * self.cell_size(section) / self.refine
        layers, notices = stepped(section.layering, least, names, _strengths(section))
        return without_needless(layers, self.cell_size(section) / self.refine), notices

    def notices(self, section: Section) -> list[str]:
        """Return notices on the mesh before it is made, one sentence each."""
        notices = self.meshed_layers(section)[1]
        left, right = section.extent
        length, height = right - left, float(section.layering.areas().sum()) / (right - left)
        fewest = length / height * ROWS**2 / (WIDER if self.method_for(section) == "mapped" else 1.0)
        if self.size is None and self.columns is None and self.rows is None and fewest > 1.2 * self.max_cells:
            notices.append(
                f"mesh: the section is {length / height:.0f} times as long as it is high on the average, which takes "
                f"{fewest:,.0f} cells with {ROWS} in the height; the mesh has about {self.max_cells:,} "
                "larger ones (max_cells, or size, in [mesh])"
            )
        blocks = blocks_of(section) if self.method_for(section) == "mapped" else ""
        if not isinstance(blocks, str) and (angle := largest_corner(blocks)) > LARGEST_CORNER:
            notices.append(
                f"mesh: columns are sheared, to {angle:.0f} deg in the corners of cells, and the critical Kh comes out "
                'too large; method = "free" makes better cells'
            )
        return notices


def _strengths(section: Section) -> np.ndarray:
    """Return the cohesion (Pa) of every stratum and the growth of its strength with effective stress (-), (strata,
    2)."""
    return np.array(
        [
            (max(s.cohesion, s.cohesion_minimum or 0.0), math.tan(s.friction_angle) + (s.strength_ratio or 0.0))
            for s in section.strata
        ]
    )
