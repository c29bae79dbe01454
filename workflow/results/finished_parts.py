"""Stores the finished parts of a stage, from which a stopped stage continues."""

from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

from pydantic import TypeAdapter, ValidationError

from meshes.executor import Executor, Tell
from workflow.run.store import Store

PartType = TypeVar("PartType")
Input = TypeVar("Input")


class FinishedParts(Generic[PartType]):
    """Stores the parts of a stage in one file each, by their place in the order of the stage.

    The files are leftovers of the stage: they are removed when its input has changed, and when the stage has ended.

    Parameters
    ----------
    store : the folder of the run
    name : beginning of the names of the files, such as "fem/liquefied"
    kind : type of the parts
    """

    def __init__(self, store: Store, name: str, kind: Any) -> None:
        self.store, self.name = store, name
        self.adapter: TypeAdapter[PartType] = TypeAdapter(kind)

    def read(self, place: int) -> PartType | None:
        """Return a stored part; None if it is not stored, or was stored by another version of the program."""
        try:
            return self.adapter.validate_json((self.store.folder / self._file(place)).read_bytes())
        except (OSError, ValidationError):
            return None

    def add(self, place: int, part: PartType) -> None:
        """Store a finished part."""
        with self.store.writing(self._file(place)) as path:
            path.write_bytes(self.adapter.dump_json(part))

    def compute(
        self,
        executor: Executor,
        work: Callable[[Input, Tell], PartType],
        inputs: Sequence[Input],
        heard: Callable[[int, Any], None] | None = None,
        done: Callable[[int, PartType], None] | None = None,
    ) -> list[PartType]:
        """Return the results for all inputs as `Executor.compute` does, stored ones without computing them again.

        ``executor``, ``work``, ``inputs``, ``heard``, ``done``: as there.
        """
        parts = {place: part for place in range(len(inputs)) if (part := self.read(place)) is not None}
        missing = [place for place in range(len(inputs)) if place not in parts]
        for place, part in parts.items():
            if done is not None:
                done(place, part)

        def ended(number: int, part: PartType) -> None:
            self.add(missing[number], part)
            if done is not None:
                done(missing[number], part)

        def message(number: int, text: Any) -> None:
            if heard is not None:
                heard(missing[number], text)

        computed = executor.compute(work, [inputs[place] for place in missing], message, ended)
        parts |= dict(zip(missing, computed, strict=True))
        return [parts[place] for place in range(len(inputs))]

    def remove(self) -> None:
        """Remove the stored parts: the stage has ended."""
        self.store.remove([f"{self.name}_part*.json"])

    def _file(self, place: int) -> str:
        return f"{self.name}_part{place}.json"
