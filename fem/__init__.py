"""Analyses the ground as a continuum: at which seismic coefficient the section fails, and where.

This package exports the names that a script needs, and imports dolfinx only when the finite elements are used.
"""

import os
from typing import TYPE_CHECKING

from meshes.compiled import keep_compiled_kernels
from meshes.exports import exports

if TYPE_CHECKING:
    from fem.errors import UnstableError
    from fem.limit.bounds import kh_bounds
    from fem.search.critical import CriticalResult, critical_coefficient
    from fem.search.strength_reduction import SafetyFactor, safety_factor
    from fem.settings import BoundsSettings, FemSettings, usual_sides

# PETSc ends a program at a broken pipe, such as the pipe to a worker process that has died, which Python raises as an
# error, and hides where a program crashed. This option leaves signals to Python.
_KEEP_HANDLERS = "-no_signal_handler"
if _KEEP_HANDLERS not in (_options := os.environ.get("PETSC_OPTIONS", "")):
    os.environ["PETSC_OPTIONS"] = f"{_options} {_KEEP_HANDLERS}".strip()
keep_compiled_kernels()
__all__, __getattr__ = exports(__name__, __file__)
