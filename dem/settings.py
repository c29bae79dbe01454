"""Defines the settings of the discs and of slides: the tables [dem] and [slide] of the input file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool

from dem.case import LOOSE_SAND, PAPER_CASES, Case
from dem.disc_count import DISCS_ACROSS_LAYER, FEWEST_DISCS, MOST_DISCS, lattice_radius
from dem.springs import Mean
from meshes.section.cutting import unknown_strata
from meshes.section.motion_units import RecordComponent, RecordUnit
from meshes.section.quantity import Length
from meshes.section.recorded_kh import RecordedKh
from meshes.section.section import Model, Section

DiscModelName = Literal["soil", "paper"]
SlideMethod = Literal["discs", "mpm"]
# Of one Kh, and of the search for the critical one.
TrialVerdict = Literal["stands", "fails", "undecided"]
SearchVerdict = Literal["bracketed", "stands everywhere", "fails under its own weight", "undecided"]
TABLE2_STRATA = 10
# Patches of soil discs have 0.99 of what is left to them after the peak at 3.4 times the strain at which an elastic
# body of the same E has it (3.8 in the sands of S-13, 2.7 in its clays); the continuum, too, is looked at at 0.99
GROWTH: Mapping[DiscModelName, float] = {"soil": 3.5, "paper": 3.0}
FACTORS: Mapping[DiscModelName, tuple[float, float]] = {"soil": (0.75, 1.33), "paper": (0.1, 10.0)}
SEEDS: Mapping[DiscModelName, tuple[int, ...]] = {"soil": (1, 2), "paper": ()}
# s: sand liquefies over some cycles of shaking, and what loses its strength at once is thrown; the paper's does
ONSET: Mapping[DiscModelName, float] = {"soil": 5.0, "paper": 0.0}
# soil discs have dashpots a tenth as large; the energy of both kinds balances with these
STEP: Mapping[DiscModelName, float] = {"soil": 0.9, "paper": 0.6}
PAPER_LOADING: Mapping[str, Any] = {  # of the paper, Sec. 4(3): Kh = 0.1, for ever
    "kh": 0.1, "kh_seconds": None, "kh_cycles": None, "kh_period": None, "accelerogram": "",
}  # fmt: skip
CASES: Mapping[DiscModelName, tuple[Case, ...]] = {"soil": LOOSE_SAND, "paper": PAPER_CASES}  # default cases
# Settings of [dem] that soil discs do not know.
OF_THE_PAPER = tuple(
    f"dem.{key}"
    for key in ("packing", "porosity", "springs", "damping_ratio", "kh_limit", "resolution", "allowed_overlap")
)
Parameter = Literal["stiffness", "friction", "pore_strength", "strength", "all"]


class DemSettings(Model):
    """Holds the settings of discs and of their critical Kh, the table [dem] of the input file."""

    model: DiscModelName = Field(
        default="soil",
        description=(
            '"soil": random discs whose contacts follow from element tests; "paper": the discs of the '
            "paper, in rows, with springs for contacts and breakable springs for pore water"
        ),
    )
    paper: StrictBool = Field(
        default=False,
        description="true to compute also the discs of the paper, unchanged and with the paper's constant Kh of 0.1",
    )
    packing: Literal["auto", "box", "lattice", "random"] = Field(
        default="auto",
        description=(
            'arrangement of the discs with model = "paper": "box" (rows parallel to the mean surface, '
            'gravity tilted), "lattice" (the same rows cut to the outline), "random", or "auto" (box '
            "where surface and base are straight and parallel, else random); soil discs are always random"
        ),
    )
    radius: Length | None = Field(default=None, description='mean radius of the discs, such as "0.75 m"')
    elements: int = Field(
        default=FEWEST_DISCS,
        ge=50,
        le=1_000_000,
        description=(
            f"number of discs if no radius is given; in a section file up to {MOST_DISCS} soil discs by default, so "
            f"that the thinnest layer that liquefies, or lies on such a layer, is {DISCS_ACROSS_LAYER:g} discs thick"
        ),
    )
    spread: float = Field(
        default=0.2,
        ge=0.0,
        lt=0.9,
        description="half the width of the range of radii in a random packing, over the mean radius",
    )
    porosity: float = Field(
        default=0.2,
        gt=0.1,
        lt=0.5,
        description=(
            "least porosity, the area of the voids over the total area, of a random packing with model = "
            '"paper"; soil discs have the porosity of their element tests'
        ),
    )
    seed: int = Field(default=0, ge=0, description="seed of the random packing")
    springs: Literal["soil", "table2"] = Field(
        default="soil",
        description=(
            'springs of the discs with model = "paper": "soil" for eqs. (5)-(13) of the paper with the '
            'properties of the strata, or "table2" for Table 2 of the paper'
        ),
    )
    stiffness_scale: float = Field(
        default=0.01, gt=0.0, description="factor on the springs of eqs. (9)-(13) of the paper"
    )
    damping_ratio: float = Field(
        default=1.0, ge=0.0, description="factor on the dashpots sqrt(m K) with the mass m and the stiffness K"
    )
    mean: Mean = Field(
        default="arithmetic", description="kind of mean of the constants of two layers at a contact between them"
    )
    kh: RecordedKh = Field(
        default=(0.2, 0.3), description="seismic coefficients at which the state of the discs is stored"
    )
    kh_limit: float = Field(default=1.0, gt=0.0, description="largest Kh: the search for the critical Kh ends there")
    resolution: float = Field(
        default=0.005, gt=0.0, le=0.1, description="width of the bracket of the critical Kh at which the search ends"
    )
    unbalanced: float = Field(
        default=4e-4,
        gt=0.0,
        le=1e-2,
        description="largest mean unbalanced force, over the mean contact force, of discs that stand",
    )
    kinetic: float = Field(
        default=1e-5,
        gt=0.0,
        description="largest kinetic energy, over the stored energy, of discs that stand",
    )
    growth: float | None = Field(
        default=None,
        gt=1.0,
        description=(
            "displacement at which the discs count as failed. For the discs of the paper it is a multiple "
            "of the elastic displacement (3 by default), for soil discs a multiple of the displacement at "
            "which the FEM reaches its critical Kh (3.5 by default)"
        ),
    )
    patience: float = Field(
        default=15.0, gt=0.0, description="number of natural periods of the ground after which a trial is undecided"
    )
    parameter: Literal["auto", "stiffness", "friction", "pore_strength", "strength", "all", "none"] = Field(
        default="auto",
        description=(
            "parameter of the discs that the calibration multiplies by a factor: stiffness, friction, "
            "pore_strength (stretch and cohesion of pore springs), strength (friction and pore_strength) "
            'or all; "auto" takes the one with the largest influence. For soil discs it is strength, or '
            "none"
        ),
    )
    range: tuple[float, float] | None = Field(
        default=None,
        description="least and largest factor allowed; by default [0.1, 10.0], and [0.75, 1.33] for soil discs",
    )
    tolerance: float = Field(
        default=0.005, gt=0.0, le=0.1, description="allowed difference to the critical Kh of the FEM"
    )
    out_of_reach: Literal["stop", "go on"] = Field(
        default="stop",
        description=(
            'what happens if no factor leads to the critical Kh of the FEM: "stop" ends the run, "go on" '
            "continues with the nearest factor"
        ),
    )
    allowed_overlap: float = Field(
        default=1.0,
        gt=0.0,
        le=2.0,
        description="largest overlap of two discs over their mean radius; a larger overlap stops the run",
    )
    element_tests: StrictBool = Field(default=True, description="true to run element tests of the discs of every layer")
    workers: int = Field(default=2, ge=1, le=256, description="number of concurrent trials, or of threads of one trial")

    @property
    def ductility(self) -> float:
        """Return the displacement at which a test ends over the yield displacement: `growth`, or the default of the
        model."""
        return GROWTH[self.model] if self.growth is None else self.growth

    @property
    def without_effect(self) -> tuple[str, ...]:
        """Return the keys of settings that have no effect on calibrated discs, as "dem.key"."""
        papers_own = self.model == "paper" or self.paper
        return ("dem.workers", *(() if papers_own else OF_THE_PAPER))

    @property
    def factors(self) -> tuple[float, float]:
        """Return `range`, the smallest and the largest factor of the calibration, or its default for the model."""
        return self.range or FACTORS[self.model]

    def as_paper(self) -> "DemSettings":
        """Return settings for the uncalibrated discs with the law "paper"."""
        return self.changed(model="paper", paper=False, parameter="none")

    def problems(self, section: Section) -> list[str]:
        """Yield settings that do not fit the section, one sentence each."""
        problems = []
        if self.model == "soil" and self.parameter not in ("auto", "strength", "none"):
            problems.append(
                f'dem, parameter = "{self.parameter}": expected "strength" or "none"; soil discs have the stiffness of '
                'their soil, other factors belong to model = "paper"'
            )
        if self.model == "soil" and self.packing not in ("auto", "random"):
            problems.append(
                f'dem, packing = "{self.packing}": expected "random" or "auto"; rows belong to model = "paper"'
            )
        if self.springs == "table2" and len(section.strata) != TABLE2_STRATA:
            problems.append(
                f'dem, springs = "table2": expected ten strata as in the paper, there are {len(section.strata)}; '
                'take springs = "soil"'
            )
        if self.radius is not None:
            width, height = (float(v) for v in section.outline().max(axis=0) - section.outline().min(axis=0))
            if self.radius > min(width, height) / 6.0:
                problems.append(
                    f"dem, radius = {self.radius:g} m: expected at most a sixth of the section's smaller extent, "
                    f"{min(width, height) / 6.0:.3g} m"
                )
        if self.range is not None and not 0.0 < self.range[0] < self.range[1]:
            problems.append(f"dem, range = {list(self.range)}: expected two rising positive numbers")
        return problems

    def mean_radius(self, section: Section) -> float:
        """Return the mean radius of the discs (m): `radius`, or the radius with which `elements` discs fill the section
        as a lattice.
        """
        return self.radius or lattice_radius(section, self.elements)


Seconds = Annotated[float, Field(ge=0.0)]
Seed = Annotated[int, Field(ge=0)]
PackingCount = Annotated[int, Field(ge=1, le=10_000)]


AVERAGE = "average"  # in place of a file: the response of the layers to a record of the rock


class SlideSettings(Model):
    """Holds the settings of the liquefied slides, the table [slide] of the input file."""

    cases: tuple[Case, ...] = Field(
        default=LOOSE_SAND,
        description=(
            "cases of liquefaction, one table [[slide.cases]] for each, numbered from 1; [] if only the "
            "cases of [triggering] are computed. By default there are three cases with residual strengths "
            'of loose sand; with model = "paper", three cases with different stiffness and no strength'
        ),
    )
    kh: float = Field(
        default=0.1,
        ge=0.0,
        le=1.0,
        description=(
            'seismic coefficient Kh of the slides, constant or cyclic (kh_cycles). "k_max" is the Kh by '
            '[site_response]; "earthquake" is the cyclic Kh that is equivalent to [earthquake], and the '
            "default if the file has this table. If the file gives no shaking, Kh is 0.1 in 15 cycles, as "
            "in an earthquake of magnitude 7.5"
        ),
    )
    kh_seconds: float | None = Field(
        default=None,
        gt=0.0,
        description=("duration of the constant Kh (s) after the layers have liquefied; by default it has no end"),
    )
    kh_towards: Literal["left", "right"] | None = Field(
        default=None,
        description="side to which a constant Kh acts; by default the lower end of the ground, or the right",
    )
    kh_cycles: float | None = Field(
        default=None,
        gt=0.0,
        le=200.0,
        description="number of uniform cycles in which Kh acts in both directions",
    )
    kh_period: float | None = Field(default=None, gt=0.0, le=20.0, description="period of these cycles (s)")
    accelerogram: str = Field(
        default="",
        description=(
            "file with a record of the motion of the base, which replaces kh, in a format as for "
            '[sliding_block]; positive values act downhill. "average" is the average acceleration above '
            "the slip surface by [site_response]"
        ),
    )
    unit: RecordUnit = ""
    component: RecordComponent = ""
    scale: float = Field(
        default=1.0, ge=-100.0, le=100.0, description="factor on the record; a negative factor reverses its direction"
    )
    liquefies_at: Seconds | Literal["F_L"] = Field(
        default="F_L",
        description=(
            'time (s) after the beginning of the shaking at which the layers liquefy. With "F_L" it '
            "follows from the smallest F_L by the blow counts: a layer liquefies when a record first "
            "reaches F_L times its peak, or after the share F_L^(1/0.34) of the cycles of Kh. Layers "
            "without blow counts liquefy at the peak of a record, or at the beginning of the cycles"
        ),
    )
    onset: Seconds | None = Field(
        default=None,
        description=(
            "time in which a layer liquefies (s), 0 for at once; by default 5, some cycles of shaking, "
            'and 0 with model = "paper"'
        ),
    )
    step: float | None = Field(
        default=None,
        gt=0.0,
        le=0.95,
        description=(
            "time step over the stable time step, which is halved if the energy does not balance; by "
            'default 0.9, and 0.6 with model = "paper"'
        ),
    )
    still: float = Field(
        default=0.01,
        gt=0.0,
        description=(
            "length (m) by which a surface at rest moves in 5 s at most; 0.2 % of the slide if that is more. The "
            "surface of discs may oscillate by three times this length. Most of the surface of material points may "
            "move by 1 % of the slide, and has to be at rest for two intervals of 5 s in a row, or to move by less "
            "than half of this length in one"
        ),
    )
    duration: float = Field(default=60.0, gt=0.0, description="largest simulated duration of a slide (s)")
    methods: tuple[SlideMethod, ...] = Field(
        default=("discs", "mpm"),
        min_length=1,
        description='methods by which the slides are computed: "discs", "mpm" (material point method), or both',
    )
    mpm_cells: int = Field(
        default=3000,
        ge=100,
        le=100_000,
        description="approximate number of cells of the material point method on the section",
    )
    mpm_sides: Literal["free-field", "smooth", "fixed", "periodic"] | None = Field(
        default=None,
        description=(
            "sides of the section in slides, by default those of [fem]. Discs lie in a box with fixed "
            "sides unless the sides are free-field or periodic. If neither table gives sides, they are "
            '"free-field" where a stratum liquefies at both sides, and else "smooth" also where only the higher end of '
            "the ground is level"
        ),
    )
    frames: int = Field(
        default=30, ge=2, le=1000, description="number of pictures of an animation, and of states in a .pvd file"
    )
    seeds: tuple[Seed, ...] | PackingCount | None = Field(
        default=None,
        description=(
            "seeds of the random packings on which the cases are repeated, such as [1, 2]; or the number "
            "of packings, such as 36 for a study; [] for none. By default soil discs are packed twice "
            "more, so that a slide has an interval"
        ),
    )

    def problems(self, strata: Sequence[str]) -> list[str]:
        """Return settings that contradict the strata or each other, one sentence each."""
        problems = []
        if (self.kh_cycles is None) != (self.kh_period is None):
            problems.append("slide, kh_cycles and kh_period: expected both, or neither")
        elif self.kh_cycles is not None and self.kh_seconds is not None:
            problems.append("slide, kh_cycles and kh_seconds: expected one of them; Kh is cyclic, or constant")
        elif self.kh_cycles is not None and self.accelerogram:
            problems.append("slide, kh_cycles and accelerogram: expected one of them; a record has its own cycles")
        if self.kh_towards and (self.kh_cycles is not None or self.accelerogram):
            problems.append("slide, kh_towards: expected with a constant Kh alone; cycles and records act both ways")
        return problems + [
            f'slide, cases {number}, {key}: there is no "{name}"; expected one of {", ".join(strata)}'
            for number, case in enumerate(self.cases, start=1)
            for key in ("residual", "residual_strength")
            if isinstance(values := getattr(case, key), dict)
            for name in unknown_strata(values, strata)
        ]

    @property
    def shaking(self) -> str:
        """Return the loading of the slides in words: a record, cycles of Kh, or a constant Kh."""
        if self.accelerogram == AVERAGE:
            return "the average acceleration above the slip surface"
        if self.accelerogram:
            return f"the record {Path(self.accelerogram).name}"
        if self.kh == 0.0:
            return "its weight alone"
        if self.kh_cycles is not None:
            return f"Kh = {self.kh:g} in both directions ({self.kh_cycles:g} cycles, period {self.kh_period:g} s)"
        duration = f" for {self.kh_seconds:g} s" if self.kh_seconds is not None else ""
        return f"Kh = {self.kh:g}{duration}" + (f" towards the {self.kh_towards}" if self.kh_towards else "")

    def onset_of(self, model: DiscModelName) -> float:
        """Return the setting `onset` (s), or its default for the chosen model of the discs."""
        return ONSET[model] if self.onset is None else self.onset

    def step_of(self, model: DiscModelName) -> float:
        """Return the setting `step`, or its default for the chosen model of the discs."""
        return STEP[model] if self.step is None else self.step

    def packings(self, model: DiscModelName) -> tuple[int, ...]:
        """Return the setting `seeds`, or its default for the chosen model of the discs."""
        if isinstance(self.seeds, int):
            return tuple(range(self.seeds))
        return SEEDS[model] if self.seeds is None else self.seeds
