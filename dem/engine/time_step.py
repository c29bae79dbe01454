"""Computes the largest stable time step of a model."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dem.engine.checks import step_at_speed
from dem.engine.packer import springs_of
from dem.kernels.stable_step import Bodies, LineContacts, Pairs, stable_step
from dem.liquefied_ground import longest_look
from dem.model import DiscModel


@dataclass(frozen=True)
class StableStep:
    """Holds the largest stable time step (s) and the disc that limits it (-1 without contacts)."""

    seconds: float
    disc: int


def largest_step(model: DiscModel) -> StableStep:
    """Return the largest stable time step of a model in its present state.

    The step is the smallest of three: the bound of `stable_step` for contacts, `longest_look` for the pairs of
    liquefied ground, and `step_at_speed` for fast discs.

    Parameters
    ----------
    model : discs with a neighbour list for their present positions

    Returns
    -------
    The step (s), infinite if nothing limits it, and the disc that limits it.
    """
    return step_finder(model)()


def step_finder(model: DiscModel, enough: float = np.inf) -> Callable[[], StableStep]:
    """Return a function that computes the largest stable time step of a model in its present state. The function may
    run while the layout is made. It may return a smaller step if that is at least `enough` (s), which takes less time.
    """
    invmass = np.where(model.fixed, 0.0, 1.0 / model.mass)
    bodies = Bodies(model.x, model.z, model.radius, invmass, invmass * model.inertia_ratio)
    i, j, length = model.pair_i, model.pair_j, model.pore_length
    lines = LineContacts(model.line_disc, model.line_id, model.line_kind)
    springs = springs_of(model)

    def find() -> StableStep:
        pairs = Pairs(i, j, model.kind(i, j), length)
        seconds, disc = stable_step(bodies, pairs, model.skin, lines, springs, model.repeats, enough)
        limits = ((float(seconds), int(disc)), longest_look(model), step_at_speed(model))
        return StableStep(*min(limits, key=lambda limit: limit[0]))

    return find
