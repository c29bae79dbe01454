"""Discs taken on in short pulses, between which no more is looked at than where they are and how they move.

To make the layout of a kernel from a model and the model from the layout takes as long as some forty steps of it. What
is driven by what it does, such as ground on the spring of a machine, is looked at more often.
"""

from types import TracebackType

from dem.engine.engine import Engine, EngineRun, largest_step
from dem.model import DiscModel


class Pulses:
    """A model on its way: inside the block its motion is up to date, its contacts only after `whole`.

    No energies are summed. The step is a share of the stable one as it was when the list of neighbours was made.
    """

    def __init__(self, model: DiscModel, share: float, threads: int = 1) -> None:
        model.refresh_list()
        self.model, self.share = model, share
        stable = largest_step(model)
        self.run = EngineRun(Engine(energies=False, threads=threads), model, share * stable.seconds)
        self.run.stable = stable

    def __enter__(self) -> "Pulses":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        self.run.close()

    def on(self, seconds: float) -> None:
        """Takes the model on, by whole steps. Raises DemError."""
        run = self.run
        assert run.stable is not None
        run.dt = min(self.share * run.stable.seconds, seconds)
        run.go(max(1, round(seconds / run.dt)))
        run.show()

    def whole(self) -> None:
        """Gives the model its contacts back; it may be changed then, but for its places."""
        self.run.update()
