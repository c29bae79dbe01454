"""Holds one estimate of a displacement, with its source and its assumptions."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fem.continuum.strength import davis_words, flow_of
from fem.settings import FlowSetting
from meshes.section.section import Section

EstimateKind = Literal[
    "block", "smooth block", "regression", "regression as printed", "spread", "block regression", "truss"
]


@dataclass(frozen=True)
class Estimate:
    """Holds one estimate of a displacement, with its source and its assumptions.

    Attributes
    ----------
    kind : kind of the method
    method : the method in words
    displacement_m : the displacement; None where the method gives none
    words : input and result in words
    source : publication of the method
    validity : range of validity
    """

    kind: EstimateKind
    method: str
    displacement_m: float | None
    words: str
    source: str
    validity: str

    def with_words(self, words: str) -> "Estimate":
        """Return the same estimate with other words."""
        return replace(self, words=words)


def mean_inclination(section: Section) -> float:
    """Return the mean inclination of the ground between its ends (rad), never negative."""
    (x0, z0), (x1, z1) = section.ground[0], section.ground[-1]
    return math.atan(abs(z1 - z0) / (x1 - x0))


def depth_below_ground(section: Section, line: np.ndarray) -> np.ndarray:
    """Return the depth (n,) below the ground (m) of the points of a ``line`` (n, 2), such as a slip surface."""
    depth: np.ndarray = np.interp(line[:, 0], *section.ground.T) - line[:, 1]
    return depth


def flow_words(section: Section, setting: FlowSetting) -> str:
    """Return the flow rule, in words, of the critical Kh that is the yield coefficient of sliding blocks."""
    flow = flow_of(section.strata, setting)
    if flow == "davis":
        return f"by {davis_words(stratum.dilation for stratum in section.strata)}"
    return "with ψ = φ" if flow == "associated" else "with the given ψ"
