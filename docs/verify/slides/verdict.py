"""Decides whether the prediction of a slide is right by its ratio to the measured slide."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from docs.verify.slides.case import SlideCase, UniformSlope
from docs.verify.slides.record import SlideAnswer

CLOSE_FACTOR, FAR_FACTOR = 1.5, 3.0  # times or a part of what was measured

Word = Literal["not run", "failed", "within the band", "within 1.5", "within 3", "beyond 3", "stands", "moved", "flows"]


@dataclass(frozen=True)
class SlideVerdict:
    """Holds the verdict on a prediction.

    Attributes
    ----------
    word : one of `Word`
    ratio : mean prediction over the geometric mean of the measured range; infinite if the ground flows; None without a
        prediction, or if no movement was measured
    spread : the same for the smallest and the largest prediction of the packings
    """

    word: Word
    ratio: float | None = None
    spread: tuple[float, float] | None = None

    @property
    def factor(self) -> float | None:
        """Return the error as a factor: the larger one of predicted over measured and measured over predicted."""
        if self.ratio is None:
            return None
        return max(self.ratio, 1.0 / self.ratio) if self.ratio > 0.0 else float("inf")


def judge(case: SlideCase, answer: SlideAnswer | None) -> SlideVerdict:
    """Return the verdict on a case. An infinite slope that does not come to rest flows, since its weight exceeds its
    strength."""
    if answer is None:
        return SlideVerdict("not run")
    if isinstance(case.known.problem, UniformSlope) and not all(answer.rested):
        return SlideVerdict("flows", float("inf"))
    return _verdict_of(case, answer.values) if answer.values else SlideVerdict("failed")


def judge_points(case: SlideCase, answer: SlideAnswer | None) -> SlideVerdict | None:
    """Return the verdict on the prediction by material points; None if it was not requested. The points flow if the
    discs do not come to rest and the points move more than three times as far as measured."""
    if answer is None or answer.points is None:
        return None
    verdict = _verdict_of(case, (answer.points,))
    flows = verdict.word == "beyond 3" and judge(case, answer).word == "flows"
    return SlideVerdict("flows", float("inf")) if flows else verdict


def _verdict_of(case: SlideCase, predicted: tuple[float, ...]) -> SlideVerdict:
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
        word = "within 1.5" if off <= CLOSE_FACTOR else "within 3" if off <= FAR_FACTOR else "beyond 3"
    return SlideVerdict(word, ratio, spread)


def right(verdicts: Iterable[SlideVerdict], factor: float) -> int:
    """Return the number of predictions within a factor of the measured slide, including explained ones."""
    return sum(v.word == "stands" or (v.factor is not None and v.factor <= factor) for v in verdicts)


def bias(verdicts: Collection[SlideVerdict]) -> float | None:
    """Return the median of predicted over measured slides; None without any."""
    ratios = [v.ratio for v in verdicts if v.ratio is not None]
    return float(np.median(ratios)) if ratios else None
