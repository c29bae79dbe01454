"""Defines the validated section of layered soil, read from and written to TOML."""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import compress
from pathlib import Path
from typing import Any, Self

import numpy as np
import tomli_w
from pydantic import Field, PrivateAttr, StrictBool, ValidationError, model_validator

from meshes.errors import InputError
from meshes.section import geometry_problems as checks
from meshes.section.beyond import Continuation, Slope, continuation, continuation_words
from meshes.section.cohesion_field import CohesionField
from meshes.section.consolidation import Consolidation
from meshes.section.cutting import Cutting, cut_films, cut_strata, key_in_file, named_strata, uncut_strata
from meshes.section.dense_lines import CELL, lines_by_place, mean_height, thinned_lines, with_lines, without_films
from meshes.section.flow import seepage_of
from meshes.section.flow_grid import Wall
from meshes.section.layering import Layering, Layers, elevations_below, layering
from meshes.section.line_order import in_order
from meshes.section.model import Model
from meshes.section.naming import naming_problems, without_other_tables
from meshes.section.plausibility import against_the_water, flow_notices, implausible, not_level, not_lower
from meshes.section.polyline import Line, Polyline
from meshes.section.quantity import Length
from meshes.section.seepage import Seepage
from meshes.section.sentences import sentences
from meshes.section.stratum import Stratum
from meshes.section.structure import Structure, structure_problems
from meshes.section.surcharge import Surcharge, SurfaceLoads
from meshes.section.toml_file import read_toml
from meshes.section.uplift import Uplift, uplift
from meshes.section.vertical_flow import heads_of, with_ends
from meshes.section.water import Water
from meshes.section.water_pressure import WaterPressure
from meshes.section.zone import Zone, with_elevations, with_materials, without_depth, zoned


class Section(Model):
    """Holds the section of a layered slope; x to the right and elevation upwards, in metres.

    Strata are listed from the top down. A stratum lies between its bottom line and the stratum above, and ends where
    its bottom line ends, meets the line above, or reaches the ground surface.
    """

    name: str = Field(
        description="name of the section and of its folder: up to 80 letters, digits and . _ -, such as s13",
        pattern=r"^[A-Za-z0-9][\w.-]{0,79}$",
    )
    title: str = Field(default="", description="title of the report and of pictures; by default the name")
    reconstruction: StrictBool = Field(
        default=False, description="true or false: whether the ground was inferred and not surveyed"
    )
    reconstruction_note: str = Field(default="", description="a sentence on what the reconstruction is inferred from")
    unusual: StrictBool = Field(
        default=False, description="true if unusual quantities of soils, water or loads are intended"
    )
    surface: Polyline = Field(description="the ground surface, [[x, elevation], ...]")
    base: Line = Field(description="lower boundary of the section, { elevation = ... } or { depth = ... }")
    water_table: Line | None = Field(default=None, description="water table for pictures, if densities include it")
    water: Water | None = Field(default=None, description="table [water]: the water table, or heads of seepage")
    surcharges: tuple[Surcharge, ...] = Field(default=(), description="loads on the ground, tables [[surcharges]]")
    consolidation: Consolidation | None = Field(
        default=None,
        description="table [consolidation]: an earlier state that ocr and pre_overburden_pressure refer to",
    )
    beyond: Length | None = Field(
        default=None, description='length over which ground and water continue beyond both ends, such as "100 m"'
    )
    beyond_slope: Slope = Field(
        default="level", description='slope of the ground there: "level", or "parallel" to its last stretch'
    )
    structures: tuple[Structure, ...] = Field(
        default=(), description="structures that failures endanger, a table [[structures]] each; by default embankments"
    )
    strata: tuple[Stratum, ...] = Field(min_length=1, description="one [[strata]] table for each layer")
    zones: tuple[Zone, ...] = Field(
        default=(),
        description="zones of any outline, in place of strata, a table [[zones]] each, with the keys of [[strata]]",
    )

    _zone_notices: tuple[str, ...] = PrivateAttr(default=())  # what became of zones, which are strata once it is read
    _line_notices: tuple[str, ...] = PrivateAttr(default=())  # what became of points that a mesh cannot use
    _seepage: Seepage | None = PrivateAttr(default=None)  # found once, for all sections that derive from this one
    _after_shaking: bool = PrivateAttr(default=False)  # whether excess pore pressure acts without a seismic force

    @model_validator(mode="before")
    @classmethod
    def _materials(cls, data: Any) -> Any:
        return with_materials(data) if isinstance(data, Mapping) else data

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        problems = list(naming_problems(names := [soil.name for soil in (*self.strata, *self.zones)]))
        if self.reconstruction and not self.reconstruction_note.strip():
            problems.append("reconstruction_note: expected a sentence that says what was reconstructed from what")
        bottoms, waters = [stratum.bottom for stratum in self.strata], self._water_lines()
        problems += checks.geometry_problems(self.surface, self.base, waters, bottoms, names[: len(bottoms)])
        if not self.unusual:
            soils = [zone.soil.in_table(f"zones {k}") for k, zone in enumerate(self.zones, 1) if not zone.material]
            problems += implausible([*self.strata, *soils], self.water, self.surcharges)
        if not problems:
            problems += self._apply_zones()
        if not problems:
            problems += checks.water_problems(self.water, self.water_table, self.strata, self.consolidation)
            problems += checks.surcharge_problems(self.surcharges, *self.given_extent)
            problems += structure_problems(self.structures, self.given_extent)
        if not problems and self.water is not None and self.water.cutoffs:
            problems += checks.cutoff_problems(self.water.cutoffs, self.layering)
        if problems:
            raise ValueError("\n".join(dict.fromkeys(problems)))
        return self

    def _complete_vertical_flow(self) -> None:
        """Give vertical flow through strata the lines that the file leaves out."""
        self.__dict__.update(strata=with_ends(self.surface, self.base, self.strata, (self.water or Water()).table))

    def _apply_zones(self) -> list[str]:
        """Make strata of the zones, raise the ground where zones lie above it, and return the faults of zones.

        After this step the section cannot be changed, and has no zones. Vertical flow has all of its lines.
        """
        self._complete_vertical_flow()
        if not self.zones:
            return []
        ground = zoned(self.surface, self.base, self.strata, self.zones)
        if not ground.problems:
            if ground.surface != self.surface:  # depths of water are below the ground as it is without zones
                before = np.array(self.surface, dtype=float)
                self.__dict__.update(water_table=without_depth(before, self.water_table))
                for key, lines in (("water", ("table", "after_drawdown")), ("consolidation", ("table", "surface"))):
                    if (table := getattr(self, key)) is not None:
                        self.__dict__[key] = with_elevations(before, table, lines)
            self.__dict__.update(surface=ground.surface, base=ground.base, strata=ground.strata, zones=())
            self._complete_vertical_flow()
            self._zone_notices = tuple(ground.notices)
        return ground.problems

    def _water_lines(self) -> dict[str, Line | None]:
        """Return the lines of water from side to side, by their keys."""
        water, drawn = self.water or Water(), self.water_table
        return {"water_table": drawn, "water, table": water.table, "water, after_drawdown": water.after_drawdown}

    @cached_property
    def layering(self) -> Layering:
        """Return the layers between breakpoints."""
        return self._layers.layering

    @cached_property
    def _layers(self) -> Layers:
        return self._layers_with(())

    def _layers_with(self, more: Iterable[float], strata: Sequence[Stratum] | None = None) -> Layers:
        strata = strata or self.strata
        bottoms = [stratum.bottom for stratum in strata]
        base, ends = self.base, [x for load in self.surcharges for x in (load.start, load.end)]
        if (beyond := self._continuation) is not None:
            base, bottoms = beyond.line(base), [bottom and beyond.line(bottom) for bottom in bottoms]
        return layering(self.ground, base, bottoms, [*ends, *more], named_strata(s.name for s in strata))

    def layering_cut_at(self, x: Iterable[float]) -> Layering:
        """Return the layers with additional breakpoints at x (m)."""
        return self._layers_with(x).layering

    @cached_property
    def _continuation(self) -> Continuation | None:
        surface = np.array(self.surface, dtype=float)
        return None if self.beyond is None else continuation(surface, self.beyond, self.beyond_slope)

    @property
    def ground(self) -> np.ndarray:
        """Return the ground surface (n, 2) from side to side (m), including the ground beyond the given ends."""
        surface = np.array(self.surface, dtype=float)
        return surface if self._continuation is None else self._continuation.elevations(surface)

    @property
    def notices(self) -> list[str]:
        """Return notices on a valid section, which state what was changed when it was read, one sentence each."""
        notices = [*self._zone_notices, *self._line_notices, *(f"geometry: {text}" for text in self._layers.notices)]
        notices += [text.split(";")[0] for text in implausible(self.strata, self.water, self.surcharges)]
        drawn = None if self.water_table is None else self.elevations_of(self.water_table)
        before, after = self.water_pressure.table_before, self.water_pressure.table_after
        table = before if self.water_pressure.flow is None else self.water_points()
        notices += against_the_water(self.layering, self.strata, drawn, table)
        if after is not None:
            notices += [*not_level(self.ground, after), *(not_lower(table, after) if table is before else [])]
        notices += [*flow_notices(self.water_pressure), *([self.uplift.description] if self.uplift else [])]
        notices += [f"{key_in_file(self.strata, k)}: {words}" for k, words in self.cohesion_field.notices]
        notices += self.surface_loads.notices
        if self.beyond is not None:
            notices.append(continuation_words(self.beyond, self.beyond_slope, *self.given_extent))
        return list(dict.fromkeys(notices))  # parts of a soil have their notice once

    @property
    def heading(self) -> str:
        """Return the heading of the pictures: the title of the section, or its name if it has no title."""
        return self.title or self.name

    @property
    def liquefies(self) -> bool:
        """Return whether any stratum liquefies in any case."""
        return any(stratum.liquefies_in for stratum in self.strata)

    @property
    def extent(self) -> tuple[float, float]:
        """Return x (m) of the left and the right side."""
        return float(self.ground[0, 0]), float(self.ground[-1, 0])

    @property
    def given_extent(self) -> tuple[float, float]:
        """Return x (m) of the given ends of the section, without the ground that was added beyond."""
        return float(self.surface[0][0]), float(self.surface[-1][0])

    def outline(self) -> np.ndarray:
        """Return the outline (n, 2) of the section (m), counter-clockwise."""
        return self.layering.outline()

    def stratum_at(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Return the index of the stratum at each point (m), -1 outside the section."""
        return self.layering.stratum_at(x, z)

    def elevations_of(self, line: Line) -> np.ndarray:
        """Return a line as elevations (n, 2) in metres. A line that ends inside the section continues horizontally."""
        line = line if self._continuation is None else self._continuation.line(line)
        points = line.points(*self.extent) if line.depth is None else elevations_below(self.ground, line)
        left, right = self.extent
        if points[0, 0] > left:
            points = np.vstack([[left, points[0, 1]], points])
        if points[-1, 0] < right:
            points = np.vstack([points, [right, points[-1, 1]]])
        return points

    def water_points(self) -> np.ndarray | None:
        """Return the water table (before a drawdown) as elevations (n, 2) in metres, or None."""
        if (flow := self.water_pressure.flow) is not None:
            return flow.water_line
        table = self.water_table if self.water is None else self.water.table
        return None if table is None else self.elevations_of(table)

    def water_points_after_drawdown(self) -> np.ndarray | None:
        """Return the water table after a drawdown as elevations (n, 2) in metres; None without a drawdown."""
        lowered = None if self.water is None else self.water.after_drawdown
        return None if lowered is None else self.elevations_of(lowered)

    @cached_property
    def water_pressure(self) -> WaterPressure:
        """Return the pressure of the water in the pores and on the ground."""
        water = self.water or Water()
        before = None if water.table is None else self.elevations_of(water.table)
        after = before if water.after_drawdown is None else self.elevations_of(water.after_drawdown)
        heads = heads_of(self.strata, water.table, water.after_drawdown, self.elevations_of)
        levels = [before if s.piezometric_level is None else self.elevations_of(s.piezometric_level)
                  for s in self.strata]  # fmt: skip
        levels = [level if head is None else head.water_level for head, level in zip(heads, levels, strict=True)]
        still = WaterPressure(
            self.layering, self.strata, water.unit_weight, tuple(levels), tuple(heads), before, after,
            water.head == "normal", water.westergaard, after_shaking=self._after_shaking)  # fmt: skip
        return self._with_flow(still) if water.flow else still

    def _with_flow(self, still: WaterPressure) -> WaterPressure:
        """Return the water with its seepage, computed in the strata as written in the file."""
        if self._seepage is None:
            whole = uncut_strata(self.strata)
            walls = [] if self.water is None else [Wall(wall.x, wall.bottom) for wall in self.water.cutoffs]
            self._seepage = seepage_of(self.name, whole, lambda x: self._layers_with(x, whole).layering, still, walls)
        return replace(still, levels=(self._seepage.water_line,) * len(self.strata), flow=self._seepage)

    def after_shaking(self) -> "Section":
        """Return the section at rest with the excess pore pressure that shaking leaves behind."""
        section = self._derived(self.strata)
        section._after_shaking = True
        return section

    @cached_property
    def cohesion_field(self) -> CohesionField:
        """Return the cohesion at any point of the ground."""
        return CohesionField.of(self.surface_loads, self.elevations_of, self.consolidation)

    @cached_property
    def uplift(self) -> Uplift | None:
        """Return the place where pore pressure exceeds the weight above it by most; None if there is none."""
        return uplift(self.layering, self.strata, self.surface_loads)

    @property
    def surface_loads(self) -> SurfaceLoads:
        """Return the loads on the ground surface other than static water."""
        return SurfaceLoads(self.surcharges, self.water_pressure)

    def thinned(self) -> "Section":
        """Return the section without points of its lines that are too dense for any mesh, and a notice."""
        lines = lines_by_place(self.surface, self.base, self.water_table, self.strata, self.water)
        fewer_points, tolerance = thinned_lines(lines, CELL * mean_height(self.surface, self.base))
        if tolerance == 0.0:
            return self
        data = self.model_dump(mode="python", exclude_none=True, by_alias=True)
        data, gone = without_films(with_lines(data, fewer_points))
        tables = {s.name: s.file_table or (f"strata {k}" if gone else "") for k, s in enumerate(self.strata, start=1)}
        thinned = type(self).model_validate(data)
        thinned = thinned._derived([s.in_table(tables[s.name]) for s in thinned.strata])
        thinned._zone_notices = self._zone_notices
        thinned._line_notices = (
            *self._line_notices,
            f"geometry: lines have more points than cells can resolve, and were thinned: {len(thinned.surface)} of "
            f"{len(self.surface)} points of the ground remain, within {tolerance:.2g} m of their running median",
            *(f'geometry: stratum "{name}" is thinner than these lines are exact, and is left out' for name in gone),
        )
        return thinned

    def cut_at_water(self) -> "Section":
        """Return the section with strata divided where water crosses them, with saturated density below."""
        return self._cut_by(cut_strata)

    @cached_property
    def cut_at_films(self) -> "Section":
        """Return the section for bounds, divided at water even where a part is a film too thin for elements."""
        return self._cut_by(cut_films)

    def _cut_by(self, cutting: Cutting) -> "Section":
        if self.water is None and not any(s.confined for s in self.strata):
            return self
        strata = cutting(self.strata, self.layering, self.water_pressure.saturation_levels, self.given_extent)
        if strata == self.strata:
            return self
        # The model has two densities; a third one is that of a film of moist ground in a stratum below water.
        return self.with_strata(
            [s.model_copy(update={"density": None}) if s.density == s.density_ordinary else s for s in strata]
        )

    def with_strata(self, strata: Sequence[Stratum]) -> "Section":
        """Return the section with ``strata`` derived from the present strata; strata without area are left out.

        The strata are not validated: derived values may be implausible in a file, such as a cohesion of 1 Pa.

        Parameters
        ----------
        strata : sequence of Stratum
            Strata from the top down, as in a file; names, lines and quantities that are consistent.
        """
        section = self._derived(strata)
        has_area = section.layering.areas() > 0.0
        return section if has_area.all() else self.with_strata(list(compress(strata, has_area)))

    def _derived(self, strata: Sequence[Stratum]) -> "Section":
        """Return the section with other strata, without the checks of values that a user writes."""
        section = Section.model_construct(**{**dict(self), "strata": tuple(strata)})
        for name in ("_after_shaking", "_line_notices", "_seepage", "_zone_notices"):
            setattr(section, name, getattr(self, name))
        return section

    def __getstate__(self) -> dict[Any, Any]:
        """Return the fields as state for another process, where derived quantities are computed again."""
        state = super().__getstate__()
        return {**state, "__dict__": {name: getattr(self, name) for name in type(self).model_fields}}

    @classmethod
    def read(cls, path: Path | str) -> "Section":
        """Read the section in a TOML file; raise InputError with every problem found."""
        return cls.parse(read_toml(path), str(path))

    @classmethod
    def parse(cls, data: Mapping[str, Any], source: str = "section") -> "Section":
        """Make the section from the contents of a TOML file; raise InputError with every problem found.

        Tables of other parts of the program (mesh, solvers, pictures) are ignored; a table whose name is nearly that of
        a key of a section is refused.
        """
        return cls.as_written(data, source).thinned().cut_at_water()

    @classmethod
    def as_written(cls, data: Mapping[str, Any], source: str = "section") -> "Section":
        """Return the section with the lines and strata of the file, without thinned lines and divided strata."""
        known, moved = in_order(without_other_tables(data, cls.model_fields))
        try:
            section = cls.model_validate(known)
        except ValidationError as error:
            problems = sentences(error, known, cls)
            # pydantic validates the whole only if all parts are valid; here both are reported at once.
            if not any(entry["loc"] == () for entry in error.errors()):
                problems += checks.problems_of_the_rest(known)
            raise InputError(source, list(dict.fromkeys(problems))) from error
        section._line_notices = tuple(moved)
        return section

    def to_toml(self) -> str:
        """Return the section as TOML with all defaults filled in and quantities as they were written."""
        return tomli_w.dumps(self.model_dump(mode="python", exclude_none=True, by_alias=True))

    def sha256(self) -> str:
        """Return a fingerprint of the ground, which does not depend on the name of the section."""
        ground = self.model_dump(
            mode="python", exclude_none=True, by_alias=True, exclude={"name", "title", "structures"}
        )
        return hashlib.sha256(tomli_w.dumps(ground).encode()).hexdigest()
