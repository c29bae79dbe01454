"""States in sentences whether the ground still stands after liquefaction."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import itemgetter

from meshes.section.cutting import shown_name
from workflow.report.numbers import bracket, coefficient, of_cases, span
from workflow.report.slices import circles_after_liquefaction
from workflow.results.lengths import metres
from workflow.results.results import Results
from workflow.results.stability import Bearing, LiquefiedAnswer, LiquefiedCase, LiquefiedStratum
from workflow.texts.report_texts import listed

Strata = tuple[LiquefiedStratum, ...]
FLOW_SHARE = 0.1  # of the height of the ground, below which a displacement was no flow: that ends when the face is flat


def in_short(results: Results) -> Iterator[str]:
    """Yield sentences on each residual strength, on the strength for a factor of safety of 1, and on measured
    displacements; nothing without this analysis.
    """
    answer = results.liquefied
    if answer is None:
        return
    for case in answer.cases:
        yield outcome(case)
        yield from (_by_weight if case.verdict == "flows" else _slides_though_it_stands)(results, case)
    enough = just_enough(answer)
    if enough is not None:
        yield f"{enough.description}."
    yield from _field(results, answer)


def outcome(case: LiquefiedCase) -> str:
    """Return whether the ground stands without shaking, with its critical Kh, and the reason."""
    after = f"After liquefaction, in {_case_words(case)}, the continuum"
    if case.verdict == "flows":
        return f"{after} does not stand without shaking: {case.reason}."
    most = case.kc if case.kc_upper is None or case.kc is None else min(case.kc, case.kc_upper)
    acting = " acting upslope" if case.direction == "uphill" else ""  # where that gives the smaller critical Kh
    critical = f", with a critical Kh of about {coefficient(most)}{acting}" if most is not None else ""
    return f"{after} still stands without shaking{critical}: {case.reason}."


def _by_weight(results: Results, case: LiquefiedCase) -> Iterator[str]:
    """Yield a sentence on the slide of the discs by their weight alone, if the continuum fails and the discs do not
    flow."""
    _, cases = results.case_set()
    discs = {number: cases[number] for number in case.cases if number in cases and not cases[number].flows}
    slides = {number: slide for number, answer in discs.items() if (slide := answer.slide_by_weight_m) is not None}
    if not slides:
        return
    phrase = f"by their weight alone the discs slide {span(list(slides.values()))} in {of_cases(list(slides))}"
    if max(slides.values()) > FLOW_SHARE * _relief(results):
        yield f"The discs agree: {phrase}, until the remaining face is flat enough."
    else:
        yield f"The discs are stronger than the continuum: {phrase}."


def _slides_though_it_stands(results: Results, case: LiquefiedCase) -> Iterator[str]:
    """Yield the contradiction that discs slide by their weight alone although the continuum stands."""
    _, cases = results.case_set()
    largest_slide = max((cases[number].slide_max_m for number in case.cases if number in cases), default=0.0)
    slide = results.config.slide
    if slide.kh == 0.0 and not slide.accelerogram and largest_slide > FLOW_SHARE * _relief(results):
        yield (
            f"The discs contradict this result: they slide {metres(largest_slide)} by their weight alone. The discs "
            "are too coarse for the layers that liquefy, or get denser as they slide; "
            "noshiro converge repeats the slides with smaller discs."
        )


def _relief(results: Results) -> float:
    """Return the height (m) from the lowest to the highest point of the ground surface."""
    return float(results.config.section.ground[:, 1].max() - results.config.section.ground[:, 1].min())


def _case_words(case: LiquefiedCase) -> str:
    names = f" ({listed(list(case.names))})" if case.names else ""
    return of_cases(case.cases) + names


@dataclass(frozen=True)
class SufficientStrength:
    """Holds the residual strength (kPa) of each stratum for a factor of safety of 1, and whether it is a bound.

    Attributes
    ----------
    qualifier : "about", "more than" or "at most"
    strata : the strata with this strength
    lower, upper : the strata with strict bounds of this strength; empty without both bounds
    """

    qualifier: str
    strata: Strata
    lower: Strata = ()
    upper: Strata = ()

    @property
    def description(self) -> str:
        """Return the strengths as a sentence without its full stop."""
        if self.lower and self.upper:
            return f"The residual strength required to stand without shaking is {listed(list(self._between()))}"
        phrases = [
            f"{_span(kPa, 2)} kPa in {place} ({_span(ratios, 2)} of its mean vertical effective stress)"
            for place, (kPa, ratios) in _by_place(self.strata).items()
        ]
        sentence = f"The residual strength required to stand without shaking is {self.qualifier} {listed(phrases)}"
        if self.qualifier != "more than":
            return sentence
        how = "add a case with more residual strength to find the required strength, unless other ground fails first"
        return f"{sentence}; {how}"

    def _between(self) -> Iterator[str]:
        """Yield the strict bounds of the strength in every place, the lower one rounded down, the upper one up."""
        low, high = _by_place(self.lower), _by_place(self.upper)
        for place, (kPa, ratios) in high.items():
            yield (
                f"above {_rounded(low[place][0], math.floor)} and at most {_rounded(kPa, math.ceil)} kPa in {place} by "
                f"strict bounds (at most {_span(ratios, 2)} of its mean vertical effective stress)"
            )


def _rounded(values: Sequence[float], rounding: Callable[[float], int]) -> str:
    """Return the range of some values with three significant digits, rounded down or up."""
    ends = []
    for end in (min(values), max(values)):
        unit = 10.0 ** (math.floor(math.log10(end)) - 2)
        ends.append(f"{rounding(end / unit) * unit:g}")
    return " to ".join(dict.fromkeys(ends))


def _by_place(strata: Strata) -> dict[str, tuple[list[float], list[float]]]:
    """Return residual strengths (kPa) and their ratios to the mean vertical effective stress by the name that the
    report shows, which parts of one soil share."""
    parts: dict[str, tuple[list[float], list[float]]] = {}
    for stratum in strata:
        kPa, ratios = parts.setdefault(shown_name(stratum.name), ([], []))
        kPa.append(stratum.cohesion_kPa)
        ratios.append(stratum.residual_strength_ratio)
    return parts


def _span(values: Sequence[float], digits: int) -> str:
    """Return the range of some values with significant digits: 0.25 to 2.6, or one value if all are equal."""
    ends = (f"{float(f'{end:.{digits}g}'):g}" for end in (min(values), max(values)))
    return " to ".join(dict.fromkeys(ends))


def just_enough(answer: LiquefiedAnswer) -> SufficientStrength | None:
    """Return the residual strength with which the ground just stands without shaking; None without a factor of safety.

    If all cases flow, this is the required strength by finite elements, with its strict bounds, if there is one.
    Between a case that flows and a case that stands, the strength follows from linear interpolation of their factors of
    safety F. If all strengths are divided by F the ground just stands. If the ground flows (F below 1), the required
    residual strength is therefore larger than its value divided by the upper bound of F; if the ground stands, it may
    be smaller than its value divided by the lower bound. F is concave in the strength, as the minimum over mechanisms
    of linear functions, so that the steepest line that the bounds of two flowing cases allow gives another lower bound.
    """
    known = [(0.5 * (case.factor_lower + case.factor_upper), case) for case in answer.cases
             if case.factor_lower is not None and case.factor_upper is not None
             and not any(s.friction_deg for s in case.strata)]  # fmt: skip
    at_one = next((case for _, case in known if (case.factor_lower or 0.0) <= 1.0 <= (case.factor_upper or 0.0)), None)
    if at_one is not None:
        return SufficientStrength("about", at_one.strata)
    flowing = [case for f, case in sorted(known, key=itemgetter(0)) if f < 1.0]
    standing = [case for f, case in sorted(known, key=itemgetter(0)) if f >= 1.0]
    if flowing and standing and _alike(flowing[-1], standing[0]):
        return SufficientStrength(
            "about", _on_the_line(_middle(flowing[-1]), flowing[-1], _middle(standing[0]), standing[0])
        )
    if answer.required:
        return SufficientStrength("about", answer.required, answer.required_lower, answer.required_upper)
    if flowing:
        return SufficientStrength("more than", _at_least(flowing))
    return SufficientStrength("at most", _over(standing[0], standing[0].factor_lower)) if standing else None


def _at_least(flowing: Sequence[LiquefiedCase]) -> Strata:
    """Return a lower bound of the strength for a factor of safety of 1, from cases that flow, the strongest last."""
    last = flowing[-1]
    scaled = _over(last, last.factor_upper)
    if len(flowing) < 2 or not _alike(flowing[-2], last):
        return scaled
    line = _on_the_line(flowing[-2].factor_lower or 0.0, flowing[-2], last.factor_upper or 0.0, last)
    return max(scaled, line, key=lambda strata: strata[0].cohesion_kPa)


def _middle(case: LiquefiedCase) -> float:
    return 0.5 * ((case.factor_lower or 0.0) + (case.factor_upper or 0.0))


def _over(case: LiquefiedCase, factor: float | None) -> Strata:
    """Return the strata with their strength over a factor of safety."""
    return tuple(stratum.scaled(1.0 / (factor or 1.0)) for stratum in case.strata)


def _alike(weaker: LiquefiedCase, stronger: LiquefiedCase) -> bool:
    """Return whether two cases have the same strata, and the case with the larger factor of safety has more
    strength."""
    names = [stratum.name for stratum in weaker.strata] == [stratum.name for stratum in stronger.strata]
    pairs = [(a.cohesion_kPa, b.cohesion_kPa) for a, b in zip(weaker.strata, stronger.strata, strict=False)]
    return names and all(0.0 < a <= b for a, b in pairs) and any(a < b for a, b in pairs)


def _on_the_line(low: float, weaker: LiquefiedCase, high: float, stronger: LiquefiedCase) -> Strata:
    """Return the strata with the strength for a factor of safety of 1, by a line through two cases with the factors
    ``low`` and ``high``."""
    part = (1.0 - low) / (high - low)
    pairs = zip(weaker.strata, stronger.strata, strict=True)
    return tuple(a.scaled(1.0 + part * (b.cohesion_kPa / a.cohesion_kPa - 1.0)) for a, b in pairs)


def _field(results: Results, answer: LiquefiedAnswer) -> Iterator[str]:
    """Yield a contradiction if a measured displacement is too small for a case: a flow failure does not stop after a
    small displacement."""
    measured = [float(case.displacement) for case in results.config.report.observed]
    relief = _relief(results)
    if not measured or max(measured) >= FLOW_SHARE * relief:
        return
    flow = [case for case in answer.cases if case.verdict == "flows" and case.factor_upper is not None]
    stand = [case for case in answer.cases if case.verdict == "stands"]
    far = (
        f"At most {max(measured):.3g} m were measured, on {relief:.3g} m of height, where a flow failure would have "
        "moved further"
    )
    if not flow:
        yield f"{far}; in none of the cases does the ground flow."
        return
    times = listed([f"{1.0 / case.factor_upper:.2f}" for case in flow if case.factor_upper])
    names = listed([_case_words(case) for case in flow])
    yield (
        f"{far}. Either the ground differs from the section, or its residual strength was at least {times} times that "
        f"of {names}: {'this strength is' if len(flow) == 1 else 'these strengths are'} on the safe side."
    )
    if stand:
        agree = "agrees" if len(stand) == 1 else "agree"
        yield f"With the measured displacement {listed([_case_words(case) for case in stand])} {agree}."


def sentences(answer: LiquefiedAnswer) -> Iterator[str]:
    """Yield sentences on every case with its numbers, for the terminal."""
    for case in answer.cases:
        yield outcome(case)
        strengths = [f"{_span(kPa, 3)} kPa in {place}" for place, (kPa, _) in _by_place(case.strata).items()]
        yield f"    The residual strength is {listed(strengths)}."
        if case.factor is not None or case.factor_lower is not None:
            yield f"    The factor of safety at Kh = 0, between sides held horizontally, is {factors(case)}."
        yield from (f"    {words}" for words in circles_after_liquefaction(case))
        if case.kc is not None and case.kc_lower is not None:
            bounds = bracket(case.kc_lower, case.kc_upper, 3)
            yield f"    The critical Kh is {case.kc:.3f} by finite elements, and {bounds} by strict bounds."
        for note in case.notes:
            yield f"    Warning: {note}."
    enough = just_enough(answer)
    if enough is not None:
        yield f"{enough.description}."


def factors(case: Bearing) -> str:
    """Return the factor of safety with its bounds. The sides are held in both, as in strength reduction without
    shaking."""
    phrases = []
    if case.factor_lower is not None and case.factor_upper is not None:
        phrases.append(f"{bracket(case.factor_lower, case.factor_upper, 2)} by strict bounds with ψ = φ")
    elif case.factor_upper is not None:
        phrases.append(f"at most {case.factor_upper:.2f} by a strict bound with ψ = φ")
    elif case.factor_lower is not None:
        phrases.append(f"at least {case.factor_lower:.2f} by a strict bound with ψ = φ")
    if case.factor is not None:
        less = case.factor_lower is not None and case.factor < case.factor_lower
        more = case.factor_upper is not None and round(case.factor, 2) > round(case.factor_upper, 2)
        comparison = ", lower since ψ < φ" if less else ", above the strict upper bound, which counts" if more else ""
        phrases.append(f"{case.factor:.2f} by finite elements{comparison}")
    return ", ".join(phrases)
