"""Write arrays and plain values to one HDF5 file and read them back, exact to the last bit; the file is never half
written.
"""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from meshes.files import whole

PLAIN = "plain"  # attribute that holds all values that are no arrays, as JSON


def write(path: Path, arrays: dict[str, np.ndarray], plain: dict[str, Any]) -> None:
    """Writes the file completely or not at all. plain: values that JSON can hold, and infinite numbers."""
    with whole(path) as beside, h5py.File(beside, "w") as file:
        for name, values in arrays.items():
            file.create_dataset(name, data=values)
        file.attrs[PLAIN] = json.dumps(plain)


def read(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Reads arrays and plain values back. Raises OSError or KeyError for a file that is no such checkpoint."""
    with h5py.File(path, "r") as file:
        plain = json.loads(file.attrs[PLAIN])
        return {name: data[()] for name, data in file.items()}, plain
