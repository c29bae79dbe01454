"""Compiles functions that are only called by other kernels.

Numba adds two wrappers to every compiled function, for Python and for C, and compiles the body of an inlined function
again with each wrapper. Compilation without wrappers takes two thirds of the time.
"""

from collections.abc import Callable
from typing import Any

from numba import config, njit


def device_function(**options: Any) -> Callable[[Any], Any]:
    """Compile with `njit` without wrappers, and without a file in the cache, since the cached files of its callers
    contain the function.
    """

    def compiled(function: Any) -> Any:
        made = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)(function)
        if not config.DISABLE_JIT:
            # Python would call a wrapper that is not there: it finds nothing that fits, and is refused
            made._insert = lambda *_, **__: None
            made._compile_for_args = _refuse
        return made

    return compiled


def _refuse(*_: Any, **__: Any) -> None:
    raise TypeError("this function is compiled only for other kernels: Python cannot call it")
