"""Stores the options with which a folder was meshed: commands after `noshiro mesh --refine 2` use the same mesh.

The options are settings of [mesh] from the command line; the section.toml of the folder has the resulting settings.
"""

from collections.abc import Mapping
from typing import Any

from workflow.run.store import Store

NAME = ".noshiro/mesh_options.json"


def stored_options(store: Store) -> dict[str, Any]:
    """Return the stored options of the mesh command; empty without any."""
    options = store.read_json(NAME) if store.has(NAME) else {}
    return options if isinstance(options, dict) else {}


def keep(store: Store, options: Mapping[str, Any] | None) -> None:
    """Store the options of a command for later ones; empty options delete the stored ones, None leaves them
    unchanged.
    """
    if options is None:
        return
    if options:
        store.write_json(NAME, dict(options))
    else:
        store.remove([NAME])
