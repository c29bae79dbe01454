"""Stores the critical seismic coefficient of the discs, before and after calibration, in dem/critical.json."""

from typing import ClassVar, Literal

from pydantic import Field

from dem.settings import DiscModelName, SearchVerdict, TrialVerdict
from dem.springs import Mean
from workflow.results.answer import Answer, Known, Line, Part, Point, SectionLabel

SetOfSprings = Literal["before", "after", "paper"]
SETS: dict[SetOfSprings, str] = {"before": "before calibration", "after": "calibrated", "paper": "of the paper"}


class DiscModelAnswer(Part):
    """Holds the discs at rest under their weight."""

    discs: DiscModelName = Field(description="kind of the discs: soil discs, or the discs of the paper")
    packing: str = Field(description='kind of the packing: "box", "lattice" or "random"')
    rows: int = Field(description="number of rows of a box; 0 for other packings")
    radius_m: float = Field(description="mean radius of the discs")
    elements: int = Field(description="number of discs that can move")
    boundary_elements: int = Field(description="number of discs that cannot move")
    tilt_deg: float = Field(
        description=(
            "angle by which gravity is tilted in the frame of the discs: the mean slope of the ground with its sign"
        )
    )
    seed: int | None = Field(description="seed of a random packing")
    porosity: float = Field(description="area of the voids over the area of the section")
    unbalanced_ratio: float = Field(description="mean unbalanced force over mean contact force")
    settling_seconds: float = Field(description="model time of settling (s)")
    pore_springs: int = Field(description="number of pore springs, the breakable springs that stand for pore water")
    surface_off_mean_m: float | None = Field(
        default=None,
        description=(
            "distance of the surface of the discs at rest from the surface of the section: mean over columns "
            "of two diameters"
        ),
    )
    surface_off_worst_m: float | None = Field(
        default=None, description="the same distance in the column with the largest distance"
    )


class Parameters(Part):
    """Holds the springs of the discs, and the factor of the calibration on one of their parameters."""

    springs: Literal["soil", "table2", "element tests"] = Field(
        description=(
            'source of the springs: "element tests" of soil discs, or of the paper\'s discs "soil" (its eqs. (5)-(13) '
            'with the properties of the strata) or "table2" (its Table 2 as printed)'
        )
    )
    stiffness_scale: float = Field(
        description="factor dem.stiffness_scale on the springs of eqs. (9)-(13) of the paper"
    )
    mean: Mean = Field(description="kind of mean of the constants of two layers at a contact between them")
    stiffness: float | None = Field(default=None, description="calibrated factor on all springs")
    friction: float | None = Field(
        default=None, description="calibrated factor on the friction of contacts and pore springs"
    )
    pore_strength: float | None = Field(
        default=None, description="calibrated factor on cohesion, and on the stretch at which pore springs break"
    )
    strength: float | None = Field(default=None, description="calibrated factor on friction and cohesion")
    all: float | None = Field(default=None, description="calibrated factor on all of these constants")


class KhTrial(Part):
    """Holds whether the discs stand at one Kh, and the numbers on which the verdict is based; None for unknown
    numbers."""

    kh: float = Field(description="seismic coefficient")
    verdict: TrialVerdict = Field(description='"stands"; "fails"; "undecided", which counts as a failure')
    reason: str = Field(description="reason of the verdict, in words")
    unbalanced_ratio: Known = Field(description="mean unbalanced force over mean contact force")
    kinetic_ratio: Known = Field(description="kinetic energy over stored energy")
    displacement_m: float = Field(description="mean displacement in the direction of Kh, weighted by mass")
    elastic_displacement_m: Known = Field(
        description="mean displacement in the direction of Kh of elastic ground at the same Kh"
    )
    seconds: float = Field(description="model time of the trial (s)")


class DiscSearch(Part):
    """Holds the bracket of the critical Kh of the discs, and all trials of the search."""

    parameters: Parameters | None = Field(default=None, description="springs of the discs in this search")
    kc: float | None = Field(description="critical Kh: the middle of the bracket; None without a bracket")
    kc_lower: float = Field(description="largest Kh at which the discs stood")
    kc_upper: float | None = Field(description="smallest Kh at which the discs did not stand")
    verdict: SearchVerdict = Field(description='"bracketed", or why there is no bracket')
    reason: str = Field(description="reason of the verdict, in words")
    flexibility_m: float = Field(description="elastic displacement over Kh")
    trials: tuple[KhTrial, ...] = Field(description="every Kh that was tried, in the order of computation")
    curve: tuple[Point, ...] = Field(
        description="points [Kh, displacement in m] of the states in which the discs stood"
    )


class RecordedDiscs(KhTrial):
    """Names the stored state of the discs at one Kh, before or after calibration."""

    set: SetOfSprings = Field(description="set of springs: before calibration, after it, or those of the paper")
    file: str = Field(description="file of the discs, within the folder of the run")
    cracked_share_by_stratum: dict[str, float] = Field(
        description=(
            "share of the pore springs (breakable springs between discs that stand for pore water) that are "
            "cracked, by stratum"
        )
    )
    slip_surface: Line = Field(description="points [x, elevation] of the slip surface (m)")
    largest_displacement_m: float = Field(description="largest displacement of a disc since rest under its weight")


class SlipSurfaces(Part):
    """Holds the slip surfaces at the upper end of each bracket, points [x, elevation] in m, and their distance."""

    dem: Line = Field(description="slip surface of the calibrated discs")
    dem_before: Line = Field(description="slip surface of the discs before calibration")
    fem: Line = Field(description="slip surface of the continuum that the discs are compared with")
    mean_distance_m: float | None = Field(
        description="mean vertical distance between the slip surfaces of calibrated discs and continuum"
    )
    same_stratum_share: float | None = Field(
        description="share of the length along which both slip surfaces lie in the same stratum"
    )
    columns: int | None = Field(default=None, description="number of columns of discs that were compared")
    excess_above: float | None = Field(
        default=None,
        description=(
            "if the slip surface of the discs is the higher one: relative increase of the critical Kh of the "
            "continuum if it cannot fail below that surface"
        ),
    )


class PaperDiscs(Part):
    """Holds the packing and the critical Kh of the discs with the law "paper", computed in addition to soil discs."""

    model: DiscModelAnswer = Field(description="the discs at rest")
    search: DiscSearch = Field(description="their critical Kh")


class DiscsAnswer(Answer):
    """Holds the discs, their critical Kh before and after calibration, and the states that are drawn."""

    FILE: ClassVar[str] = "dem/critical.json"

    section: SectionLabel = Field(description="section of the discs")
    model: DiscModelAnswer = Field(description="the discs at rest under their weight")
    before: DiscSearch = Field(description="critical Kh before calibration")
    after: DiscSearch = Field(description="critical Kh after calibration")
    states: tuple[RecordedDiscs, ...] = Field(description="stored states at the Kh of dem.kh, for every set of springs")
    slip_surface: SlipSurfaces = Field(description="slip surfaces of discs and continuum, and their distance")
    paper: PaperDiscs | None = Field(default=None, description="the discs of the paper, unchanged")

    @property
    def kc_table2(self) -> float | None:
        """Return the critical Kh with the springs of Table 2 of the paper as printed, if it was computed."""
        search = self.paper.search if self.paper is not None else self.before
        is_printed = search.parameters is not None and search.parameters.springs == "table2"
        return search.kc if is_printed else None

    def states_of(self, which: SetOfSprings) -> dict[float, RecordedDiscs]:
        """Return the stored states of one set of springs, by their Kh."""
        return {round(state.kh, 6): state for state in self.states if state.set == which}
