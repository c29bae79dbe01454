"""Stores the predictions of known slides in the file `answers.json` beside the cases."""

from dataclasses import dataclass

from docs.verify.record import Named

Line = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class SlideAnswer(Named):
    """Holds the predictions of a known slide.

    Attributes
    ----------
    values : predicted numbers, one per packing
    loose : shares of the mass that left the connected ground, one per packing
    rested : whether the ground came to rest, one per packing
    before, after : surface (x, z) of the first packing before and after the slide (m)
    seconds : processor time (s)
    failure : reason of a missing prediction; empty if there is one
    points : prediction by material points; None if the case does not request it
    """

    values: tuple[float, ...] = ()
    loose: tuple[float, ...] = ()
    rested: tuple[bool, ...] = ()
    before: Line = ()
    after: Line = ()
    seconds: float = 0.0
    failure: str = ""
    points: float | None = None
