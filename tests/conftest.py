"""What holds for all tests: Ctrl-C is heard, no property depends on how busy the machine is, and a third critical Kh is
computed where a test asks for it.
"""

import signal
from collections.abc import Iterator

import pytest
from hypothesis import settings

settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")


def pytest_configure() -> None:
    """Hears Ctrl-C again, here and in every program that a test starts: a shell that runs `make test` in the background
    has told it to ignore that."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True, scope="session")
def only_wanted_third_numbers() -> Iterator[None]:
    """Leave out the critical Kh "about" that of ψ as given unless the settings ask for it: it takes some ten seconds of
    every run of sand, and has tests of its own.
    """
    import fem.search.assessment as assessment

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(assessment, "is_far_apart", lambda settings, *_: settings.own_dilation is True)
        yield
