"""Controls the threads of BLAS, the library of dense linear algebra of NumPy, SciPy and MUMPS."""

from threadpoolctl import ThreadpoolController

from meshes.executor import SERIAL, Executor, OneThread


def use_one_thread() -> None:
    """Make every loaded BLAS compute with one thread.

    With more threads the order of sums, and so their last bits, would change. The matrices here are too small to gain
    from
    more threads.
    """
    ThreadpoolController().limit(limits=1, user_api="blas")


def bears_threads() -> bool:
    """Return whether several threads may call BLAS concurrently. OpenBLAS built without threads (Debian's
    ``libopenblas0-serial``) then returns wrong results, since the callers share its work space.
    """
    return all(library.get("threading_layer") != "disabled" for library in ThreadpoolController().info())


def one_more_thread(wanted: bool = True) -> Executor:
    """Provide an executor with one more thread, if it is ``wanted`` and BLAS is thread-safe.

    Parameters
    ----------
    wanted : whether tasks may run on another thread

    Returns
    -------
    An executor with one thread; else the serial executor, which runs tasks in the calling thread.
    """
    return OneThread() if wanted and bears_threads() else SERIAL
