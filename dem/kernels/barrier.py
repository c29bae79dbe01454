"""Makes threads wait at a barrier, which no thread passes before all threads have reached it (kernel).

The barrier is written with LLVM's atomic instructions, as Numba offers none for the CPU. Waiting threads spin, and now
and then yield the processor, so that they make progress on a busy machine, too. With the JIT switched off there is one
thread and no barrier.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from dem.kernels.device_function import device_function

ARRIVED, ROUND, PROGRESS = 0, 16, 32  # counters, two cache lines apart; of progress, one for each thread
COUNTER_SPACING = 16  # entries between the counters of two threads: two cache lines
SPINS_BEFORE_YIELD = 500  # checks of a counter after which a waiting thread yields the processor


def new_barrier(threads: int) -> np.ndarray:
    """Return the counters that the threads of one run share.

    Parameters
    ----------
    threads : number of threads

    Returns
    -------
    Zeros (PROGRESS + COUNTER_SPACING threads,), integers.
    """
    return np.zeros(PROGRESS + COUNTER_SPACING * threads, np.int64)


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return cgutils.get_item_pointer(
        context, builder, signature.args[0], array, [arguments[1]], wraparound=False, boundscheck=False
    )


@intrinsic
def fetch_add(typing_context: Any, array: Any, index: Any, value: Any) -> Any:
    """Add a number to an entry of an int64 array in one atomic operation, and return the earlier value.

    typing_context: typing context of Numba; array: int64 array; index: index of the entry; value: number that is added.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = _place(context, builder, signature, arguments)
        return builder.atomic_rmw("add", place, arguments[2], "seq_cst")

    return types.int64(array, types.intp, types.int64), generate


@intrinsic
def load(typing_context: Any, array: Any, index: Any) -> Any:
    """Read an entry that other threads write. Everything that the other threads wrote before the entry is visible after
    the read."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load_atomic(_place(context, builder, signature, arguments), "acquire", 8)

    return types.int64(array, types.intp), generate


@intrinsic
def give_way(typing_context: Any) -> Any:
    """Let another thread use this processor (sched_yield of POSIX)."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(ir.IntType(32), []), "sched_yield")
        return builder.call(function, [])

    return types.int32(), generate


@device_function(nogil=True)
def wait(barrier: np.ndarray, threads: int) -> None:
    """Wait until all `threads` have called this function."""
    turn = load(barrier, ROUND)
    if fetch_add(barrier, ARRIVED, 1) == threads - 1:
        fetch_add(barrier, ARRIVED, -threads)
        fetch_add(barrier, ROUND, 1)
        return
    spins = 0
    while load(barrier, ROUND) == turn:
        spins += 1
        if spins % SPINS_BEFORE_YIELD == 0:
            give_way()


@device_function(nogil=True)
def report(barrier: np.ndarray, thread: int) -> None:
    """Count one more finished piece of work of this thread. Everything that the thread wrote before is visible to a
    thread that reads the count.
    """
    fetch_add(barrier, PROGRESS + COUNTER_SPACING * thread, 1)


@device_function(nogil=True)
def wait_for(barrier: np.ndarray, thread: int, count: int) -> None:
    """Wait until `thread` has reported `count` pieces of work."""
    spins = 0
    while load(barrier, PROGRESS + COUNTER_SPACING * thread) < count:
        spins += 1
        if spins % SPINS_BEFORE_YIELD == 0:
            give_way()


@device_function(nogil=True, _nrt=False)
def slices_of(thread: int, threads: int, slices: int) -> tuple[int, int]:
    """Return the first slice of a thread, and the one after its last."""
    return slices * thread // threads, slices * (thread + 1) // threads
