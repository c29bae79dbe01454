"""Estimates displacements with which slides are compared: sliding blocks, and regressions over observed cases."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshes.section.section import Section
from meshes.section.stratum import cases_of
from workflow.config.tables import Tables
from workflow.estimates.empirical import empirical
from workflow.estimates.estimate import (
    DOES_NOT_APPLY,
    LEAST_GRADIENT,
    Estimate,
    flow_words,
    mean_inclination,
)
from workflow.estimates.regression import hamada, hamada_as_printed, liquefied
from workflow.estimates.sliding_block import SmoothPlane, newmark, rectangular_pulse

NEWMARK = "N. M. Newmark, Géotechnique 15 (1965) 139-160"
NEWMARK_VALIDITY = (
    "rigid ground above one slip surface of constant strength; no liquefaction, no change of shape; an index of "
    "hazard rather than a prediction"
)
HAMADA = "M. Hamada, S. Yasuda, R. Isoyama, K. Emoto (1986)"
HAMADA_VALIDITY = (
    "60 sections in Niigata and Noshiro: gentle slopes of liquefied sand; independent of shaking and strength"
)
PAPER = "the paper"  # on S-13
S13_STRATA = ("1 Ts", "2 Ac1", "3 Asd", "4 Asd", "5 Asd", "6 As1", "7 Ac2", "8 As1", "9 Ac3", "10 Base")

NO_LINE = np.zeros((0, 2))


def constant_kh(settings: Tables) -> float:
    """Return the Kh that drives a sliding block without a record.

    Parameters
    ----------
    settings : tables [sliding_block] and [slide]

    Returns
    -------
    Kh (-) of the block or, if it has none, of the slides.
    """
    return settings.slide.kh if settings.sliding_block.kh is None else settings.sliding_block.kh


@dataclass(frozen=True)
class BlockDrive:
    """Holds the loading of a sliding block without a record: Kh that is constant for ``seconds`` (possibly infinite),
    or cyclic with ``cycles`` of a ``period`` (s).
    """

    seconds: float
    cycles: float | None = None
    period: float = 0.0

    def slide(self, kc: float, kh: float) -> float:
        """Return the slide (m) of a block with yield coefficient ``kc`` under ``kh`` (-); infinite if it never
        stops."""
        from dem.slides.drive import cyclic_acceleration  # what only reads answers does without the kernels of discs

        if self.cycles is None:
            return rectangular_pulse(kc, kh, self.seconds)
        return newmark(*cyclic_acceleration(kh, self.cycles, self.period), kc).permanent

    @property
    def description(self) -> str:
        """Return the loading in words."""
        if self.cycles is not None:
            return f"in both directions ({self.cycles:g} cycles, period {self.period:g} s)"
        return "constant" if math.isinf(self.seconds) else f"for {self.seconds:g} s"


def block_drive(settings: Tables) -> BlockDrive:
    """Return the loading of a sliding block without a record, for the duration of the block, or else of the slides.

    Parameters
    ----------
    settings : tables [sliding_block] and [slide]

    Returns
    -------
    Cycles of Kh if the slides have cycles and the block has no duration; else a constant Kh for its duration, which is
    infinite if none is given.
    """
    slide, seconds = settings.slide, settings.sliding_block.seconds
    if seconds is None and slide.kh_cycles is not None and slide.kh_period is not None:
        return BlockDrive(slide.kh_cycles * slide.kh_period, slide.kh_cycles, slide.kh_period)
    return BlockDrive(seconds or slide.kh_seconds or math.inf)


def is_s13(section: Section) -> bool:
    """Return whether a section is S-13, the section of the paper.

    Parameters
    ----------
    section : the ground

    Returns
    -------
    True if its name and its ten strata are those of S-13.
    """
    return section.name == "s13" and tuple(stratum.name for stratum in section.strata) == S13_STRATA


def estimates(
    section: Section, settings: Tables, kc: float | None, slip_surface: np.ndarray = NO_LINE
) -> list[Estimate]:
    """Return all estimates of displacements that an input allows.

    Sliding blocks with friction need the critical Kh. The estimates of the paper are made for section S-13 only.

    Parameters
    ----------
    section : the ground
    settings : settings of all tables
    kc : critical Kh (-); None if there is none
    slip_surface : slip surface (n, 2) by the finite elements (m); may be empty

    Returns
    -------
    The estimates, also of methods that do not apply to this ground.
    """
    rows: list[Estimate] = []
    if kc is not None and kc > 0.0:
        resisted = f"resisted by kc = {kc:.3f} {flow_words(section, settings.fem.flow)}"
        rows += _constant(settings, kc, resisted)
        if settings.sliding_block.accelerogram:
            rows += _newmark(settings, kc, resisted)
    rows += [_smooth(section), *_regressions(section)]
    if not is_s13(section):
        rows = [row for row in rows if not row.source.startswith(PAPER)]
    return [*rows, *empirical(section, settings, kc, slip_surface)]


@dataclass(frozen=True)
class BlockSlide:
    """Holds the slide of a rigid block in both directions of a record, or under Kh.

    Attributes
    ----------
    low, high : smaller and larger slide of both directions (m); equal under Kh
    description : loading in words
    """

    low: float
    high: float
    description: str

    @property
    def span(self) -> str:
        """Return the interval of the slide in words."""
        low, high = f"{self.low:.2f}", f"{self.high:.2f}"
        return f"{low} m" if low == high else f"{low} to {high} m"


def block_slide(settings: Tables, kc: float) -> BlockSlide | None:
    """Compute the slide of a rigid block in both directions of the record, or else under Kh (Newmark 1965).

    Parameters
    ----------
    settings : tables [sliding_block] and [slide]
    kc : yield coefficient of the block (-), above 0

    Returns
    -------
    The slide; None if Kh is constant without end and exceeds ``kc``, so that the block never stops.
    """
    if not settings.sliding_block.accelerogram:
        kh, drive = constant_kh(settings), block_drive(settings)
        slide = drive.slide(kc, kh)
        return None if math.isinf(slide) else BlockSlide(slide, slide, f"Kh = {kh:g} {drive.description}")
    record = settings.sliding_block.in_use()
    slides = [newmark(record.time, sign * record.acceleration, kc).permanent for sign in (1.0, -1.0)]
    return BlockSlide(min(slides), max(slides), f"{record.name}, in both directions")


def _constant(settings: Tables, kc: float, resisted: str) -> Iterator[Estimate]:
    kh, drive = constant_kh(settings), block_drive(settings)
    slide = drive.slide(kc, kh)
    if math.isinf(slide):
        return
    words = f"Kh = {kh:g} {drive.description}, {resisted}: "
    words += "does not slide" if kh <= kc else f"slides {slide:.2f} m until it stops"
    yield Estimate("block", f"rigid block on the slip surface, Kh = {kh:g}", slide, words, NEWMARK, NEWMARK_VALIDITY)


def _newmark(settings: Tables, kc: float, resisted: str) -> Iterator[Estimate]:
    record = settings.sliding_block.in_use()
    slides = [newmark(record.time, sign * record.acceleration, kc).permanent for sign in (1.0, -1.0)]
    named = zip(("positive", "negative", "mean"), (*slides, sum(slides) / 2.0), strict=True)
    peak = f"{record.name} ({record.kind}), peak {record.peak:.2f} m/s², {resisted}"
    for direction, slide in named:
        yield Estimate(
            "block", f"rigid block under the accelerogram, {direction}", slide, peak, NEWMARK, NEWMARK_VALIDITY
        )


def _smooth(section: Section) -> Estimate:
    slope = mean_inclination(section)
    plane = SmoothPlane(slope)
    if plane.acceleration <= 0.0:
        words = "the ends of the ground are level: no acceleration"
    else:
        words = (
            f"on a slope of {math.degrees(slope):.1f}° the block accelerates at {plane.acceleration:.2f} m/s²; "
            f"it moves 3 m in {plane.time_for(3.0):.1f} s, has moved {plane.distance(9.0):.0f} m after 9 s at a "
            f"speed of {plane.speed(9.0):.1f} m/s, and does not stop"
        )
    return Estimate(
        "smooth block", "block without friction on the mean slope", None, words, f"{PAPER}, Sec. 5",
        "no strength on the slip surface; a limit, not an estimate",
    )  # fmt: skip


def _regressions(section: Section) -> Iterator[Estimate]:
    by_ground: dict[Any, list[int]] = {}
    for case in cases_of(section.strata):
        ground = liquefied(section, case)
        if ground is not None:
            by_ground.setdefault(ground, []).append(case)
    for ground, cases in by_ground.items():
        which = f"case{'s' * (len(cases) > 1)} {', '.join(map(str, cases))}"
        words = f"{which}: H = {ground.thickness:.2f} m (up to {ground.thickest:.2f} m), θ = {ground.gradient:.2f} %"
        slopes = ground.gradient >= LEAST_GRADIENT
        words += "" if slopes else f"; {DOES_NOT_APPLY}the ground and its layers are level"
        by_root, printed = (
            relation(ground.thickness, ground.gradient) if slopes else None for relation in (hamada, hamada_as_printed)
        )
        yield Estimate("regression", "Hamada et al., D = 0.75 √H ∛θ", by_root, words, HAMADA, HAMADA_VALIDITY, slopes)
        yield Estimate(
            "regression as printed",
            "Hamada et al. as the paper prints it, D = 0.75 ∛H ∛θ",
            printed,
            words,
            f"{PAPER}, eq. (18), which has a cube root of H where all other sources have a square root",
            HAMADA_VALIDITY,
            slopes,
        )
