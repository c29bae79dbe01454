"""Compilation of functions that other kernels alone call.

Numba wraps what it compiles twice, for Python and for C, and compiles the body of a function that is inlined once more
with each of the wrappers. Functions without them take two thirds of the time.
"""

from collections.abc import Callable
from typing import Any

from numba import config, njit


def device_function(**options: Any) -> Callable[[Any], Any]:
    """`njit` without wrappers, and without a file in the cache, since those of its callers hold it."""

    def compiled(function: Any) -> Any:
        made = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)(function)
        if not config.DISABLE_JIT:
            # Python would call a wrapper that is not there: it finds nothing that fits, and is refused
            made._insert = lambda *_, **__: None
            made._compile_for_args = _refuse
        return made

    return compiled


def _refuse(*_: Any, **__: Any) -> None:
    raise TypeError("this function is compiled for other kernels alone: Python cannot call it")
