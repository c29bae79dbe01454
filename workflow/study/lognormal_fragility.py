"""Fragility P(slide > d) over the intensity of shaking: a lognormal distribution function fitted to the samples."""

import numpy as np
from scipy.optimize import minimize
from scipy.stats import norm

from workflow.results.study import Curve

SPREADS = (0.05, 3.0)  # of the logarithm, that a fit may have: samples that part cleanly would have none
SEED, RESAMPLES = 0, 200
POINTS = 41  # of a curve
TAILS = (0.025, 0.975)


def fit(levels: np.ndarray, exceeds: np.ndarray) -> tuple[float, float]:
    """Median θ and spread β of P = Φ(ln(x / θ) / β), by the greatest likelihood.

    M. Shinozuka et al., J. Eng. Mech. 126 (2000) 1224-1231; J. W. Baker, Earthquake Spectra 31 (2015) 579-599, eq. 11.
    ``levels`` (n,) are above 0, ``exceeds`` (n,) true or false, both of which occur.
    """
    logarithms = np.log(levels)

    def unlikely(guess: np.ndarray) -> float:
        z = (logarithms - guess[0]) / guess[1]
        return -float(np.where(exceeds, norm.logcdf(z), norm.logsf(z)).sum())

    within = [(logarithms.min() - 3.0, logarithms.max() + 3.0), SPREADS]
    first = np.array([float(np.clip(logarithms.mean(), *within[0])), 0.4])
    optimum = minimize(unlikely, first, bounds=within, method="L-BFGS-B")
    return float(np.exp(optimum.x[0])), float(optimum.x[1])


def curve(name: str, levels: np.ndarray, exceeds: np.ndarray) -> Curve | None:
    """The fit as a curve with its 95 % interval by bootstrap; None where all samples exceed, or none does."""
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
    return Curve(name=name, over=tuple(map(float, over)), chance=tuple(map(float, chance)),
                 low=tuple(map(float, low)), high=tuple(map(float, high)))  # fmt: skip
