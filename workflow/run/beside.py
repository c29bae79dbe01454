"""Stages that run beside others, in a process of the team: nobody waits for them but who tells of all."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from threading import Event, Thread
from typing import Any, Protocol, runtime_checkable

from dem.team import Tell, alone
from workflow.run.errors import NoAnswerError
from workflow.run.progress import Progress, silent
from workflow.run.stage import Job, Stage


@runtime_checkable
class TeamBeside(Protocol):
    """A team whose processes can do one job while this process goes on."""

    @property
    def several(self) -> bool:
        """Whether there is more than one process."""

    def hire(self) -> None:
        """Start the processes, if there are none yet."""

    def beside(
        self, work: Callable[[Any, Tell], Any], given: Any, heard: Callable[[int, Any], None], stop: Event
    ) -> Any:
        """What the work makes of its input; raises its error, and StoppedError soon after ``stop`` is set.

        Called in a thread of its own.
        """


@dataclass(eq=False)
class Beside:
    """The stages that run beside others.

    Attributes
    ----------
    team: who does them; None where nobody can.
    stop: set when the run ends without them.
    threads: one for each of them.
    errors: what ended them, other than that there is no answer.
    """

    team: TeamBeside | None
    stop: Event = field(default_factory=Event)
    threads: list[Thread] = field(default_factory=list)
    errors: list[BaseException] = field(default_factory=list)

    @classmethod
    def of(cls, job: Job) -> "Beside":
        """With the team of a job, where that can; ranks of MPI do not hire."""
        team = job.team if isinstance(job.team, TeamBeside) and job.team.several and job.ranks is None else None
        return cls(team)

    def begin(self, stage: Stage, job: Job, progress: Progress, ended: Callable[[NoAnswerError | None], None]) -> None:
        """Let a stage work in another process; ``ended`` is called in a thread, with why there is no answer."""
        team = self.team
        assert team is not None
        team.hire()
        given = stage.work, replace(job, stages=(), progress=silent, team=alone)

        def follow() -> None:
            failure = None
            try:
                try:
                    team.beside(_worked, given, lambda _, told: progress(*told), self.stop)
                except NoAnswerError as error:
                    failure = error
                if not self.stop.is_set():
                    ended(failure)
            except BaseException as error:
                self.errors.append(error)

        self.threads.append(Thread(target=follow, name=stage.name, daemon=True))
        self.threads[-1].start()

    def look(self) -> None:
        """Raise the error of one that has ended with one."""
        if self.errors:
            raise self.errors[0]

    def wait(self) -> None:
        """Wait for all of them; raises the first error."""
        for thread in self.threads:
            while thread.is_alive():
                thread.join(0.2)  # so that Ctrl-C is heard
                self.look()
        self.threads.clear()
        self.look()

    def leave(self) -> None:
        """End those that still run, without their results."""
        self.stop.set()
        for thread in self.threads:
            thread.join()


def _worked(given: tuple[Callable[[Job], None], Job], tell: Tell) -> None:
    """A stage's work, in the process that does it."""
    work, job = given
    work(replace(job, progress=lambda line, share: tell((line, share))))
