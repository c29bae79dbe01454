"""Computes the continuum of a sample: critical Kh by finite elements, and its strict bounds."""

from typing import TYPE_CHECKING

from fem.continuum.strength import is_associated
from fem.errors import UnstableError, accepting_no_answer
from fem.limit.bounds import kh_bounds
from fem.search.adaptive import AdaptiveSearch
from fem.search.critical import critical_coefficient
from meshes.errors import NoAnswerError
from meshes.gmsh_model import generate
from workflow.config import Config
from workflow.study.task import Numbers, StudySample

if TYPE_CHECKING:
    from fem.limit_load.limit_load import LimitLoadResult
    from fem.search.critical import CriticalResult
    from meshes.quad_mesh import QuadMesh


def continuum(sample: StudySample) -> Numbers:
    """Return the critical Kh by finite elements; 0 for ground that does not stand without shaking.

    The critical Kh is that with ψ = φ or by Davis's estimate, as ``fem.flow`` says. By both flow rules the critical Kh
    is the limit load on meshes adapted to the mechanism; for non-associated flow it follows from an equilibrium path.
    """
    config = Config.parse(sample.data)
    first = generate(config.section, config.mesh)
    try:
        critical, used = _critical(config, first)
    except UnstableError:
        return Numbers(numbers={"kc": 0.0}, texts={"verdict": "fails under its own weight"})
    if critical.verdict == "undecided":
        raise NoAnswerError(f"the finite elements found no limit load: {critical.reason}")
    texts: dict[str, str] = {"verdict": critical.verdict, "direction": critical.direction, "flow": critical.flow}
    return Numbers(numbers={"kc": critical.kc, "cells": len(used.cells)}, texts=texts)


def _critical(config: Config, first: "QuadMesh") -> "tuple[LimitLoadResult | CriticalResult, QuadMesh]":
    if is_associated(config.section.strata, config.fem.flow):
        search = AdaptiveSearch(config.section, config.mesh, first)
        with accepting_no_answer():
            critical = search.critical(config.fem)
            return critical.result, critical.mesh
    return critical_coefficient(config.section, first, config.fem), first


def bounds(sample: StudySample) -> Numbers:
    """Return strict lower and upper bounds of the critical Kh, ψ = φ."""
    config = Config.parse(sample.data)
    bounds_settings = config.bounds.changed(davis=False)
    try:
        bracket = kh_bounds(config.section, config.fem, bounds_settings)
    except UnstableError:
        return Numbers(numbers={"kc_lower_bound": 0.0, "kc_upper_bound": 0.0})
    return Numbers(numbers={
        "kc_lower_bound": bracket.stress.multiplier if bracket.stress else None,
        "kc_upper_bound": bracket.mechanism.multiplier if bracket.mechanism else None,
    })  # fmt: skip
