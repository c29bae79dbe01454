"""States how a free mesh changes the tips of strata that thin out to nothing, in one sentence for each soil."""

from collections.abc import Sequence
from dataclasses import dataclass

from meshes.section.sentences import coordinate


@dataclass(frozen=True)
class TipChange:
    """Describes the change of a tip of a stratum.

    Attributes
    ----------
    name : the part of the ground whose tip changes, in words
    soil : its soil, as messages name it; empty for the whole section
    x : place of the tip (m)
    step : height of the step in which the tip ends (m)
    at : place of the step (m)
    gain : area that the part of the ground gets (m²); negative if it loses its tip
    """

    name: str
    soil: str
    x: float
    step: float
    at: float
    gain: float

    @property
    def description(self) -> str:
        """Return a sentence on the tip."""
        words = f"mesh: {self.name} thins out to nothing at x = {coordinate(self.x)} m; in the mesh it ends"
        if self.gain >= 0.0:
            return f"{words} there in a step of {self.step:.2g} m, with {self.gain:.2g} m² more"
        where = f"at x = {coordinate(self.at)} m"
        return f"{words} in a step of {self.step:.2g} m {where}, without the last {-self.gain:.2g} m²"


def sentences_on_tips(changes: Sequence[TipChange | str]) -> list[str]:
    """Return one sentence on all tips of a soil, in the place of its first tip, and the other ``changes``, which are
    sentences, as they are."""
    of_soil: dict[str, list[TipChange]] = {}
    for change in changes:
        if isinstance(change, TipChange):
            of_soil.setdefault(change.soil, []).append(change)
    sentences = (change if isinstance(change, str) else _sentence(of_soil[change.soil]) for change in changes)
    return list(dict.fromkeys(sentences))


def _sentence(tips: Sequence[TipChange]) -> str:
    """Return a sentence on the tips of one soil."""
    if len(tips) == 1:
        return tips[0].description
    subject = f"stratum {tips[0].soil}" if tips[0].soil else "the section"
    places = ", ".join(sorted({coordinate(tip.x) for tip in tips}, key=float))
    steps = " to ".join(sorted({f"{end([tip.step for tip in tips]):.2g}" for end in (min, max)}, key=float))
    lost, gained = (sum(max(sign * tip.gain, 0.0) for tip in tips) for sign in (-1.0, 1.0))
    areas = [f"lose {lost:.2g} m²"] * bool(lost > 0.0) + [f"gain {gained:.2g} m²"] * bool(gained > 0.0)
    return (
        f"mesh: {subject} thins out to nothing at {len(tips)} tips, x = {places} m; in the mesh the tips end in steps "
        f"of {steps} m and {' and '.join(areas) or 'keep their area'}"
    )
