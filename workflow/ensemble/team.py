"""The team of a run: Dask's workers do the jobs that its stages hand out."""

import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from threading import Event
from typing import Any, Generic

from dem.team import Found, Given, Tell, alone
from workflow.ensemble.workers import Workers, hired

LISTEN = 0.5  # s between two chances for Ctrl-C where nothing is heard


class Crew:
    """A team of processes, which are started when there is first more than one job; made by `crew`."""

    def __init__(self, count: int, held: ExitStack) -> None:
        self.count, self.held = count, held
        self.workers: Workers | None = None

    def __call__(
        self,
        work: Callable[[Given, Tell], Found],
        given: Sequence[Given],
        heard: Callable[[int, Any], None] | None = None,
        done: Callable[[int, Found], None] | None = None,
    ) -> list[Found]:
        """See `dem.team.Team`. A worker that dies costs its job a second try; the error of a job is raised."""
        if self.count < 2 or len(given) < 2:
            return alone(work, given, heard, done)
        self.hire()
        return self._shared(work, given, heard, done)

    @property
    def several(self) -> bool:
        """Whether there is more than one process."""
        return self.count > 1

    def hire(self) -> None:
        """Start the processes, if there are none yet."""
        if self.workers is None:
            self.workers = self.held.enter_context(hired(self.count))

    def beside(
        self,
        work: Callable[[Given, Tell], Found],
        given: Given,
        heard: Callable[[int, Any], None],
        stop: Event,
    ) -> Found:
        """One job, while this process goes on; see `workflow.run.beside.TeamBeside`."""
        return self._shared(work, [given], heard, None, stop)[0]

    def _shared(
        self,
        work: Callable[[Given, Tell], Found],
        given: Sequence[Given],
        heard: Callable[[int, Any], None] | None,
        done: Callable[[int, Found], None] | None,
        stop: Event | None = None,
    ) -> list[Found]:
        workers = self.workers
        assert workers is not None
        client, topic = workers.client, f"noshiro-{uuid.uuid4()}"
        news: SimpleQueue[tuple[int, Any]] = SimpleQueue()
        client.subscribe_topic(topic, lambda event: news.put(event[1]))
        futures = [client.submit(_do, Job(work, one, place, topic), pure=False) for place, one in enumerate(given)]
        for place, future in enumerate(futures):
            future.add_done_callback(lambda _, place=place: news.put((place, DONE)))
        results: dict[int, Found] = {}
        try:
            while len(results) < len(given):
                if stop is not None and stop.is_set():
                    raise StoppedError
                try:
                    place, message = news.get(timeout=LISTEN)
                except Empty:
                    continue
                if message != DONE:
                    if heard is not None:
                        heard(place, message)
                    continue
                results[place] = workers.result(futures[place])
                if done is not None:
                    done(place, results[place])
        finally:
            client.cancel(futures)
            client.unsubscribe_topic(topic)
        return [results[place] for place in range(len(given))]


class StoppedError(RuntimeError):
    """A job beside others that was left."""


DONE = "done"  # of a job, beside the plain values that it tells


@dataclass(frozen=True)
class Job(Generic[Given, Found]):
    """What a worker is sent: a piece of work, its input, the place of that, and under which topic it tells."""

    work: Callable[[Given, Tell], Found]
    given: Given
    place: int
    topic: str


def _do(job: Job[Given, Found]) -> Found:
    from distributed import get_worker

    worker = get_worker()
    return job.work(job.given, lambda message: worker.log_event(job.topic, (job.place, message)))


@contextmanager
def crew(count: int) -> Iterator[Crew]:
    """A team of so many processes of this machine, until the end of the block."""
    with ExitStack() as held:
        yield Crew(count, held)
