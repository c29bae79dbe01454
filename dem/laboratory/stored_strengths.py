"""Stores results of element tests in the cache folder of the user: patches of equal dimensionless numbers are tested
once.

The results are stored next to the compiled kernels, in one folder for each version of the sources of the discs, so that
results of another contact law are never used. Stored and new results are equal to the last bit.
"""

import hashlib
import json
import platform
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from pathlib import Path

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_name

from dem.errors import DemError
from dem.laboratory.compression import PatchStrength, compress
from dem.laboratory.contact_numbers import PRESSURE, ContactNumbers
from meshes.compiled import hash_of_files, kernel_folder
from meshes.files import whole_file

ROOMS = "", "engine", "kernels", "laboratory"  # of the discs, whose sources a test depends on
OVERLAP = 0.5  # over the mean radius, at which a test is stopped


def strength_of_patch(numbers: ContactNumbers, seed: int) -> PatchStrength | str:
    """Return the strength of a patch at `PRESSURE`, tested now or earlier, or the reason why it has none.

    Parameters
    ----------
    numbers : dimensionless numbers of the contacts of the patch
    seed : seed of the packing of the patch

    Returns
    -------
    The result, or the reason if the patch does not come to rest or cannot be compressed.
    """
    file = _file(numbers, seed)
    with suppress(OSError, ValueError, TypeError, KeyError):
        stored = json.loads(file.read_text())
        return (
            str(stored["reason"])
            if "reason" in stored
            else PatchStrength(**{**stored, "course": np.array(stored["course"])})
        )
    try:
        strength: PatchStrength | str = compress(numbers.sample(seed, OVERLAP), PRESSURE)
    except (DemError, ValueError) as error:
        strength = str(error)
    content = (
        {"reason": strength} if isinstance(strength, str) else {**asdict(strength), "course": strength.course.tolist()}
    )
    with suppress(OSError), whole_file(file) as temporary:
        temporary.write_text(json.dumps(content))
    return strength


def is_stored(numbers: ContactNumbers, seed: int) -> bool:
    """Return whether the result of a patch is stored; ``numbers``: dimensionless numbers of its contacts, ``seed``:
    seed of its packing."""
    return _file(numbers, seed).exists()


def _file(numbers: ContactNumbers, seed: int) -> Path:
    """Return the file of the result for the numbers, with all digits, and the seed."""
    values = "_".join(f"{value:.17g}" for value in (numbers.friction, numbers.cohesion, numbers.kappa))
    return _folder() / f"{'turning' if numbers.turns else 'fixed'}_{values}_{seed}.json"


@cache
def _folder() -> Path:
    """Return the folder of the results of this version of the sources."""
    package = Path(__file__).parents[1]
    sources = (path for room in ROOMS for path in sorted((package / room).glob("*.py")))
    machine = platform.machine(), get_host_cpu_name(), numba.__version__, np.__version__
    digest = hashlib.sha256(repr((*machine, hash_of_files(sources, package))).encode())
    return kernel_folder() / f"element_tests_{digest.hexdigest()[:16]}"
