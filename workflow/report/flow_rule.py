"""States a critical Kh, or a factor of safety, with its flow rule: the value with ψ = φ, and Davis's estimate in the
same line."""

from collections.abc import Callable, Iterator, Mapping
from typing import assert_never

from fem.continuum.strength import Flow
from workflow.report.numbers import coefficient
from workflow.results.continuum import FemAnswer
from workflow.results.governing import GoverningKh

FLOW: Mapping[str, str] = {
    "associated": "associated flow, ψ = φ",
    "davis": "Davis reduced strength",
    "non-associated": "non-associated flow with the given ψ",
}
# When Davis's estimate counts, and when ψ = φ does.
WHEN = (
    "Strict bounds, limit equilibrium and most results of strength reduction are for ψ = φ. Davis's estimate has a "
    "reduced strength, and is a low estimate. Davis's estimate should be used where dense ground is confined, or where "
    "a dilation angle is given."
)
# Davis's estimate lies far below ψ = φ where it is less than this share of it.
DAVIS_RATIO = 0.85
# Which critical Kh sliding blocks resist with, and why.
BLOCKS: Mapping[Flow, str] = {
    "associated": "The yield coefficient is the critical Kh with ψ = φ, as in limit equilibrium, on which the "
    "published regressions of sliding blocks are based.",
    "davis": "The yield coefficient is the critical Kh by Davis's estimate, as set in the section: with ψ = φ the "
    "blocks would slide less.",
    "non-associated": "The yield coefficient is the critical Kh with the given ψ, as set in the section: with ψ = φ "
    "the blocks would slide less.",
}
# The same of discs, and of the verdict on liquefied ground.
DISCS = "The discs are calibrated to the continuum with the given ψ, 0 if none is given, since discs hardly dilate."
LIQUEFIED = (
    "Whether the ground stands after liquefaction follows from strict bounds, which have ψ = φ, or else from finite "
    "elements."
)


def with_flow(value: float, flow: Flow, compared: float | None, estimate: str, shown: Callable[[float], str]) -> str:
    """Return a critical Kh or factor of safety in words.

    Parameters
    ----------
    value : number by the flow rule ``flow`` (-)
    flow : the flow rule of the analysis
    compared : number by the other flow rule, if it differs (-)
    estimate : name of Davis's estimate
    shown : function that formats a number

    Returns
    -------
    Text such as "0.158 with ψ = φ; Davis's estimate for ψ = 0, which is no bound: 0.125".
    """
    match flow:
        case "associated":
            phrase = f"{shown(value)} with ψ = φ"
            if compared is None:
                return phrase
            low = min(compared, value)  # ground of reduced strength resists no more: a strict bound limits both
            return f"{phrase}; {estimate}, which is no bound: {_low(low, shown)}"
        case "davis":
            phrase = f"{shown(value)} by {estimate}, which is no bound"
        case "non-associated":
            phrase = f"{shown(value)} with the given ψ by a non-associated path"
        case _:
            assert_never(flow)
    return phrase if compared is None else f"{phrase}; with ψ = φ: {shown(compared)}"


def _low(value: float, shown: Callable[[float], str]) -> str:
    """Return Davis's estimate in words. If the ground with the reduced strength of Davis fails under its weight, the
    words give no Kh."""
    return shown(value) if value > 0.0 else "below 0, it fails under its own weight"


def critical_with_flow(fem: FemAnswer, shown: Callable[[float], str], governing: GoverningKh | None = None) -> str:
    """Return the critical Kh in words after its name, with its value by the other flow rule: "= 0.158 with ψ = φ". The
    ``governing`` critical Kh counts, if it is known; else the value of the finite elements."""
    other = fem.davis if fem.flow == "associated" else fem.associated
    known = other is not None and other.verdict in ("plateau", "peak")
    value, sign = (fem.kc, "=") if governing is None else (governing.value, governing.sign)
    return f"{sign} {with_flow(value, fem.flow, other.kc if known and other else None, fem.estimate, shown)}"


def own_dilation_sentences(fem: FemAnswer) -> Iterator[str]:
    """Yield sentences on the critical Kh with the dilation angles of the strata, if it was asked for."""
    third = fem.own_dilation
    if third is None:
        return
    if third.kc is None:
        yield f"A critical Kh for {fem.own_angles} was not found: {third.reason}."
    else:
        yield (
            f"The critical Kh is about {coefficient(third.kc)} for {fem.own_angles}, {third.low:.3f} to "
            f"{third.high:.3f} on three meshes. This Kh was found by iteration, and depends on element and mesh by 5 "
            f"to 15 %."
        )


def how_to_get_own_dilation(fem: FemAnswer) -> str:
    """Return how to get the critical Kh for the dilation angles of the strata if Davis's estimate lies far below that
    with ψ = φ; empty if it does not, or if the Kh was asked for.
    """
    if fem.own_dilation is not None or (fem.davis is None and fem.associated is None):
        return ""
    full = fem.kc if fem.associated is None else fem.associated.kc
    low = fem.kc if fem.davis is None else fem.davis.kc
    return (
        f" The option --set fem.own_dilation=true also computes an approximate critical Kh for {fem.own_angles}."
        if low < DAVIS_RATIO * full
        else ""
    )
