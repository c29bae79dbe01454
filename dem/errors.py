"""What can stop a run: each error names disc, time and place, and says what to do next."""

from meshes.errors import NoAnswerError


class DemError(NoAnswerError):
    """A run of the discs that had to stop.

    Attributes
    ----------
    reason, remedy : str
        What went wrong, and what to do about it.
    """


class StepTooLargeError(DemError, ValueError):
    """The time step asked for is above the stable one."""


class EnergyBalanceError(DemError):
    """The energy balance does not close."""


class OverlapError(DemError):
    """Two discs, or a disc and a line, are deeper in each other than their layers allow."""


class NotFiniteError(DemError):
    """A position or velocity is NaN or infinite."""


class EscapeError(DemError):
    """A disc is behind a rigid line or outside the box."""


class SpeedError(DemError):
    """A disc moves so far in one step that it could pass another without touching it."""


class ConfinementError(DemError):
    """A patch for an element test does not come to rest under its pressure."""
