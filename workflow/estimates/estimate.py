"""Holds one estimate of a displacement, with its source and its assumptions."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fem.continuum.strength import davis_words, flow_of
from fem.settings import FlowSetting
from meshes.section.section import Section

EstimateKind = Literal[
    "block", "smooth block", "regression", "regression as printed", "spread", "block regression", "truss"
]
LEAST_GRADIENT = 0.1  # %: relations for slopes do not apply to flatter ground (Youd, Hansen & Bartlett 2002)
DOES_NOT_APPLY = "does not apply: "  # before the reason, in the description of an estimate
SPREADS: tuple[EstimateKind, ...] = ("spread", "regression", "regression as printed")


@dataclass(frozen=True)
class Estimate:
    """Holds one estimate of a displacement, with its source and its assumptions.

    Attributes
    ----------
    kind : "block" or "smooth block" on a slip surface, "block regression", "regression" of slides of liquefied ground,
        also "as printed" in the paper, lateral "spread", or "truss"
    method : the method in words
    displacement_m : the displacement; None where the method gives none
    description : input and result in words
    source : publication of the method
    validity : range of validity
    applies : whether the ground is of the kind that the method is for, for example does not flow
    """

    kind: EstimateKind
    method: str
    displacement_m: float | None
    description: str
    source: str
    validity: str
    applies: bool = True


def mean_inclination(section: Section) -> float:
    """Return the mean inclination of the given ground between its ends (rad), never negative.

    Ground that is added beyond the given ends (``beyond``) does not count: it would make any slope as flat as it is
    long.
    """
    x0, x1 = section.given_extent
    z0, z1 = np.interp([x0, x1], *section.ground.T)
    return math.atan(abs(float(z1 - z0)) / (x1 - x0))


def depth_below_ground(section: Section, line: np.ndarray) -> np.ndarray:
    """Return the depth of the points of a line below the ground.

    Parameters
    ----------
    section : the ground
    line : points (n, 2) of a line in the ground, such as a slip surface (m)

    Returns
    -------
    Depths (n,) in m, vertically below the ground surface, down positive.
    """
    depth: np.ndarray = np.interp(line[:, 0], *section.ground.T) - line[:, 1]
    return depth


def flow_words(section: Section, setting: FlowSetting) -> str:
    """Return the flow rule of the critical Kh that is the yield coefficient of sliding blocks.

    Parameters
    ----------
    section : the ground, with the dilation angles of its strata
    setting : the setting ``fem.flow``

    Returns
    -------
    The flow rule in words, such as "with ψ = φ".
    """
    flow = flow_of(section.strata, setting)
    if flow == "davis":
        return f"by {davis_words(stratum.dilation for stratum in section.strata)}"
    return "with ψ = φ" if flow == "associated" else "with the given ψ"


def with_flow_failure(estimates: Iterable[Estimate], factors: Sequence[float]) -> list[Estimate]:
    """Mark estimates of lateral spreads as not applicable if the liquefied ground does not stand without shaking.

    The data of lateral spreads are of ground that stands once shaking ends: it moves in each half cycle of the shaking,
    up to its strain potential. Ground with a factor of safety below 1 moves by its weight until it is as flat as its
    residual strength allows. No relation for lateral spreads has ground that flows in its data (Youd, Hansen & Bartlett
    2002 exclude flow failures; Idriss & Boulanger 2008, section 4.4).

    Parameters
    ----------
    estimates : estimates of all methods
    factors : factors of safety without shaking of the cases of liquefied ground that flow; empty if none flows

    Returns
    -------
    All estimates; those of lateral spreads with a displacement do not apply if any case flows, with the reason in
    words.
    """
    rows = list(estimates)
    if not factors:
        return rows
    low, high = f"{min(factors):.2f}", f"{max(factors):.2f}"
    factor = low if low == high else f"{low} to {high}"
    words = (
        f"{DOES_NOT_APPLY}the liquefied ground does not stand without shaking (factor of safety {factor}), so that it "
        "flows until it is flat enough, and lateral spreads move only while the ground shakes"
    )
    return [
        replace(row, description=f"{row.description}; {words}", applies=False)
        if row.kind in SPREADS and row.displacement_m is not None
        else row
        for row in rows
    ]
