"""What holds for all tests: Ctrl-C is heard, and no property depends on how busy the machine is."""

import gc
import os
import signal

import pytest
from hypothesis import settings

# Before NumPy is imported, here and in every program that a test starts: threads of BLAS spin while they wait for each
# other, and beside other tests the inverse of a matrix of two rows takes milliseconds for microseconds.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Hardly anything that is made while modules are imported is garbage; to look for it takes a quarter of the time.
gc.disable()

settings.register_profile("gate", deadline=None, max_examples=20)
settings.register_profile("long studies", deadline=None, max_examples=100)


def pytest_configure(config: pytest.Config) -> None:
    """Hears Ctrl-C again, here and in every program that a test starts: a shell that runs `make test` in the background
    has told it to ignore that. Properties are tried on more examples where the long studies run, too."""
    settings.load_profile("gate" if config.option.markexpr == "not slow" else "long studies")
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """Leaves out modules and tests, a million objects, when Python looks for garbage: a tenth of the time of tests."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)
    gc.enable()
