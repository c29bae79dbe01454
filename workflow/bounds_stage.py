"""The stage `bounds`: strict bounds of the critical seismic coefficient, their file and their pictures."""

import json
import math
import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from fem.adaptive_bounds import Bracket
from fem.bounds import kh_bounds
from workflow import bounds_figures
from workflow.settings import Input
from workflow.store import Store

PROXY = (
    "by Davis's substitute for ψ < φ: c and tan φ are reduced and the flow is associated. It is a proxy: its bounds "
    "are strict for the reduced ground, and none of the section's."
)


def bounds_stage(run: Input, store: Store, progress: Callable[[Bracket], None] | None = None) -> dict[str, Any]:
    """Bracket the critical Kh with ψ = φ; leaves fem/bounds.json and figures/bounds_*.png, and returns what the former
    holds. Its verdict is "bracketed", "wide" (no more cells allowed), or "no bracket" (a bound is missing).

    Raises InputError, BadMeshError, and UnstableError if the section is proven to fail under its own weight.
    """
    started = time.perf_counter()
    found = kh_bounds(run, run.fem, run.bounds, progress)
    answer = as_json(run, found, time.perf_counter() - started)
    store.write_text("fem/bounds.json", json.dumps(answer, indent=1, allow_nan=False) + "\n")
    bounds_figures.draw_all(run, found, store)
    return answer


def as_json(run: Input, found: Bracket, seconds: float) -> dict[str, Any]:
    """What fem/bounds.json holds: the bracket first, then how far each bound was checked, then every mesh."""
    verdict, reason = _verdict(run, found)
    return {
        "section": {"name": run.name, "sha256": run.sha256(), "reconstruction": run.reconstruction},
        "lower": found.stress.multiplier if found.stress else None,
        "upper": found.mechanism.multiplier if found.mechanism else None,
        "gap": found.gap if math.isfinite(found.gap) else None,
        "verdict": verdict,
        "reason": reason,
        "words": in_words(found),
        "flow": PROXY if run.bounds.davis else "associated, ψ = φ.",
        "davis": run.bounds.davis,
        "sides": run.fem.sides,
        "direction": run.fem.direction,
        "vertical": run.fem.vertical,
        "cells": found.rounds[-1].cells,
        "seconds": round(seconds, 2),
        "residuals": {
            "lower": asdict(found.stress.check) if found.stress else None,
            "upper": asdict(found.mechanism.check) if found.mechanism else None,
        },
        "history": [asdict(one) for one in found.rounds],
        "settings": run.bounds.model_dump(mode="json"),
    }


def _verdict(run: Input, found: Bracket) -> tuple[str, str]:
    last = "; ".join(found.rounds[-1].notes)
    if not math.isfinite(found.gap):
        missing = " and ".join(
            name for name, bound in (("lower", found.stress), ("upper", found.mechanism)) if bound is None
        )
        return "no bracket", f"there is no {missing} bound on {found.rounds[-1].cells} cells: {last}."
    if found.gap <= run.bounds.gap:
        return "bracketed", f"The gap of {100 * found.gap:.2f} % is below the {100 * run.bounds.gap:g} % asked for."
    wish = f"The gap of {100 * found.gap:.2f} % is above the {100 * run.bounds.gap:g} % asked for"
    return "wide", f"{wish}: {found.rounds[-1].cells} cells, {run.bounds.max_cells} allowed." + (
        f" {last}." * bool(last)
    )


def in_words(found: Bracket) -> str:
    """The bracket as a person reads it."""
    low = f"{found.lower:.4f}" if found.stress else "no lower bound"
    high = f"{found.upper:.4f}" if found.mechanism else "no upper bound"
    gap = f", gap {100 * found.gap:.2f} %" if math.isfinite(found.gap) else ""
    return f"{low} <= Kh <= {high}{gap}, {found.rounds[-1].cells} triangles"


def judged(answer: dict[str, Any], kc: float) -> str:
    """What the bracket in ``answer`` says of a critical Kh that the finite elements found with ψ = φ."""
    lower, upper = answer["lower"], answer["upper"]
    if lower is None or upper is None:
        return f"FEM, ψ = φ: {kc:.4f}; there is no bracket to judge it by"
    where = f"the strict bounds {lower:.4f} and {upper:.4f}"
    if lower <= kc <= upper:
        return f"FEM, ψ = φ: {kc:.4f}, between {where}"
    side, off = ("above", kc / upper - 1.0) if kc > upper else ("below", kc / lower - 1.0)
    return f"FEM, ψ = φ: {kc:.4f}, {side} {where} by {100 * abs(off):.1f} %: the mesh of the elements is too coarse"
