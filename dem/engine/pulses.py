"""Runs discs in many short sections, between which only positions and velocities are read.

Conversion of a model into the layout of the kernels and back takes as long as some forty steps. In displacement control
the load depends on the motion, and so positions are read more often than every forty steps.
"""

from types import TracebackType

from dem.engine.engine import Engine, EngineRun
from dem.engine.time_step import largest_step
from dem.model import DiscModel


class ShortRuns:
    """Runs discs in short sections, as a context manager.

    Inside the ``with`` block, positions and velocities of the model are current, but its contacts only after a call of
    `whole`. The energy balance is not computed in short sections.

    Parameters
    ----------
    model : discs, which are changed
    share : time step over the stable step at the time when the neighbour list was made, at most
    threads : number of threads of the engine
    """

    def __init__(self, model: DiscModel, share: float, threads: int = 1) -> None:
        model.refresh_list()
        self.model, self.share = model, share
        stable = largest_step(model)
        self.run = EngineRun(Engine(energies=False, threads=threads), model, share * stable.seconds)
        self.run.stable, self.run.share = stable, share

    def __enter__(self) -> "ShortRuns":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        self.run.close()

    def on(self, seconds: float) -> None:
        """Advance the model by some seconds, in whole steps. Raises DemError."""
        run = self.run
        assert run.stable is not None
        run.dt = min(self.share * run.stable.seconds, seconds)
        run.go(max(1, round(seconds / run.dt)))
        run.show()

    def whole(self) -> None:
        """Write the contacts back into the model, which may then be changed, except for positions."""
        self.run.update()
