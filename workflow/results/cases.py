"""Stores the slide of each case of liquefaction in dem/cases.json."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar, Literal, Self, TypeVar

import numpy as np
from pydantic import Field

from workflow.results.answer import Answer, Line, Part

if TYPE_CHECKING:
    from dem.slides.slide import Slide

Answered = TypeVar("Answered", bound=Part)
Points = Sequence[Sequence[float]]
SURFACE_POINTS = 30  # points of a surface with a disc or a cell for each; a line of fewer points has corners that count
FEWEST_VALUES = 3  # values with a confidence interval: that of two is a dozen times as wide as they are apart
QUANTILE_VALUES = 20  # packings from which a 5 % quantile is more than an extrapolation of the smallest value
LOW_END = f"smallest value, or from {QUANTILE_VALUES} packings on the 5 % quantile,"
HIGH_END = f"largest value, or from {QUANTILE_VALUES} packings on the 95 % quantile,"


def _student(freedoms: int) -> float:
    """Return the 97.5 % quantile of Student's distribution."""
    from scipy.special import stdtrit  # loaded for random packings only

    return float(stdtrit(freedoms, 0.975))


class SurfaceMovement(Part):
    """Holds the movement of the surface in a slide. Slides (m) are positive downhill, and settlements (m) downwards."""

    settlement_uphill_m: float = Field(description="median settlement of the upslope third of the surface")
    settlement_middle_m: float = Field(description="median settlement of the middle third")
    settlement_downhill_m: float = Field(description="median settlement of the downslope third")
    slide_uphill_m: float = Field(description="median slide of the upslope third of the surface")
    slide_middle_m: float = Field(description="median slide of the middle third")
    slide_downhill_m: float = Field(description="median slide of the downslope third")
    slide_max_at_x_m: float = Field(description="x of the largest slide of the surface")
    notes: tuple[str, ...] = Field(description="notes that a reader needs to judge these numbers")


class CaseNumbers(SurfaceMovement):
    """Holds one case of liquefaction in numbers, by discs."""

    stiffness: float = Field(description="factor on the stiffness of the layers that liquefied")
    slide_max_m: float = Field(description="largest slide of the surface, to either side")
    crack_opening_m: float = Field(description="widest gap between neighbouring discs of the surface")
    settled: bool = Field(description="whether the ground has come to rest")
    reason: str = Field(description="reason why the computation of the slide ended")
    escaped: int = Field(description="number of discs that left the section")
    loose_share: float = Field(default=0.0, description="share of the mass that has left the connected ground")
    cracked_pore_springs: int = Field(description="number of cracked pore springs at the end")
    seconds_simulated: float = Field(description="model time since the onset of liquefaction (s)")
    moved_lately_m: float | None = Field(default=None, description="movement of the largest slide in its last 10 s")
    step_share: float = Field(description="time step over the largest stable time step")
    overlap: float = Field(description="largest overlap of two discs, over their mean radius")
    area_lost_share: float = Field(description="share of the area of the ground that was lost beyond drainage")
    slides_over_share: float = Field(
        description="share of the surface that slides, 0 to 1: it moves more than twice as far as without liquefaction"
    )
    slides_over_share_uphill: float = Field(description="share of the uphill half of the surface that slides, 0 to 1")
    slides_over_share_downhill: float = Field(
        description="share of the downhill half of the surface that slides, 0 to 1"
    )
    slide_by_weight_m: float | None = Field(
        default=None, description="largest slide of the same case in 20 s without any shaking, if it was computed"
    )
    flows: bool | None = Field(default=None, description="whether the slide without shaking is a flow failure")
    stopped_by: Literal["left", "right"] | None = Field(
        default=None, description="side of the disc model that stopped the slide"
    )


class CaseSummary(CaseNumbers):
    """Holds the numbers of a case and, if several random packings were computed, the interval of its largest slide."""

    seeds: int = Field(default=1, description="number of packings that were computed")
    slide_max_m_mean: float | None = Field(default=None, description="mean of the largest slide over the packings")
    slide_max_m_ci95: tuple[float, float] | None = Field(
        default=None, description="95 % confidence interval of the mean, by Student's distribution"
    )


class MovedSurface(Part):
    """Holds the surface of the ground before and after a slide."""

    surface_before: Line = Field(description="points [x, elevation] of the surface before the slide (m)")
    surface_after: Line = Field(description="points [x, elevation] of the surface after the slide (m)")
    slide_along: Line = Field(default=(), description="slide along the surface: points [x before the slide, slide] (m)")

    @property
    def surfaces(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the points (n, 2) of the surface before and after the slide (m)."""
        return np.array(self.surface_before).reshape(-1, 2), np.array(self.surface_after).reshape(-1, 2)

    def slide_at(self, x: float) -> float | None:
        """Return the slide (m) of the surface that was at x (m) before the slide; None beyond the ends of the surface,
        or if it is not stored."""
        if not self.slide_along or not self.slide_along[0][0] <= x <= self.slide_along[-1][0]:
            return None
        return float(np.interp(x, *np.array(self.slide_along).T))

    def slides_between(self, start: float, end: float) -> np.ndarray:
        """Return the slides (n,) in m of the points of the surface between two x (m)."""
        points = np.array(self.slide_along).reshape(-1, 2)
        return points[(points[:, 0] >= start) & (points[:, 0] <= end), 1]

    @property
    def largest_fall(self) -> tuple[float, float]:
        """Return the largest fall of the surface (m), and its x (m).

        Both surfaces are smoothed to the spacing of their points, so that a single missing disc is no fall. The
        outermost points lie on the sides of the model, where a single disc that remains or is missing does not show the
        settlement of the ground. The two outermost points are therefore left out.
        """
        before, after = self.surfaces
        if not len(before) or not len(after):
            return 0.0, 0.0
        by_x = [line[np.argsort(line[:, 0], kind="stable")] for line in (before, after)]
        by_x = [
            smoothed(line, float(np.median(np.diff(line[:, 0])))) if len(line) >= SURFACE_POINTS else line
            for line in by_x
        ]
        x = np.unique(np.concatenate([line[:, 0] for line in by_x]))
        first = 1 if min(len(before), len(after)) > 2 else 0  # the place of the first point that is read
        left, right = (choose(line[end, 0] for line in by_x) for choose, end in ((max, first), (min, -1 - first)))
        x = x[(x >= left) & (x <= right)]
        if not len(x):
            return 0.0, 0.0
        fall = np.subtract(*(np.interp(x, *line.T) for line in by_x))
        return float(fall.max()), float(x[int(np.argmax(fall))])


class CaseAnswer(MovedSurface, CaseNumbers):
    """Holds one case of liquefaction: the numbers, and the surface of the ground."""

    @classmethod
    def of(cls, slide: "Slide", alone: "Slide", stiffness: float) -> Self:
        """Return the numbers and the surface of a slide.

        Parameters
        ----------
        slide : the slide
        alone : slide of the same ground under Kh without liquefaction; a disc of the surface counts as sliding if it
            moves more than twice as far as in ``alone``
        stiffness : factor on the stiffness of the layers that liquefied
        """
        return cls(stiffness=stiffness, **slide.as_json(alone))

    @property
    def uphill(self) -> str:
        """Return whether the upslope third of the surface "rises" or "settles"."""
        return "rises" if self.settlement_uphill_m < 0.0 else "settles"

    @property
    def numbers(self) -> CaseNumbers:
        """Return the numbers without the surface."""
        return CaseNumbers(**{name: getattr(self, name) for name in CaseNumbers.model_fields})


def _range(values: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return the lower end, the median and the upper end of the values (n, ...) of n packings."""
    shares = (0.05, 0.5, 0.95) if len(values) >= QUANTILE_VALUES else (0.0, 0.5, 1.0)
    return np.asarray(np.quantile(values, shares, axis=0))


class Spread(Part):
    """Holds a number on several random packings: mean, standard deviation and confidence interval.

    All have the unit of the number. They are None if there are too few packings: the standard deviation needs two, the
    confidence interval three.
    """

    mean: float | None = Field(description="mean over the packings")
    spread: float | None = Field(description="standard deviation over the packings")
    values: tuple[float, ...] = Field(description="the value of every packing")
    median: float | None = Field(default=None, description="median of the packings")
    low: float | None = Field(default=None, description=f"{LOW_END} of the packings")
    high: float | None = Field(default=None, description=f"{HIGH_END} of the packings")
    mean_ci95: tuple[float, float] | None = Field(
        default=None, description="95 % confidence interval of the mean over all packings, by Student's distribution"
    )

    @classmethod
    def of(cls, values: Sequence[float]) -> Self:
        """Return the mean, standard deviation and interval of some values."""
        if not values:
            return cls(mean=None, spread=None, values=())
        mean, several = float(np.mean(values)), len(values) > 1
        spread = float(np.std(values, ddof=1)) if several else None
        enough = spread is not None and len(values) >= FEWEST_VALUES
        half = _student(len(values) - 1) * spread / np.sqrt(len(values)) if enough and spread is not None else None
        low, median, high = (float(value) for value in _range(values))
        return cls(
            mean=mean,
            spread=spread,
            values=tuple(values),
            median=median,
            low=low if several else None,
            high=high if several else None,
            mean_ci95=None if half is None else (float(mean - half), float(mean + half)),
        )

    @property
    def from_zero(self) -> Self:
        """Return the spread of a quantity that cannot be negative, so that its confidence interval begins at 0 or
        above."""
        interval = None if self.mean_ci95 is None else (max(self.mean_ci95[0], 0.0), self.mean_ci95[1])
        return self.model_copy(update={"mean_ci95": interval})


class Profile(Part):
    """Holds the surface over all packings, before and after the slide: elevations (m) of n points along x (m)."""

    x: tuple[float, ...] = Field(description="x of the points, from left to right (m)")
    before: tuple[float, ...] = Field(description="elevations before the slide, median over all packings")
    after: tuple[float, ...] = Field(description="elevations after the slide, median over all packings")
    after_low: tuple[float, ...] = Field(description=f"elevations after the slide: {LOW_END} of the packings at each x")
    after_high: tuple[float, ...] = Field(
        description=f"elevations after the slide: {HIGH_END} of the packings at each x"
    )

    @classmethod
    def of(cls, surfaces: Sequence[tuple[Points, Points]], points: int = 201) -> Self:
        """Return the profile of several surfaces before and after, points [x, elevation], over their common width."""
        ends = [(line[0][0], line[-1][0]) for pair in surfaces for line in pair]
        x = np.linspace(max(left for left, _ in ends), min(right for _, right in ends), points)
        before, after = (np.array([np.interp(x, *np.array(pair[k]).T) for pair in surfaces]) for k in (0, 1))
        low, middle, high = _range(after)
        rows = (x, np.median(before, axis=0), middle, low, high)
        return cls(**{name: tuple(map(float, row)) for name, row in zip(cls.model_fields, rows, strict=True)})


class RandomCase(Part):
    """Holds one case on random packings that fail at the same Kh.

    Slides (m) are positive downhill, settlements (m) downwards.
    """

    slide_max_m: Spread = Field(description="largest slide of the surface, to either side")
    settlement_uphill_m: Spread = Field(description="median settlement of the upslope third of the surface")
    settlement_middle_m: Spread = Field(description="median settlement of the middle third")
    settlement_downhill_m: Spread | None = Field(default=None, description="median settlement of the downslope third")
    slide_uphill_m: Spread | None = Field(default=None, description="median slide of the upslope third of the surface")
    slide_middle_m: Spread | None = Field(default=None, description="median slide of the middle third")
    slide_downhill_m: Spread | None = Field(default=None, description="median slide of the downslope third")
    crack_opening_m: Spread | None = Field(
        default=None, description="widest gap between neighbouring discs of the surface"
    )
    profile: Profile | None = Field(default=None, description="surface before and after the slide")

    @property
    def spreads(self) -> dict[str, Spread]:
        """Return the spread of every quantity by its name in words. Intervals of lengths that cannot be negative begin
        at 0."""
        spreads = {name: getattr(self, name) for name in QUANTITIES if getattr(self, name) is not None}
        return {QUANTITIES[name]: spread.from_zero if name in LENGTHS else spread for name, spread in spreads.items()}


QUANTITIES = {
    "slide_max_m": "largest slide",
    "slide_uphill_m": "slide, upslope third",
    "slide_middle_m": "slide, middle third",
    "slide_downhill_m": "slide, downslope third",
    "settlement_uphill_m": "settlement, upslope third",
    "settlement_middle_m": "settlement, middle third",
    "settlement_downhill_m": "settlement, downslope third",
    "crack_opening_m": "widest crack",
}
LENGTHS = ("slide_max_m", "crack_opening_m")


class Seed(Part):
    """Holds the calibration of one random packing, which is identified by its seed."""

    seed: int = Field(description="number that the random packing follows from")
    kc_before: float | None = Field(description="uncalibrated critical Kh; null without one")
    parameter: str = Field(description='constants of the discs that the factor multiplies, or "none"')
    value: float = Field(description="factor on these constants")
    kc: float | None = Field(description="critical Kh with this factor; null without a bracket")
    verdict: str = Field(description='"calibrated", "out of reach", or "not asked for" without a calibration')
    reason: str = Field(description="reason of the verdict, in words")


class RandomPackings(Part):
    """Holds the cases on random packings.

    A packing that could not be calibrated is among the seeds, and does not count in the cases.
    """

    seeds: tuple[Seed, ...] = Field(description="calibration of every packing")
    cases: dict[int, RandomCase] = Field(description="cases by number, over all packings that could be calibrated")

    @property
    def rising(self) -> int | None:
        """Return the number of packings on which every case slides further than the case before; None without two cases
        or two packings.
        """
        slides = [self.cases[number].slide_max_m.values for number in sorted(self.cases)]
        if len(slides) < 2 or min(len(values) for values in slides) < 2:
            return None
        return sum(all(less < more for less, more in pairwise(packing)) for packing in zip(*slides, strict=True))


def equal_cases(cases: Mapping[int, Answered], of: Iterable[int] | None = None) -> dict[tuple[int, ...], Answered]:
    """Group cases with equal answers, so that each is shown once; the factor on their stiffness may differ.

    Parameters
    ----------
    cases : answers of the cases by number
    of : numbers of the cases to be grouped, such as those of one row of a table; all cases by default

    Returns
    -------
    The numbers of the cases of each group, in order, and the answer of the first of them.
    """
    groups: dict[str, list[int]] = {}
    for number in sorted(cases if of is None else set(of) & set(cases)):
        groups.setdefault(cases[number].model_dump_json(exclude={"stiffness"}), []).append(number)
    return {tuple(numbers): cases[numbers[0]] for numbers in groups.values()}


class CasesAnswer(Answer):
    """Holds all cases by number, for each set of springs.

    The set of springs "calibrated" governs if it exists.
    """

    FILE: ClassVar[str] = "dem/cases.json"

    sets: dict[str, dict[int, CaseAnswer]] = Field(
        description='cases by number, by set of springs: "calibrated", and "table2" for those printed in the paper'
    )
    random: RandomPackings | None = Field(description="cases on random packings; null if they were not requested")

    def each(self) -> Iterator[tuple[str, int, CaseAnswer]]:
        """Yield every set, number and case, in the order of sets and numbers."""
        for name, cases in self.sets.items():
            for number in sorted(cases):
                yield name, number, cases[number]

    @property
    def first_set(self) -> str:
        """Return the name of the governing set; empty without any."""
        return next((name for name in ("calibrated", *self.sets) if name in self.sets), "")


def smoothed(line: np.ndarray, size: float) -> np.ndarray:
    """Return the surface that discs resolve, without spikes by single additional or missing discs.

    Parameters
    ----------
    line (n, 2) : tops of the discs of the surface: x and elevation (m)
    size : diameter of the discs (m): the surface is a running median over three diameters, then a mean over two

    Returns
    -------
    Points (k, 2) half a diameter apart (m); the sorted points themselves if they span less than four diameters.
    """
    line = line[np.argsort(line[:, 0], kind="stable")]
    if len(line) < 2 or not size > 0.0 or np.ptp(line[:, 0]) < 4.0 * size:
        return line
    x = np.arange(line[0, 0], line[-1, 0] + 0.25 * size, 0.5 * size)
    z = np.interp(x, *line.T)
    for width, average in ((7, np.median), (5, np.mean)):
        padded = np.pad(z, width // 2, mode="reflect")
        z = average(np.lib.stride_tricks.sliding_window_view(padded, width), axis=1)
    return np.column_stack([x, z])
