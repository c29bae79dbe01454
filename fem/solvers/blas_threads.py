"""BLAS, through which NumPy, SciPy and MUMPS do their dense algebra."""

from threadpoolctl import ThreadpoolController

from meshes.executor import SERIAL, Executor, OneThread


def use_one_thread() -> None:
    """Let every BLAS that is loaded compute with one thread: with more, sums come in another order and have other bits.

    The matrices here are too small to gain by more.
    """
    ThreadpoolController().limit(limits=1, user_api="blas")


def bears_threads() -> bool:
    """Whether several threads may call BLAS at once: OpenBLAS without threads of its own (Debian's
    ``libopenblas0-serial``) shares its work space among them and returns wrong results then."""
    return all(library.get("threading_layer") != "disabled" for library in ThreadpoolController().info())


def one_more_thread(wanted: bool = True) -> Executor:
    """An executor with one more thread, where it is wanted and BLAS is thread-safe."""
    return OneThread() if wanted and bears_threads() else SERIAL
