"""Whether a prediction of a slide is right: how far it is off what was measured."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from docs.verify.slides.case import SlideCase, UniformSlope
from docs.verify.slides.record import SlideAnswer

CLOSE, FAR = 1.5, 3.0  # times or a part of what was measured

Word = Literal["not run", "failed", "within the band", "within 1.5", "within 3", "beyond 3", "stands", "moved", "flows"]


@dataclass(frozen=True)
class SlideVerdict:
    """The verdict on a prediction.

    Attributes
    ----------
    word : str
        As in `Word`.
    ratio : float or None
        Mean of the predictions over the middle (geometric) of what was measured; infinite where the ground flows; None
        where nothing was measured to move, or there is no prediction.
    spread : (float, float) or None
        The same of the least and the largest prediction of the packings.
    """

    word: Word
    ratio: float | None = None
    spread: tuple[float, float] | None = None

    @property
    def factor(self) -> float | None:
        """Error as a factor: the larger one of predicted over measured and measured over predicted."""
        if self.ratio is None:
            return None
        return max(self.ratio, 1.0 / self.ratio) if self.ratio > 0.0 else float("inf")


def judge(case: SlideCase, answer: SlideAnswer | None) -> SlideVerdict:
    """The verdict on a case. An endless slope flows where it does not come to rest: its weight asks for more."""
    if answer is None:
        return SlideVerdict("not run")
    if isinstance(case.known.problem, UniformSlope) and not all(answer.rested):
        return SlideVerdict("flows", float("inf"))
    return _judged(case, answer.values) if answer.values else SlideVerdict("failed")


def judge_points(case: SlideCase, answer: SlideAnswer | None) -> SlideVerdict | None:
    """The verdict on the prediction by material points; None where MPM was not requested. Points flow where discs
    do not come to rest, and points go far, too."""
    if answer is None or answer.points is None:
        return None
    verdict = _judged(case, (answer.points,))
    flows = verdict.word == "beyond 3" and judge(case, answer).word == "flows"
    return SlideVerdict("flows", float("inf")) if flows else verdict


def _judged(case: SlideCase, predicted: tuple[float, ...]) -> SlideVerdict:
    low, high = case.measured
    values = np.array(predicted)
    mean = float(values.mean())
    if high <= case.known.zero:
        return SlideVerdict("stands" if float(values.max()) <= case.known.zero else "moved")
    middle = float(np.sqrt(max(low, case.known.zero, 1e-9) * high))
    ratio = mean / middle
    spread = (float(values.min()) / middle, float(values.max()) / middle)
    word: Word = "beyond 3"
    if low <= mean <= high:
        word = "within the band"
    elif ratio > 0.0:
        off = max(ratio, 1.0 / ratio)
        word = "within 1.5" if off <= CLOSE else "within 3" if off <= FAR else "beyond 3"
    return SlideVerdict(word, ratio, spread)


def right(verdicts: Iterable[SlideVerdict], factor: float) -> int:
    """Number of predictions within a factor of the measured slide, explained ones included."""
    return sum(v.word == "stands" or (v.factor is not None and v.factor <= factor) for v in verdicts)


def bias(verdicts: Collection[SlideVerdict]) -> float | None:
    """Median of predicted over measured; None where there is nothing to take it of."""
    ratios = [v.ratio for v in verdicts if v.ratio is not None]
    return float(np.median(ratios)) if ratios else None
