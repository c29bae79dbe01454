"""Draws samples of the uncertain numbers: equal seeds give equal samples on any number of computers."""

import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from workflow.uncertain.limits import AdmissibleRange
from workflow.uncertain.settings import SamplingMethod, StudySettings, UncertainSettings

SMALLEST_PROBABILITY = 2.0**-54  # a probability of zero would be infinitely far from the median


def probabilities(dimensions: int, count: int, method: SamplingMethod, seed: int) -> np.ndarray:
    """Return points (n, dimensions) in the unit cube.

    "sobol": the first ``count`` points of a scrambled sequence (Owen 1998), which a longer study continues. "latin": a
    Latin hypercube (McKay, Beckman and Conover 1979). "saltelli": for Sobol' indices, ``count`` points A, as many
    points B, and for each dimension A with that column taken from B (Saltelli et al. 2010). ``method``: one of these
    methods; ``seed``: seed of the random numbers.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of counts that are no power of two
        if method == "latin":
            drawn = qmc.LatinHypercube(dimensions, seed=seed).random(count)
        elif method == "sobol":
            drawn = qmc.Sobol(dimensions, bits=53, seed=seed).random(count)
        else:
            both = qmc.Sobol(2 * dimensions, bits=53, seed=seed).random(count)
            a, b = both[:, :dimensions], both[:, dimensions:]
            mixed = [np.where(np.arange(dimensions) == k, b, a) for k in range(dimensions)]
            drawn = np.concatenate([a, b, *mixed])
    return np.clip(drawn, SMALLEST_PROBABILITY, 1.0 - SMALLEST_PROBABILITY)


def correlated(points: np.ndarray, correlation: np.ndarray) -> np.ndarray:
    """Return the correlated probabilities (n, d) by a Gaussian copula; each stays uniform."""
    if np.array_equal(correlation, np.eye(len(correlation))):
        return points
    normal = ndtri(points) @ np.linalg.cholesky(correlation).T
    return np.clip(np.asarray(ndtr(normal)), SMALLEST_PROBABILITY, 1.0 - SMALLEST_PROBABILITY)


def samples(
    uncertain: UncertainSettings, study: StudySettings, reach: Mapping[str, AdmissibleRange] = MappingProxyType({})
) -> list[dict[str, Any]]:
    """Draw the samples of a study; equal seeds give equal samples.

    Parameters
    ----------
    uncertain : distributions of numbers by their paths, and their correlation
    study : number, method and seed of the samples
    reach : admissible range of each distribution by path, see `reach_of`; missing distributions are not truncated

    Returns
    -------
    Drawn values by path, for every sample. The method "saltelli" draws ``samples`` times 2 + the number of paths.
    """
    numbers = uncertain.numbers
    points = probabilities(len(numbers), study.samples, study.method, study.seed)
    points = correlated(points, uncertain.correlation())
    return [
        {
            path: distribution.at(reach.get(path, AdmissibleRange()).within(float(probability)))
            for (path, distribution), probability in zip(numbers.items(), row, strict=True)
        }
        for row in points
    ]
