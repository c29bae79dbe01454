"""Defines the errors that stop a run. Each message names disc, time and place, and a remedy."""

from meshes.errors import NoAnswerError


class DemError(NoAnswerError):
    """A run of the discs was stopped by an error.

    Attributes
    ----------
    reason, remedy : str
        Cause of the error in words, and advice on what the user can change.
    """


class StepTooLargeError(DemError, ValueError):
    """The requested time step is larger than the stable time step."""


class EnergyBalanceError(DemError):
    """The energy balance does not close."""


class OverlapError(DemError):
    """Two discs, or a disc and a line, overlap by more than their layers allow."""


class NotFiniteError(DemError):
    """A position or velocity is NaN or infinite."""


class EscapeError(DemError):
    """A disc has passed a rigid line or left the box."""


class SpeedError(DemError):
    """A disc moves so far in one step that it could pass another disc without touching it."""


class ConfinementError(DemError):
    """A patch for an element test does not come to rest under its pressure."""
