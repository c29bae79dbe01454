"""Who does jobs that do not hang on each other: this process, one after the other, or a team that is handed in.

What they find does not depend on who does them.
"""

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeVar

Given = TypeVar("Given")
Found = TypeVar("Found")

# How a job tells how far it is, in a few plain values.
Tell = Callable[[Any], None]


class Team(Protocol):
    """Does one piece of work on many inputs, in other processes perhaps: work, inputs and results can be pickled."""

    def __call__(
        self,
        work: Callable[[Given, Tell], Found],
        given: Sequence[Given],
        heard: Callable[[int, Any], None] | None = None,
        done: Callable[[int, Found], None] | None = None,
    ) -> list[Found]:
        """What the work makes of every input, in their order.

        ``heard`` is told what a job tells, with the place of its input; ``done`` of every result as it comes. The first
        error of a job is raised, and the others end.
        """


def alone(
    work: Callable[[Given, Tell], Found],
    given: Sequence[Given],
    heard: Callable[[int, Any], None] | None = None,
    done: Callable[[int, Found], None] | None = None,
) -> list[Found]:
    """A team of one: this process."""
    results = []
    for place, one in enumerate(given):

        def tell(message: Any, place: int = place) -> None:
            if heard is not None:
                heard(place, message)

        results.append(work(one, tell))
        if done is not None:
            done(place, results[-1])
    return results
