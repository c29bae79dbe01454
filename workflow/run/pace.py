"""How fast this machine is, by a test of a second: times told before a run are those of one machine, scaled by it."""

import time

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

GRID = 110  # points along each side of the grid whose equations are factorised, as finite elements do
REFERENCE = 0.032  # s: the fastest on one core of the machine on which the seconds of stages were measured, a Xeon
SHORT = 30.0  # s: what takes less is not worth a test


def pace(seconds: float = 1.0) -> float:
    """The speed of one core of this machine over that of the one that times were measured on, from so many seconds.

    The fastest of many factorisations counts, so that what else runs does not.
    """
    line = sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(GRID, GRID))
    matrix = sparse.csc_matrix(sparse.kronsum(line, line))
    fastest, end = np.inf, time.perf_counter() + seconds
    while time.perf_counter() < end:
        start = time.perf_counter()
        splu(matrix)
        fastest = min(fastest, time.perf_counter() - start)
    return REFERENCE / float(fastest)


def expected(seconds: float) -> str:
    """How long something takes here that takes so long on the machine of the measurements; empty for little."""
    if seconds < SHORT:
        return ""
    here = pace()
    return (
        f"This takes about {_words(seconds / here)}, give or take a factor of two, if nothing else runs: one "
        f"core does {here:.1f} times what one of the machine did on which times were measured."
    )


def _words(seconds: float) -> str:
    """In tens of seconds, and in whole minutes from three on."""
    return f"{10 * max(1, round(seconds / 10.0))} s" if seconds < 180.0 else f"{round(seconds / 60.0)} min"
