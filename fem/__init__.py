"""The continuum: at which seismic coefficient the section fails, and where.

What a script needs stands here; dolfinx is imported when the finite elements are asked for, and not before.
"""

import importlib
from typing import TYPE_CHECKING, Any

from fem.errors import UnstableError
from fem.settings import BoundsSettings, FemSettings
from meshes.compiled import keep_compiled_kernels

if TYPE_CHECKING:
    from fem.limit.bounds import kh_bounds
    from fem.search.critical import CriticalResult, critical_coefficient
    from fem.search.strength_reduction import SafetyFactor, safety_factor

keep_compiled_kernels()

__all__ = [
    "BoundsSettings",
    "CriticalResult",
    "FemSettings",
    "SafetyFactor",
    "UnstableError",
    "critical_coefficient",
    "kh_bounds",
    "safety_factor",
]

_HOME = {
    "CriticalResult": "fem.search.critical",
    "critical_coefficient": "fem.search.critical",
    "SafetyFactor": "fem.search.strength_reduction",
    "safety_factor": "fem.search.strength_reduction",
    "kh_bounds": "fem.limit.bounds",
}


def __getattr__(name: str) -> Any:
    """Import what was asked for from its own file (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'fem' has no attribute '{name}'")
    return getattr(importlib.import_module(_HOME[name]), name)
