"""Computes fragility: the probability of failure, and of slides beyond a length, over the intensity of shaking."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.stats import norm

from dem.settings import AVERAGE
from meshes.section.quantity import GRAVITY
from workflow.config import Config
from workflow.earthquake.accelerogram import Accelerogram, read
from workflow.estimates.comparison import block_drive, constant_kh
from workflow.estimates.sliding_block import newmark
from workflow.results.study import ProbabilityCurve
from workflow.study.statistics import probability
from workflow.study.table import SampleTable

SPREADS = (0.05, 3.0)  # of the logarithm, that a fit may have: samples that part cleanly would have none
SEED, RESAMPLES = 0, 200
TAILS = (0.025, 0.975)


def fit(levels: np.ndarray, exceeds: np.ndarray) -> tuple[float, float]:
    """Fit median θ and dispersion β of P = Φ(ln(x / θ) / β), by maximum likelihood.

    M. Shinozuka et al., J. Eng. Mech. 126 (2000) 1224-1231; J. W. Baker, Earthquake Spectra 31 (2015) 579-599, eq. 11.
    ``levels`` (n,) are above 0; ``exceeds`` (n,) has true and false values.
    """
    logarithms = np.log(levels)

    def unlikely(guess: np.ndarray) -> float:
        z = (logarithms - guess[0]) / guess[1]
        return -float(np.where(exceeds, norm.logcdf(z), norm.logsf(z)).sum())

    within = [(logarithms.min() - 3.0, logarithms.max() + 3.0), SPREADS]
    first = np.array([float(np.clip(logarithms.mean(), *within[0])), 0.4])
    optimum = minimize(unlikely, first, bounds=within, method="L-BFGS-B")
    return float(np.exp(optimum.x[0])), float(optimum.x[1])


def curve(name: str, levels: np.ndarray, exceeds: np.ndarray) -> ProbabilityCurve | None:
    """Return the fit as a curve with its 95 % interval by bootstrap; None if all samples exceed, or none does."""
    if not (levels > 0.0).all() or exceeds.all() or not exceeds.any():
        return None
    over = np.linspace(levels.min(), levels.max(), POINTS)
    theta, beta = fit(levels, exceeds)
    drawn = np.random.default_rng(SEED).integers(len(levels), size=(RESAMPLES, len(levels)))
    mixed = [chosen for chosen in drawn if 0 < exceeds[chosen].sum() < len(chosen)]
    others = [norm.cdf(np.log(over / median) / spread)
              for median, spread in (fit(levels[chosen], exceeds[chosen]) for chosen in mixed)]  # fmt: skip
    chance = norm.cdf(np.log(over / theta) / beta)
    low, high = np.quantile([chance, *others], TAILS, axis=0)
    return ProbabilityCurve(name=name, coefficient=tuple(map(float, over)), probability=tuple(map(float, chance)),
                 low=tuple(map(float, low)), high=tuple(map(float, high)))  # fmt: skip


KH, SCALE = "slide.kh", "slide.scale"  # by which a study draws what shakes the discs
POINTS = 41  # of a curve
# Times the largest critical Kh where the curves of the block end, and times the median that curves over the peak of a
# record do; they reach the shaking of the section file in any case.
CURVE_END, PEAK_CURVE_END = 1.5, 4.0
SMALLEST_KC = 1e-3  # kc of a block that would never stop otherwise


def failure(table: SampleTable) -> ProbabilityCurve | None:
    """Return P(kc < Kh), the probability of failure; None without a critical Kh."""
    kc = _known(table, "kc")
    if len(kc) < 2:
        return None
    over = np.linspace(0.0, 1.1 * kc.max(), 10 * POINTS)
    return probability("kc < Kh", over, kc[:, None] < over)


def fragility(config: Config, table: SampleTable) -> Iterator[ProbabilityCurve]:
    """Return curves of P(slide > d): of the rigid block over Kh, and over the peak acceleration of the record if there
    is one; of the discs over d, and over their shaking if it is uncertain.
    """
    kc = _known(table, "kc")
    if len(kc) >= 2:
        yield from _blocks(config, np.maximum(kc, SMALLEST_KC))
    for name in table.names:
        if name.endswith("slide_max_m"):
            yield from _discs(config, table, name)


def _discs(config: Config, table: SampleTable, name: str) -> Iterator[ProbabilityCurve]:
    slides, case = _known(table, name), name.split("_")[0].replace("case", "case ")
    if not len(slides):
        return
    over = np.linspace(0.0, 1.1 * max(slides.max(initial=0.0), max(config.study.exceeds)), POINTS)
    levels = _levels(config, table)
    driven = "shaken as drawn" if levels else config.slide.shaking
    yield probability(f"discs, over d: {case}, {driven}", over, slides[:, None] > over)
    for word, drawn in levels.items():
        known = drawn[np.isfinite(table.column(name))]
        fits = (curve(f"discs, {case}, over {word}: slide > {far:g} m", known, slides > far)
                for far in config.study.exceeds)  # fmt: skip
        yield from (fit for fit in fits if fit is not None)


def _levels(config: Config, table: SampleTable) -> dict[str, np.ndarray]:
    """Return the shaking of the discs in every sample, if it is uncertain: Kh, or the peak of their record over g."""
    record = config.slide.accelerogram
    path = SCALE if record else KH
    drawn = config.uncertain.numbers.get(path)
    if drawn is None or drawn.applied_as != "value" or record == AVERAGE:
        return {}
    values = np.array(table.drawn(path), dtype=float)
    if not record:
        return {"Kh": values}
    return {"PGA / g": np.abs(values) * read(Path(record), config.slide.unit, config.slide.component).peak / GRAVITY}


def _blocks(config: Config, kc: np.ndarray) -> Iterator[ProbabilityCurve]:
    drive = block_drive(config)
    over = np.linspace(0.0, max(CURVE_END * float(np.quantile(kc, 0.95)), constant_kh(config)), POINTS)
    slides = np.array([[drive.slide(yield_kh, kh) for kh in over] for yield_kh in kc])
    for far in config.study.exceeds:
        yield probability(f"block, Kh {drive.description}: slide > {far:g} m", over, slides > far)
    if not config.sliding_block.accelerogram:
        return
    record = config.sliding_block.in_use()
    peaks = np.linspace(0.0, max(PEAK_CURVE_END * float(np.median(kc)), record.peak / GRAVITY), POINTS)
    slides = np.array([[_slide_under(record, peak, yield_kh) for peak in peaks] for yield_kh in kc])
    for far in config.study.exceeds:
        yield probability(f"block, {record.name} by PGA / g: slide > {far:g} m", peaks, slides > far)


def _slide_under(record: Accelerogram, peak: float, kc: float) -> float:
    """Return the slide (m) under the record scaled to a peak (g), in the direction with the larger slide."""
    if peak <= kc:
        return 0.0
    scaled = record.acceleration * (peak * GRAVITY / record.peak)
    return max(newmark(record.time, sign * scaled, kc).permanent for sign in (1.0, -1.0))


def block(config: Config, kc: float | None) -> float | None:
    """Return the slide (m) of the rigid block of one sample, under its record or its constant Kh.

    The slide is None without kc, and for a constant Kh without end: the block then is at rest or never stops, and a
    mean over samples has no meaning.
    """
    drive, recorded = block_drive(config), bool(config.sliding_block.accelerogram)
    if kc is None or (not recorded and math.isinf(drive.seconds)):
        return None
    if not recorded:
        return drive.slide(max(kc, SMALLEST_KC), constant_kh(config))
    record = config.sliding_block.in_use()
    return _slide_under(record, record.peak / GRAVITY, max(kc, SMALLEST_KC))


def _known(table: SampleTable, name: str) -> np.ndarray:
    values = table.column(name)
    return values[np.isfinite(values)]
