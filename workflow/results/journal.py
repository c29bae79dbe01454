"""Stores finished searches for a critical Kh in a journal, one line of JSON for each, from which a stopped run
continues."""

import math
from dataclasses import fields
from typing import Any

from pydantic import Field, ValidationError

from dem.search.calibrator import Key
from dem.search.critical import Search
from dem.search.equilibrium import Trial
from workflow.results.answer import Part
from workflow.results.discs import DiscSearch, KhTrial
from workflow.run.store import Store


class JournalEntry(Part):
    """Holds the search for the critical Kh with one factor on one parameter of the discs."""

    parameter: str = Field(
        description="constants of the discs that the factor multiplies; empty for uncalibrated discs"
    )
    factor: float = Field(description="the factor")
    search: DiscSearch = Field(description="the search for the critical Kh")

    @property
    def as_search(self) -> Search:
        """Return the stored search so that a run can continue the search."""
        values = {field.name: getattr(self.search, field.name) for field in fields(Search)}
        trials = [_trial(trial) for trial in self.search.trials]
        return Search(**{**values, "trials": trials, "curve": list(self.search.curve)})


def _trial(stored: KhTrial) -> Trial:
    """Return the stored trial, with infinity for unknown numbers."""
    values: dict[str, Any] = {name: math.inf if value is None else value for name, value in stored}
    return Trial(**values)


class Journal:
    """Stores finished searches, by parameter and factor, in a file of the folder.

    Parameters
    ----------
    store : the folder of the run
    name : file within the folder, such as "dem/trials.jsonl"
    """

    def __init__(self, store: Store, name: str) -> None:
        self.path = store.folder / name

    def known(self) -> dict[Key, Search]:
        """Return all searches of the file; an incomplete last line is ignored."""
        searches: dict[Key, Search] = {}
        if not self.path.is_file():
            return searches
        for line in self.path.read_text(encoding="utf-8").splitlines():
            try:
                entry = JournalEntry.model_validate_json(line)
            except ValidationError:
                continue
            searches[entry.parameter, entry.factor] = entry.as_search
        return searches

    def add(self, parameter: str, factor: float, search: Search) -> None:
        """Add a search to the file."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        line = JournalEntry(
            parameter=parameter, factor=factor, search=DiscSearch.model_validate(search)
        ).model_dump_json()
        with self.path.open("a", encoding="utf-8") as file:
            file.write("\n" + line)
