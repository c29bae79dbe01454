"""Provides contact law and constants of a model of discs as arguments of the kernels."""

from typing import Literal

import numpy as np

from dem.engine.memory import large_zeros
from dem.kernels.arguments import Law, Springs
from dem.kernels.contact import KPN
from dem.kernels.transpose import CONSTANT_RECORD
from dem.model import DiscModel

CrackBy = Literal["contact", "pore"]


def law_of(model: DiscModel, pulls: bool = False, crack_by: CrackBy = "contact") -> Law:
    """Return the contact law of a model as an argument of the kernels; pulls and crack_by as in `Engine`.

    In soil discs Fn in equation 16 of the paper is the force of the pore spring alone, since the normal force of the
    contact already contributes to the friction of the contact.
    """
    soil = model.law == "soil"
    pores = bool(model.springs.pairs[KPN].any())
    share = 1.0 if crack_by == "contact" and not soil else 0.0
    return Law(soil, pores, -np.inf if pulls else 0.0, share, model.repeats)


def springs_of(model: DiscModel) -> Springs:
    """Return all constants of the contacts of a model as an argument of the kernels."""
    pairs = model.springs.pairs
    records = large_zeros(pairs.shape[1], CONSTANT_RECORD)
    records[:, : len(pairs)] = pairs.T
    return Springs(pairs, records.reshape(-1), model.springs.lines, model.lines)
