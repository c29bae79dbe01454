"""Records the stages of a run: inputs, outcome and files of each, and the options of the command line for its mesh.

Commands after `noshiro mesh --refine 2` use the same mesh; section.toml of the folder has the resulting settings.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from workflow.run.store import Store

NAME = ".noshiro/stages.json"
VERSION = 3

Outcome = Literal["begun", "done", "part", "no answer"]
MESH_OPTIONS = ".noshiro/mesh_options.json"


@dataclass(frozen=True)
class Entry:
    """Holds the outcome of one stage.

    Attributes
    ----------
    inputs : fingerprints of all inputs, by names for messages.
    outcome : "begun" while it runs and after it was killed, "part" if only a part of it was requested.
    reason : reason why there is no answer.
    remedy : advice on what the user can change.
    seconds : duration of the stage (s).
    ended : date and time at which the stage ended.
    files : sizes (bytes) of the files with the results of the stage.
    pictures : names of the pictures of the stage.
    title : fingerprint of the title of the pictures; empty until they are drawn.
    """

    inputs: dict[str, str]
    outcome: Outcome
    reason: str = ""
    remedy: str = ""
    seconds: float = 0.0
    ended: str = ""
    files: dict[str, int] = field(default_factory=dict)
    pictures: list[str] = field(default_factory=list)
    title: str = ""


class Record:
    """Holds the entries of all stages, which are kept in one small file that is replaced as a whole.

    Parameters
    ----------
    store : folder of the run. If it has no record that can be read, there are no entries, and every stage runs.

    Attributes
    ----------
    entries : entries by names of stages
    outdated : stages of which another version of noshiro kept an entry
    """

    def __init__(self, store: Store) -> None:
        self.store = store
        self.entries: dict[str, Entry] = {}
        self.outdated: frozenset[str] = frozenset()  # stages of which another version of noshiro kept an entry
        try:
            data = json.loads((store.folder / NAME).read_text(encoding="utf-8"))
            if data["version"] == VERSION:
                self.entries = {name: Entry(**entry) for name, entry in data["stages"].items()}
            else:
                self.outdated = frozenset(data["stages"])
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            self.entries = {}  # not there, or nothing that noshiro wrote: every stage runs

    def __getitem__(self, name: str) -> Entry | None:
        return self.entries.get(name)

    def put(self, name: str, entry: Entry) -> None:
        """Store an entry; it is on disk when the function returns."""
        self.entries[name] = entry
        self.outdated -= {name}
        stages: Mapping[str, object] = {key: asdict(value) for key, value in self.entries.items()}
        self.store.write_json(NAME, {"version": VERSION, "stages": stages})

    def left(self, name: str) -> bool:
        """Return whether all files with the results of a stage exist at their full size."""
        entry = self.entries[name]
        return all(_size(self.store, file) == size for file, size in entry.files.items())

    def pictures_left(self, name: str) -> bool:
        """Return whether all pictures of a stage exist."""
        return all(self.store.has(file) for file in self.entries[name].pictures)


def sizes(store: Store, names: list[str]) -> dict[str, int]:
    """Return the size (bytes) of every file."""
    return {name: _size(store, name) for name in names}


def _size(store: Store, name: str) -> int:
    try:
        return (store.folder / name).stat().st_size
    except OSError:
        return -1


def stored_mesh_options(store: Store) -> dict[str, Any]:
    """Return the stored options of the mesh command.

    Parameters
    ----------
    store : folder of the run

    Returns
    -------
    Settings of [mesh] by their names; empty without stored options.
    """
    options = store.read_json(MESH_OPTIONS) if store.has(MESH_OPTIONS) else {}
    return options if isinstance(options, dict) else {}


def keep_mesh_options(store: Store, options: Mapping[str, Any] | None) -> None:
    """Store the options of a command for later ones; empty options delete the stored ones, None leaves them
    unchanged.
    """
    if options is None:
        return
    if options:
        store.write_json(MESH_OPTIONS, dict(options))
    else:
        store.remove([MESH_OPTIONS])
