"""Prefetches memory, which changes no value and does nothing without the JIT."""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

CACHE_LINE = np.uint64(8)  # doubles in a cache line


@intrinsic
def _prefetch(typing_context: Any, array: Any, index: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        box = context.make_array(signature.args[0])(context, builder, arguments[0])
        place = cgutils.get_item_pointer(
            context, builder, signature.args[0], box, [arguments[1]], wraparound=False, boundscheck=False
        )
        byte = ir.IntType(8).as_pointer()
        flag = ir.IntType(32)
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(ir.VoidType(), [byte, flag, flag, flag]), "llvm.prefetch.p0"
        )
        builder.call(function, [builder.bitcast(place, byte), flag(0), flag(3), flag(1)])
        return context.get_dummy_value()

    return types.none(array, types.uintp), generate


@intrinsic
def wide_vectors(typing_context: Any) -> Any:
    """Vectorise the loops of the calling function at the full width of the processor.

    On processors whose predecessors ran slower with wide vectors, LLVM uses only half the width; these loops gain a
    fifth with the full width.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        # llvmlite keeps a list of attributes that it lets pass; this one is not on it
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.none(), generate


if config.DISABLE_JIT:

    def fetch(array: Any, at: Any) -> None:
        """Do nothing: without the JIT compiler there is no cache line to fetch."""

    def wide_vectors() -> None:
        """Do nothing: without the JIT compiler there is no vector width to choose."""

else:

    @njit(cache=True, nogil=True, forceinline=True)
    def fetch(array: np.ndarray, at: int) -> None:
        """Prefetch the cache line of array[at]; a place past the end does no harm."""
        _prefetch(array, at)
