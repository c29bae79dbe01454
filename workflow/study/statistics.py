"""Computes statistics of a table of samples: probabilities with intervals, and effects of uncertain numbers."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.stats import sobol_indices, spearmanr

from workflow.results.study import Z95, Effect, ProbabilityCurve
from workflow.study.table import SampleTable

BOOTSTRAP_SEED, RESAMPLES = 0, 400


def probability(name: str, over: np.ndarray, happens: np.ndarray) -> ProbabilityCurve:
    """Return a probability curve: the share of true values in ``happens`` (samples, len(over)) at each value of
    ``over``.

    The interval follows E. B. Wilson, Probable inference, J. Am. Stat. Assoc. 22 (1927) 209-212. The formula holds for
    independent samples; samples of a Sobol' sequence or a Latin hypercube are more accurate.
    """
    n = len(happens)
    share = happens.mean(axis=0)
    middle = (share + Z95**2 / (2 * n)) / (1.0 + Z95**2 / n)
    half = Z95 / (1.0 + Z95**2 / n) * np.sqrt(share * (1.0 - share) / n + Z95**2 / (4 * n**2))
    return ProbabilityCurve(
        name=name,
        coefficient=tuple(map(float, over)),
        probability=tuple(map(float, share)),
        low=tuple(map(float, np.clip(middle - half, 0.0, 1.0))),
        high=tuple(map(float, np.clip(middle + half, 0.0, 1.0))),
    )


def effects(table: SampleTable, name: str, words: Sequence[str], indices: bool) -> tuple[Effect, ...]:
    """Return the effects of the uncertain numbers on a result, the strongest first.

    ``words`` are the paths whose values have no order. With ``indices`` the samples are of the method "saltelli"; then
    Sobol' indices are computed if no sample is missing. ``table``: table of all samples; ``name``: name of the result.
    """
    values = table.column(name)
    there = np.isfinite(values)
    paths = list(table.units)
    indices_of = _sobol(values, len(paths)) if indices and there.all() else {}
    several = there.sum() > 2 and np.ptp(values[there]) > 0.0
    effects = [
        Effect(
            path=path,
            correlation=_correlation(table.drawn(path), values, there, path in words) if several else None,
            **indices_of.get(place, {}),
        )
        for place, path in enumerate(paths)
    ]
    return tuple(sorted(effects, key=_strength, reverse=True))


def _strength(effect: Effect) -> float:
    """Return the size of the total index of an effect or, without an index, of its correlation."""
    return abs(effect.total_order if effect.total_order is not None else effect.correlation or 0.0)


def _correlation(drawn: Sequence[Any], values: np.ndarray, there: np.ndarray, words: bool) -> float | None:
    """Return Spearman's rank correlation. For words, return the correlation ratio, the root of the share of variance
    between categories.
    """
    used = [value for value, use in zip(drawn, there, strict=True) if use]
    if len(set(map(str, used))) < 2:
        return None
    if not words:
        return float(spearmanr(np.array(used, dtype=float), values[there]).statistic)
    groups = np.unique(list(map(str, used)), return_inverse=True)[1]
    means = np.array([values[there][groups == k].mean() for k in range(groups.max() + 1)])[groups]
    return float(np.std(means) / np.std(values[there]))


def _sobol(values: np.ndarray, dimensions: int) -> dict[int, dict[str, Any]]:
    """Return Sobol' indices of first order and total, with intervals by bootstrap, from samples of the method
    "saltelli".

    scipy.stats.sobol_indices with the estimators of Saltelli et al., Comput. Phys. Commun. 181 (2010) 259-270.
    """
    if np.ptp(values) == 0.0:
        return {}
    count = len(values) // (dimensions + 2)
    parts = values.reshape(dimensions + 2, 1, count)
    first, total = _indices(parts, np.arange(count))
    drawn = np.random.default_rng(BOOTSTRAP_SEED).integers(count, size=(RESAMPLES, count))
    again = np.array([_indices(parts, chosen) for chosen in drawn])
    (first_low, total_low), (first_high, total_high) = np.quantile(again, (0.025, 0.975), axis=0)
    return {
        k: {
            "first_order": float(first[k]), "first_order_ci95": (float(first_low[k]), float(first_high[k])),
            "total_order": float(total[k]), "total_order_ci95": (float(total_low[k]), float(total_high[k])),
        }
        for k in range(dimensions)
    }  # fmt: skip


def _indices(parts: np.ndarray, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first-order and total indices (d,) from a subset of the samples; the bootstrap of scipy takes no
    seed."""
    selected = parts[:, :, chosen]
    indices = sobol_indices(func={"f_A": selected[0], "f_B": selected[1], "f_AB": selected[2:]}, n=len(chosen))
    return np.ravel(indices.first_order), np.ravel(indices.total_order)
