"""Predictions of a known slide, and their file from run to run: `answers.json` beside the cases."""

from dataclasses import dataclass

from docs.verify.record import Named

Line = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class SlideAnswer(Named):
    """Predictions by packing.

    Attributes
    ----------
    values : tuple of float
        Of the quantity of the case, by seed.
    loose : tuple of float
        Shares of the mass that left the connected ground.
    rested : tuple of bool
        Whether the ground came to rest.
    before, after : tuple of (x, z)
        Surface of the first packing (m).
    seconds : float
        Of processor time.
    failure : str
        Why there is no prediction; empty where there is one.
    points : float or None
        What material points predict, where the case asks for them.
    """

    values: tuple[float, ...] = ()
    loose: tuple[float, ...] = ()
    rested: tuple[bool, ...] = ()
    before: Line = ()
    after: Line = ()
    seconds: float = 0.0
    failure: str = ""
    points: float | None = None
