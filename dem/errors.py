"""What can stop a run: each error names disc, time and place, and says what to do next."""


class DemError(RuntimeError):
    """A run of the discs that cannot be trusted from here on."""


class StepTooLarge(DemError, ValueError):
    """The time step asked for is above the stable one."""


class EnergyImbalance(DemError):
    """Energy came from nowhere or went nowhere."""


class OverlapTooLarge(DemError):
    """Two discs, or a disc and a line, are deeper in each other than their layers allow."""


class NotFinite(DemError):
    """A position or velocity is NaN or infinite."""


class DiscEscaped(DemError):
    """A disc is behind a rigid line or outside of all that is bounded."""


class DiscTooFast(DemError):
    """A disc moves so far in one step that it could pass another without touching it."""
