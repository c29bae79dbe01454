"""The journal of searches for a critical Kh: a line of JSON for each, from which a stopped run goes on."""

import json

from dem.search.calibration import Key
from dem.search.critical import Search
from workflow.run.store import Store


class Journal:
    """Searches that are done, by parameter and factor, in a file of the folder."""

    def __init__(self, store: Store, name: str) -> None:
        self.path = store.folder / name

    def known(self) -> dict[Key, Search]:
        """All searches of the file; a line that was half written when someone pulled the plug is none."""
        found: dict[Key, Search] = {}
        if not self.path.is_file():
            return found
        for line in self.path.read_text(encoding="utf-8").splitlines():
            try:
                entry = json.loads(line)
                found[entry["parameter"], entry["factor"]] = Search.from_json(entry["search"])
            except (ValueError, KeyError):
                continue
        return found

    def add(self, parameter: str, factor: float, search: Search) -> None:
        """One more."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        line = json.dumps({"parameter": parameter, "factor": factor, "search": search.as_json()})
        with self.path.open("a", encoding="utf-8") as file:
            file.write("\n" + line)
