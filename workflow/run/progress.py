"""Measures the progress of a stage and the time left, and determines how much of it is printed."""

import math
from collections.abc import Callable
from enum import Enum

# A line with the essential quantity, and the finished share from 0 to 1, or None if it is unknown.
Progress = Callable[[str, float | None], None]


def silent(_line: str, _share: float | None) -> None:
    """Ignore progress; where nobody listens to it.

    Parameters
    ----------
    _line, _share : activity, and the finished share from 0 to 1 or None
    """


class Verbosity(Enum):
    """Names how much a command prints.

    Attributes
    ----------
    QUIET : only errors
    NORMAL : sentences and progress
    VERBOSE : every step, too
    JSON : the answers as JSON
    """

    QUIET, NORMAL, VERBOSE, JSON = range(4)

    @classmethod
    def of(cls, quiet: bool, verbose: bool, json: bool) -> "Verbosity":
        """Return the verbosity by options of the command line: --json before --quiet, --quiet before --verbose."""
        return cls.JSON if json else cls.QUIET if quiet else cls.VERBOSE if verbose else cls.NORMAL

    @property
    def in_sentences(self) -> bool:
        """Return whether a command prints sentences."""
        return self in (Verbosity.NORMAL, Verbosity.VERBOSE)


class TimeLeft:
    """Estimates the remaining time of a stage, which never rises.

    The time is extrapolated from the finished share at constant speed. Work is reported in pieces: during a piece the
    share is constant, and the remaining time counts down. If a piece takes longer than expected, the remaining time is
    constant, as a lower bound, until the piece is finished. The time before the first report, in which kernels are
    compiled and meshes are made, is left out of the speed if the first reported share is below `FIRST_SHARE`. No time
    is shown until a further share of `FIRST_SHARE` is finished.

    Parameters
    ----------
    start : start of the stage (s), on the clock that the methods are called with
    """

    FIRST_SHARE = 0.03

    SMALLEST_ESTIMATE = 0.5  # reported time over that by the elapsed time alone, at least
    LOWER_BOUND_RATIO = 1.5  # of the time by the elapsed time to the reported one, from which this is a lower bound

    def __init__(self, start: float) -> None:
        self.start, self.share, self.end = start, 0.0, math.inf
        self.share_at_start: float | None = None  # share that was finished at the start
        self.shown = math.inf

    def seconds(self, now: float, share: float | None) -> float | None:
        """Return the remaining time (s) at a time ``now`` (s) when a share of the work is finished; None if unknown."""
        if share is None:
            return None
        if self.share_at_start is None and share > 0.0:
            self.share_at_start = share if share < self.FIRST_SHARE else 0.0
            self.start = now if self.share_at_start else self.start
        if not self.FIRST_SHARE + (self.share_at_start or 0.0) <= share <= 1.0:
            return None
        plain = self._plain(now, share)
        if share > self.share:
            self.share, self.end = share, now + plain
        self.shown = min(self.shown, max(self.end - now, self.SMALLEST_ESTIMATE * plain))
        return self.shown

    def description(self, now: float, share: float | None) -> str:
        """Return the remaining time in words, such as "2 min 5 s left"; empty if unknown."""
        left = self.seconds(now, share)
        if left is None or share is None:
            return ""
        bound = "more than " if self._plain(now, share) > self.LOWER_BOUND_RATIO * left else ""
        return f"{bound}{duration(left)} left"

    def _plain(self, now: float, share: float) -> float:
        return (now - self.start) * (1.0 - share) / (share - (self.share_at_start or 0.0))


class SearchShare:
    """Computes the finished share of several searches from the number of trials.

    A search is expected to take as many trials as the finished ones took on average.

    Parameters
    ----------
    searches : expected number of searches
    usual : number of trials that a search is expected to take until the first search has finished
    """

    ALMOST = 0.9  # of a search that takes longer than the others did

    def __init__(self, searches: int, usual: int = 8) -> None:
        """Begin before the first trial of the first search."""
        self.searches, self.usual = searches, usual
        self.trials, self.done, self.trials_before = 0, 0, 0

    def after_trial(self, done: int) -> float:
        """Return the finished share of all searches, below 1, after one more trial, with ``done`` finished searches."""
        if done > self.done:
            self.done, self.trials_before = done, self.trials
        self.trials += 1
        usual = self.trials_before / self.done if self.done else self.usual
        return min(0.99, (done + min(self.ALMOST, (self.trials - self.trials_before) / usual)) / self.searches)


def duration(seconds: float) -> str:
    """Return a time in words: 0.4 s, 12 s, 3 min 20 s, 2 h 5 min.

    Parameters
    ----------
    seconds : time (s)

    Returns
    -------
    The time, to 0.1 s below 10 s, to 1 s below an hour, else in whole minutes.
    """
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
