"""Defines the settings of the discs and of slides: the tables [dem] and [slide] of the input file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, StrictBool

from dem.case import LOOSE_SAND, SOFTENED, Case
from dem.springs import Mean
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
# soil discs have dashpots a tenth as large, and their energy balances with this
STEP: Mapping[DiscModelName, float] = {"soil": 0.6, "paper": 0.3}
PAPER_LOADING: Mapping[str, Any] = {  # of the paper, Sec. 4(3): Kh = 0.1, for ever
    "kh": 0.1, "kh_seconds": None, "kh_cycles": None, "kh_period": None, "accelerogram": "",
}  # fmt: skip
CASES: Mapping[DiscModelName, tuple[Case, ...]] = {"soil": LOOSE_SAND, "paper": SOFTENED}  # where none are given
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
        description='"soil": random discs whose contacts are found in element tests, or "paper": rows, springs and '
        "pore springs of the paper",
    )
    paper: StrictBool = Field(
        default=False,
        description="true to compute the paper's own discs, too, unchanged and with the paper's constant Kh of 0.1",
    )
    packing: Literal["auto", "box", "lattice", "random"] = Field(
        default="auto",
        description='of model = "paper": "box": rows along the mean surface, gravity tilted; "lattice": the same rows '
        'cut to the outline; "random"; or "auto": box where surface and base are straight and parallel, random '
        "elsewhere; soil discs are always random",
    )
    radius: Length | None = Field(default=None, description='(mean) radius of the discs, such as "0.75 m"')
    elements: int = Field(default=2500, ge=50, le=1_000_000, description="number of discs if no radius is given")
    spread: float = Field(default=0.2, ge=0.0, lt=0.9, description="half width of the radii of a random packing")
    porosity: float = Field(
        default=0.2,
        gt=0.1,
        lt=0.5,
        description='of model = "paper": voids over area of a random packing, at least; soil discs have that of their '
        "element tests",
    )
    seed: int = Field(default=0, ge=0, description="seed of a random packing")
    springs: Literal["soil", "table2"] = Field(
        default="soil",
        description='of model = "paper": "soil": by eqs. (5)-(13) from the strata, or "table2": the paper\'s Table 2',
    )
    stiffness_scale: float = Field(default=0.01, gt=0.0, description="factor on the springs of eqs. (9)-(13)")
    damping_ratio: float = Field(default=1.0, ge=0.0, description="factor on the dashpots sqrt(m K)")
    mean: Mean = Field(default="arithmetic", description="mean of two layers' constants at a contact between them")
    kh: RecordedKh = Field(default=(0.2, 0.3), description="seismic coefficients whose states are stored")
    kh_limit: float = Field(default=1.0, gt=0.0, description="seismic coefficient beyond which to stop")
    resolution: float = Field(default=0.005, gt=0.0, le=0.1, description="width of the bracket of the critical Kh")
    unbalanced: float = Field(
        default=4e-4,
        gt=0.0,
        le=1e-2,
        description="the discs stand if mean unbalanced force over mean contact force is at most this",
    )
    kinetic: float = Field(
        default=1e-5, gt=0.0, description="the discs stand if kinetic over stored energy is at most this"
    )
    growth: float | None = Field(
        default=None,
        gt=1.0,
        description="the discs fail at this displacement: over the elastic one for the paper's discs (3 if not "
        "given), over the "
        "displacement at which the FEM reaches its critical Kh for soil discs (3.5 if not given)",
    )
    patience: float = Field(
        default=15.0, gt=0.0, description="number of natural periods of the ground after which a trial is undecided"
    )
    parameter: Literal["auto", "stiffness", "friction", "pore_strength", "strength", "all", "none"] = Field(
        default="auto",
        description="parameter that calibration multiplies by a factor: stiffness, friction, stretch and "
        "cohesion of pore springs "
        "(pore_strength), friction and pore_strength (strength), or all; auto: chosen by the sensitivities. "
        "For soil discs: strength, or none",
    )
    range: tuple[float, float] | None = Field(
        default=None,
        description="least and largest factor allowed; if not given [0.1, 10.0], and [0.75, 1.33] for soil discs",
    )
    tolerance: float = Field(default=0.005, gt=0.0, le=0.1, description="allowed difference to the FEM's critical Kh")
    out_of_reach: Literal["stop", "go on"] = Field(
        default="stop",
        description='what to do if no factor reaches the critical Kh of the FEM: "stop" or "go on" with the closest',
    )
    allowed_overlap: float = Field(
        default=1.0, gt=0.0, le=2.0, description="deepest overlap over the mean radius; deeper ones stop a run"
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
        return self.radius or float(np.sqrt(section.layering.areas().sum() / self.elements / np.sqrt(12.0)))


Seconds = Annotated[float, Field(ge=0.0)]
Seed = Annotated[int, Field(ge=0)]
PackingCount = Annotated[int, Field(ge=1, le=10_000)]


AVERAGE = "average"  # in place of a file: the response of the layers to a record of the rock


class SlideSettings(Model):
    """Holds the settings of the liquefied slides, the table [slide] of the input file."""

    cases: tuple[Case, ...] = Field(
        default=LOOSE_SAND,
        description="one table [[slide.cases]] for each, numbered from 1; [] for those of [triggering] alone. If not "
        'given, three residual strengths of loose sand; with model = "paper", three stiffnesses without strength',
    )
    kh: float = Field(
        default=0.1,
        ge=0.0,
        le=1.0,
        description='seismic coefficient, constant or cyclic with kh_cycles; "k_max" takes that of '
        '[site_response], "earthquake" that of [earthquake] with its cycles, which is the default where there is one. '
        "Where no shaking is given, 0.1 both ways in the 15 cycles of magnitude 7.5",
    )
    kh_seconds: float | None = Field(
        default=None,
        gt=0.0,
        description="seconds for which Kh is constant before it is removed; without end if not given",
    )
    kh_cycles: float | None = Field(
        default=None,
        gt=0.0,
        le=200.0,
        description="uniform cycles of a Kh that acts both ways, instead of a constant Kh",
    )
    kh_period: float | None = Field(default=None, gt=0.0, le=20.0, description="period of these cycles (s)")
    accelerogram: str = Field(
        default="",
        description="a record of the base instead of kh, a file as in [sliding_block]; positive acts downhill; "
        '"average" takes the average acceleration above the slip surface by [site_response]',
    )
    unit: RecordUnit = ""
    component: RecordComponent = ""
    scale: float = Field(
        default=1.0, ge=-100.0, le=100.0, description="factor on the record; negative reverses its direction"
    )
    liquefies_at: Seconds | Literal["F_L"] = Field(
        default="F_L",
        description='time (s) after the beginning of the shaking at which the layers liquefy; with "F_L", the '
        "smallest F_L by "
        "the blow counts: when a record first reaches this share of its peak (1 without any), and after "
        "F_L^(1/0.34) of the "
        "cycles of Kh (0 without any)",
    )
    onset: Seconds | None = Field(
        default=None,
        description="seconds in which the layers liquefy; 0: instantaneously. If not given 5, some cycles of shaking, "
        "and 0 "
        'for model = "paper"',
    )
    step: float | None = Field(
        default=None,
        gt=0.0,
        le=0.8,
        description="time step over the stable one, halved where energy does not balance; if not given 0.6, and 0.3 "
        'for model = "paper"',
    )
    still: float = Field(
        default=0.01,
        gt=0.0,
        description="the surface is at rest if it moves by less than this length (m) in 5 s; discs may "
        "oscillate by three times this "
        "length; for material points this length or 0.2 % of the slide, twice in a row",
    )
    duration: float = Field(default=60.0, gt=0.0, description="largest simulated duration of a slide (s)")
    methods: tuple[SlideMethod, ...] = Field(
        default=("discs", "mpm"),
        min_length=1,
        description='methods by which the slides are computed: "discs", "mpm" (material point method), or both',
    )
    mpm_cells: int = Field(
        default=3000, ge=100, le=100_000, description="cells of the material point method on the section, about"
    )
    mpm_sides: Literal["free-field", "smooth", "fixed", "periodic"] | None = Field(
        default=None,
        description="sides of the section in slides; by default those of [fem]; discs lie in a box with fixed sides "
        "unless they are free-field or periodic; if neither is given, the "
        'sides are "smooth" also if only the higher end of the ground is level',
    )
    frames: int = Field(default=30, ge=2, le=1000, description="pictures of an animation, states of a .pvd")
    seeds: tuple[Seed, ...] | PackingCount | None = Field(
        default=None,
        description="seeds of random packings on which the cases are repeated, such as [1, 2]; or the number "
        "of packings, "
        "such as 36 for a study; [] for none. If not given soil discs are packed twice more, so that a slide has an "
        "interval",
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
        return problems + [
            f'slide, cases {number}, {key}: there is no "{name}"; expected one of {", ".join(strata)}'
            for number, case in enumerate(self.cases, start=1)
            for key in ("residual", "residual_strength")
            if isinstance(values := getattr(case, key), dict)
            for name in values
            if name not in strata
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
            return f"Kh = {self.kh:g} both ways, {self.kh_cycles:g} cycles of {self.kh_period:g} s"
        return f"Kh = {self.kh:g}" + (f" for {self.kh_seconds:g} s" if self.kh_seconds is not None else "")

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
