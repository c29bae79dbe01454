"""What a stage tells while it computes, and how long it still needs."""

from collections.abc import Callable

# A line for people, with the quantity that matters, and the share that is done from 0 to 1, or None if nobody knows.
Progress = Callable[[str, float | None], None]


def silent(_line: str, _share: float | None) -> None:
    """Nobody listens."""


def time_left(elapsed: float, share: float | None) -> float | None:
    """Seconds that are left after ``elapsed`` seconds for a ``share`` of the work; None where nobody can say."""
    if share is None or not 0.0 < share <= 1.0:
        return None
    return elapsed * (1.0 - share) / share


def duration(seconds: float) -> str:
    """A time as people read it: 0.4 s, 12 s, 3 min 20 s, 2 h 5 min."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
