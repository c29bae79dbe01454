"""The options with which a folder was meshed: commands after `noshiro mesh --refine 2` go on with the same mesh.

They are settings of [mesh] that the command line gave; the folder's section.toml holds the mesh that came of them.
"""

from collections.abc import Mapping
from typing import Any

from workflow.run.store import Store

NAME = ".noshiro/mesh_options.json"


def kept(store: Store) -> dict[str, Any]:
    """Options of the mesh command that the folder keeps; empty without any."""
    options = store.read_json(NAME) if store.has(NAME) else {}
    return options if isinstance(options, dict) else {}


def keep(store: Store, options: Mapping[str, Any] | None) -> None:
    """Keep the options of a command for later ones; empty ones forget what was kept, None leaves it as it is."""
    if options is None:
        return
    if options:
        store.write_json(NAME, dict(options))
    else:
        store.remove([NAME])
