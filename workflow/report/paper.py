"""Compares computed results with the paper on section S-13, with reasons for differences."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from dem.settings import PAPER_LOADING
from meshes.section.section import Section
from workflow.estimates.comparison import is_s13
from workflow.estimates.sliding_block import SmoothPlane
from workflow.report.numbers import span
from workflow.results.answer import Line
from workflow.results.cases import CaseAnswer
from workflow.results.continuum import StoredState
from workflow.results.discs import SetOfSprings
from workflow.results.results import Results
from workflow.results.summary import PaperRow

ASD = ("3 Asd", "4 Asd", "5 Asd")
ASD_BELOW_WATER = ("4 Asd", "5 Asd")

KC = 0.25  # Sec. 4(1): "about 0.25 g"
KC_TOLERANCE = 0.025  # half of the paper's steps of Kh, 0.2, 0.25, 0.3
SPRING_NAMES: Mapping[SetOfSprings, str] = {
    "before": ", before calibration", "after": ", calibrated", "paper": ", the paper's discs",
}  # fmt: skip
SETTLEMENT = {1: 0.1, 2: 0.5, 3: 1.0}  # m, Sec. 4(3)
SLIDE = {2: 3.3, 3: 4.9}  # m, Sec. 4(3)
MEASURED = 3.0  # m, Figs 4 and 5
DISPLACEMENT_TOLERANCE = 0.3  # the share by which settlements and slides of a reconstructed section may differ
FAILED_CELL_SHARE = 0.25  # the share of a layer's cells that makes it "at failure"
WHOLE_SURFACE_SHARE = 0.8  # the share of the surface that is "the whole but for the right side"
SLOPE_DEG = 2.6

# A case in words, and whether it agrees with the paper.
Comparison = Callable[[CaseAnswer], tuple[str, bool]]

SECTION = "the depths of the interfaces are a reconstruction"


def rows(results: Results) -> list[PaperRow]:
    """Return the rows of the comparison of the paper with our results; empty for other sections."""
    if not is_s13(results.config.section):
        return []
    table = [*_fem(results)]
    for which in _disc_sets(results):
        table += _dem(results, which)
    for name in results.cases.sets if results.cases is not None else ("",):
        table += _slides(results, name)
    table += [_measured(results), _smooth()]
    return [row if row.agrees is False else replace(row, reason="") for row in table]


def _absent(results: Results, stage: str) -> str:
    entry = results.no_answer(stage)
    return f"no answer: {entry.reason}" if entry else "not computed"


def _fem(results: Results) -> Iterator[PaperRow]:
    result = _absent(results, "fem")
    at_02 = PaperRow("FEM: stands at Kh = 0.2, Asd layers below water at failure", "yes", "Fig. 9", result)
    kc = PaperRow("FEM: critical Kh", "about 0.25", "Fig. 10, Sec. 4(1)", result)
    surface = PaperRow("FEM: failure surface in the Asd layers", "yes", "Fig. 10(b)", result)
    past = "FEM: Kh = 0.3 is past equilibrium, failure zone from Asd to the surface"
    at_03 = PaperRow(past, "yes", "Fig. 11", result)
    if results.fem is None or results.kc is None:
        yield from (at_02, kc, surface, at_03)
        return
    conditions = f"sides {results.config.fem.sides}, {results.fem.element} elements"
    state = results.fem.state_at(0.2)
    yield at_02 if state is None else _stands(at_02, state)
    yield replace(
        kc,
        ours=f"{results.kc:.3f} (at most {results.fem.kc_upper:.3f}), {conditions}",
        agrees=abs(results.kc - KC) <= KC_TOLERANCE,
        reason=f"{SECTION}; the critical Kh depends on sides, dilation and element; the paper names neither dilation "
        "nor convergence",
    )
    end = results.fem.last_in_equilibrium()
    if end is not None:
        share = share_of_surface(results.config.section, end.slip_surface, ASD)
        reason = f"{SECTION}; the slip surface lies where the ground moves half as far as the upper half above it"
        yield replace(surface, ours=f"{100 * share:.0f} % of its length", agrees=share >= 0.5, reason=reason)
    state = results.fem.state_at(0.3)
    yield at_03 if state is None else _past(at_03, state)


def _stands(row: PaperRow, state: StoredState) -> PaperRow:
    shares = {name: state.failed_share_by_stratum.get(name, 0.0) for name in ASD_BELOW_WATER}
    stands = not state.past_equilibrium
    phrase = ("stands; " if stands else "does not stand; ") + _shares(shares) + " at failure"
    reason = f"{SECTION}; a layer counts as at failure from {100 * FAILED_CELL_SHARE:.0f} % of its cells on"
    return replace(row, ours=phrase, agrees=stands and max(shares.values()) >= FAILED_CELL_SHARE, reason=reason)


def _past(row: PaperRow, state: StoredState) -> PaperRow:
    shares = {name: state.failed_share_by_stratum.get(name, 0.0) for name in ("1 Ts", *ASD)}
    phrase = ("past equilibrium; " if state.past_equilibrium else "stands; ") + _shares(shares) + " at failure"
    reaches = shares["1 Ts"] > 0.0 and max(shares[name] for name in ASD) > 0.0
    reason = f"{SECTION}; the failure zone counts as continuous if cells of 1 Ts and of an Asd layer are at failure"
    return replace(row, ours=phrase, agrees=state.past_equilibrium and reaches, reason=reason)


def _shares(shares: dict[str, float]) -> str:
    return ", ".join(f"{100 * share:.0f} % of {name}" for name, share in shares.items())


def share_of_surface(config: Section, line: Line, names: tuple[str, ...]) -> float:
    """Return the share of the points [x, z] of a slip surface that lie in the strata with these names."""
    if not line:
        return 0.0
    points = np.array(line)
    inside = config.stratum_at(points[:, 0], points[:, 1])
    wanted = [k for k, stratum in enumerate(config.strata) if stratum.name in names]
    return float(np.isin(inside, wanted).mean())


def _has_soil_discs(results: Results) -> bool:
    return results.dem is not None and results.dem.model.discs == "soil"


def _disc_sets(results: Results) -> tuple[SetOfSprings, ...]:
    """Return the sets of discs that are compared with those of the paper."""
    if not _has_soil_discs(results):
        return "before", "after"
    return ("paper", "after") if results.dem is not None and results.dem.paper is not None else ("after",)


def _dem(results: Results, which: SetOfSprings) -> Iterator[PaperRow]:
    """Yield the states of the discs at the two Kh of the paper, "before" or "after" calibration."""
    springs, result = SPRING_NAMES[which], _absent(results, "calibrate")
    stands = PaperRow(f"DEM: stands at Kh = 0.2{springs}", "yes", "Fig. 12", result)
    broken = PaperRow(f"DEM: pore springs broken along the Asd layers at Kh = 0.3{springs}", "yes", "Fig. 13", result)
    states = results.dem.states_of(which) if results.dem is not None else {}
    if 0.2 in states:
        verdict, reason = states[0.2].verdict, f"{states[0.2].reason}; {SECTION}"
        stands = replace(stands, ours=verdict, agrees=verdict == "stands", reason=reason)
    if 0.3 in states:
        broken = _broken(broken, states[0.3].cracked_share_by_stratum)
    yield stands
    if not (which == "after" and _has_soil_discs(results)):  # soil discs have no pore springs
        yield broken


def _broken(row: PaperRow, cracked: dict[str, float]) -> PaperRow:
    """Return whether pore springs, the breakable springs between discs that represent pore water, crack most in the Asd
    layers."""
    shares = {name: cracked.get(name, 0.0) for name in ASD}
    most = max(shares.values())
    others = {name: share for name, share in cracked.items() if name not in ASD and share > most}
    reason = (
        f"more break elsewhere: {_shares(others)}" if others else f"fewer than {100 * FAILED_CELL_SHARE:.0f} % in each"
    )
    agrees = most >= FAILED_CELL_SHARE and not others
    return replace(row, ours=_shares(shares) + " broken", agrees=agrees, reason=f"{reason}; {SECTION}")


def _slides(results: Results, name: str) -> Iterator[PaperRow]:
    cases = results.cases.sets[name] if results.cases is not None else {}
    springs = {"table2": ", springs of Table 2", "calibrated": ", calibrated springs"}.get(name, "")
    open_points = "the text of the paper leaves open how contacts are averaged and how fast layers liquefy"
    loading = "" if name == "table2" else _other_loading(results)
    reason = f"{SECTION}; {loading}{open_points} (see docs/theory/paper.md)"

    def row(number: int, what: str, paper: str, where: str, compare: Comparison) -> PaperRow:
        quantity = f"{what}, case {number}{springs}"
        case = cases.get(number)
        if case is None:
            return PaperRow(quantity, paper, where, _absent(results, "slide"))
        result, agrees = compare(case)
        moving = "" if case.settled else f"; {case.reason}"
        return PaperRow(quantity, paper, where, result, agrees, reason + moving)

    for number, metres in SETTLEMENT.items():
        near_settlement = partial(_near, "settlement_uphill_m", metres)
        yield row(number, "settlement uphill", f"{metres:g} m", "Sec. 4(3)", near_settlement)
    yield row(1, "slide", "uphill half only", "Fig. 14", partial(_uphill_only, results.config.section))
    for number, metres in SLIDE.items():
        yield row(number, "largest slide", f"{metres:g} m", "Sec. 4(3)", partial(_near, "slide_max_m", metres))
    yield row(3, "slide", "whole surface but for the right side", "Fig. 16", _almost_all)


def _near(length: str, paper: float, case: CaseAnswer) -> tuple[str, bool]:
    return near(getattr(case, length), paper)


def near(ours: float, paper: float) -> tuple[str, bool]:
    """Return a length (m) in words, and whether it is within 30 % of the length in the paper."""
    return f"{ours:.2f} m", abs(ours - paper) <= DISPLACEMENT_TOLERANCE * paper


def _almost_all(case: CaseAnswer) -> tuple[str, bool]:
    share = case.slides_over_share
    return f"{100 * share:.0f} % of the surface", share >= WHOLE_SURFACE_SHARE


def _uphill_only(config: Section, case: CaseAnswer) -> tuple[str, bool]:
    left, right = config.extent
    middle = 0.5 * (left + right)
    at = case.slide_max_at_x_m
    phrase = f"{100 * case.slides_over_share:.0f} % of the surface, most at x = {at:.0f} m"
    return phrase, at <= middle and case.slides_over_share <= 0.5


def _measured(results: Results) -> PaperRow:
    _, cases = results.case_set()
    slides = [case.slide_max_m for number, case in sorted(cases.items()) if number in SLIDE]
    row = PaperRow("slide measured in the field", "about 3 m", "Figs 4 and 5", _absent(results, "slide"))
    if not slides:
        return row
    phrase = f"{span(slides)} in cases 2 and 3"
    agrees = (
        min(slides) <= (1.0 + DISPLACEMENT_TOLERANCE) * MEASURED
        and max(slides) >= (1.0 - DISPLACEMENT_TOLERANCE) * MEASURED
    )
    return replace(row, ours=phrase, agrees=agrees, reason=f"{SECTION}; cases and Kh are assumptions, too")


def _other_loading(results: Results) -> str:
    """Return a clause that the paper holds its Kh constant, if the slides have another loading; else return nothing."""
    slide = results.config.slide
    same = all(getattr(slide, key) == value for key, value in PAPER_LOADING.items())
    return (
        ""
        if same
        else f"Kh = {PAPER_LOADING['kh']:g} is constant and does not end in the paper, here it is {slide.shaking}; "
    )


def _smooth() -> PaperRow:
    plane = SmoothPlane(math.radians(SLOPE_DEG))
    phrase = (
        f"{plane.acceleration:.2f} m/s²; {plane.speed(9.0):.1f} m/s after 9 s (but then {plane.distance(9.0):.0f} m; "
        f"3 m take {plane.time_for(3.0):.1f} s)"
    )
    agrees = round(plane.acceleration, 2) == 0.44 and abs(plane.speed(9.0) - 4.0) <= 0.1
    return PaperRow("block on a smooth plane of 2.6°", "0.44 m/s²; 4 m/s and 3 m after 9 s", "Sec. 5", phrase, agrees,
               "the 3 m after 9 s in the paper are an error")  # fmt: skip
