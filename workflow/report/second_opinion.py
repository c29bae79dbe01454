"""States whether DEM and MPM agree on the slide of a case, and which method predicts known slides better."""

from collections.abc import Iterator
from dataclasses import dataclass

from dem.settings import SlideMethod
from workflow.estimates.slide_error import slide_error
from workflow.report.model_error import NAMES
from workflow.report.numbers import rough_range
from workflow.report.summary_text import at_rest
from workflow.report.warnings import merged_notes, split_warning
from workflow.results.cases import CaseAnswer, CasesAnswer
from workflow.results.governing import by_weight
from workflow.results.lengths import metres
from workflow.results.material_points import PointCase, PointSlidesAnswer
from workflow.results.verdicts import WarningPart

Span = tuple[float, float]
# Difference (m) and ratio up to which two slides agree whatever their intervals.
ABSOLUTE_TOLERANCE, RATIO_TOLERANCE = 0.05, 1.5


@dataclass(frozen=True)
class SecondOpinion:
    """Compares the slides of a case by discs and by material points; lengths are in m.

    Attributes
    ----------
    discs, points : largest slides by discs and by material points
    discs_span, points_span : intervals of both slides: over packings (discs), or by numerical error (material points),
        with the error on known slides if there are comparable ones
    agreed : whether the two slides differ by less than the larger interval, or are nearly equal, or neither comes to
        rest, or one is a lower limit that the other one exceeds
    flows : whether the ground flows by its weight alone
    at_rest : whether discs and material points are at rest
    limits : whether a side of the model limits the slide of the discs and that of the material points
    """

    discs: float
    points: float
    discs_span: Span
    points_span: Span
    agreed: bool
    flows: bool | None
    at_rest: tuple[bool, bool]
    limits: tuple[bool, bool] = (False, False)

    def sentence(self) -> str:
        """Return a sentence that compares both slides."""
        slides = f"discs slide {metres(self.discs)} and material points {metres(self.points)}"
        if self.agreed and all(self.limits):
            return f"{slides}, and both reach a side of the model, which limits both slides"
        if self.agreed and any(self.limits) and any(self.at_rest):
            stopped = "discs" if self.limits[0] else "material points"
            farther = self.points > self.discs if self.limits[0] else self.discs > self.points
            link = "since" if farther else "although"
            return f"{slides}, and both agree, {link} a side of the model limits the slide of the {stopped}"
        if self.agreed and any(self.at_rest) and not _alike(self.discs, self.points):
            spans = (self.discs_span, self.points_span)
            widest = rough_range(*max(spans, key=lambda span: span[1] - span[0]))
            return f"{slides}, which differ by less than the width of the larger interval, {widest}"
        if self.agreed:
            return f"{slides}, and both agree" + ("" if any(self.at_rest) else " that the slide does not come to rest")
        if self.at_rest[0] != self.at_rest[1] and not any(self.limits):
            return (
                f"{slides}, and only {'discs' if self.at_rest[0] else 'material points'} come to rest{self._nearer()}"
            )
        intervals = f"{rough_range(*self.discs_span)} and {rough_range(*self.points_span)}"
        return f"{slides}, which differ by more than the intervals of {intervals}{self._nearer()}"

    def _nearer(self) -> str:
        """Return a clause that states which method predicted known slides of this kind better."""
        discs, points = slide_error(self.flows), slide_error(self.flows, "mpm")
        if discs is None or points is None:
            return ""
        near, far = (discs, points) if by_weight((discs, points))[0] == "discs" else (points, discs)
        return (
            f": rely on {NAMES[near.method]}, which predicted half of the known {near.kind} "
            f"within a factor of {near.middle:.2g}, while the other model predicted half of them within "
            f"{far.middle:.2g}"
        )


def second_opinions(cases: CasesAnswer | None, points: PointSlidesAnswer | None) -> dict[int, SecondOpinion]:
    """Return every case that both methods have computed, by its number."""
    if cases is None or points is None or not cases.first_set:
        return {}
    random = cases.random.cases if cases.random is not None else {}
    opinions = {}
    for number, case in sorted(cases.sets[cases.first_set].items()):
        other = points.cases.get(number)
        if other is not None:
            over = random[number].slide_max_m if number in random else None
            low, high = (None, None) if over is None else (over.low, over.high)
            opinions[number] = _opinion(case, (low or case.slide_max_m, high or case.slide_max_m), other)
    return opinions


def _opinion(case: CaseAnswer, packings: Span, other: PointCase) -> SecondOpinion:
    discs = _with_error(min(packings[0], case.slide_max_m), max(packings[1], case.slide_max_m), case.flows, "discs")
    points = _with_error(other.slide_max_low_m, other.slide_max_high_m, case.flows, "mpm")
    rested = at_rest(case), at_rest(other)
    widest = max(discs[1] - discs[0], points[1] - points[0])
    near = abs(case.slide_max_m - other.slide_max_m) <= widest or _alike(case.slide_max_m, other.slide_max_m)
    limits = case.stopped_by is not None, other.stopped_by is not None
    if all(rested):
        agreed = near
    elif any(rested) and any(limits):
        least, free = (case, other) if limits[0] else (other, case)
        agreed = near or free.slide_max_m >= least.slide_max_m
    else:
        agreed = not any(rested)
    return SecondOpinion(case.slide_max_m, other.slide_max_m, discs, points, agreed, case.flows, rested, limits)


def _alike(first: float, second: float) -> bool:
    """Return whether two slides (m) are nearly equal, whatever their intervals."""
    return abs(first - second) <= max(ABSOLUTE_TOLERANCE, (1.0 - 1.0 / RATIO_TOLERANCE) * max(first, second))


def _with_error(low: float, high: float, flows: bool | None, method: SlideMethod) -> Span:
    """Return an interval widened by the error on known slides, unless this error is so large that any two slides would
    agree."""
    error = slide_error(flows, method)
    return (low, high) if error is None or not error.bounds_slides else error.interval(max(low, 0.0), high)


def contradicting(opinions: dict[int, SecondOpinion]) -> Iterator[WarningPart]:
    """Warn of every case on which the two models do not agree. Equal warnings are merged."""
    for warning in merged_notes(
        {number: [opinion.sentence()] for number, opinion in opinions.items() if not opinion.agreed}
    ):
        observation, remedy = split_warning(warning)
        yield WarningPart(weight=1, observation=observation, remedy=remedy)


def agreeing(opinions: dict[int, SecondOpinion]) -> Iterator[str]:
    """Yield sentences on the cases in which both methods agree."""
    for sentence in merged_notes(
        {number: [opinion.sentence()] for number, opinion in opinions.items() if opinion.agreed}
    ):
        yield split_warning(sentence)[0]
