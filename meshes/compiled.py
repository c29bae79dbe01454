"""Manages the folder of compiled kernels: one folder for each state of their sources, so that no change is overlooked.

Numba stores compiled functions and compiles again when the file of a function changes, but does not check the files of
functions that are called from there (Numba's issue 1833): after a change in `contact.py` alone, `stepping.py` would
still be used with the old contact law. So the name of the folder contains a hash of all kernels.

The folder is in the cache folder of the user, since an installation may be read-only, or in NUMBA_CACHE_DIR if that is
set. Copies of the program with the same kernels share it (`meshes.kernel_places`).
"""

import atexit
import hashlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

PACKAGES = ("dem", "fem")  # those with kernels, folders beside this package
PREFIX = "noshiro-kernels-"
VARIABLE = "NUMBA_CACHE_DIR"
LOCATORS = "NUMBA_CACHE_LOCATOR_CLASSES"
OWN_LOCATOR = "meshes.kernel_places.KernelPlace"
NUMBAS_LOCATORS = "UserProvidedCacheLocator,InTreeCacheLocator,UserWideCacheLocator,IPythonCacheLocator"
FORGOTTEN_AFTER = 28 * 86400.0  # s since a folder was last used


def keep_compiled_kernels() -> None:
    """Let Numba store the kernels of this process in the folder of their sources.

    Call this function before kernels are imported. Child processes inherit the folder. If no folder can be written,
    kernels are compiled for this process alone.
    """
    chosen = os.environ.get(VARIABLE)
    base = Path(chosen) if chosen else _user_cache() / "noshiro"
    if base.name.startswith(PREFIX):  # set by this very function, here or in a parent process
        base = base.parent
    name = PREFIX + hash_of_kernels(Path(__file__).parents[1])
    if not _usable(base / name):
        base = Path(tempfile.mkdtemp(prefix="noshiro-"))
        atexit.register(shutil.rmtree, base, ignore_errors=True)
    folder = base / name
    forget(base, folder)
    os.environ[VARIABLE] = str(folder)
    others = os.environ.get(LOCATORS) or NUMBAS_LOCATORS
    if not others.startswith(OWN_LOCATOR):
        os.environ[LOCATORS] = f"{OWN_LOCATOR},{others}"
    if "numba" in sys.modules:
        sys.modules["numba.core.config"].reload_config()


def kernel_folder() -> Path:
    """Return the folder of compiled kernels of this process.

    Returns
    -------
    The folder that `keep_compiled_kernels` has chosen; call that function before.
    """
    return Path(os.environ[VARIABLE])


def hash_of_kernels(top: Path) -> str:
    """Return the hash of all sources in the kernel folders of the packages in the folder `top`."""
    return hash_of_files(
        (path for package in PACKAGES for path in sorted((top / package / "kernels").rglob("*.py"))), top
    )


def hash_of_files(paths: Iterable[Path], top: Path) -> str:
    """Return the hash of files: of their contents, in their order, and of their places.

    Parameters
    ----------
    paths : paths of the files
    top : folder to which their places are relative

    Returns
    -------
    16 hexadecimal digits of SHA-256.
    """
    digest = hashlib.sha256()
    for path in paths:
        digest.update(str(path.relative_to(top)).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def forget(base: Path, current: Path) -> None:
    """Remove the folders of other sources that nobody has used for four weeks."""
    for folder in base.glob(PREFIX + "*"):
        try:
            old = time.time() - folder.stat().st_mtime > FORGOTTEN_AFTER
        except OSError:  # another process was faster
            continue
        if folder != current and old:
            shutil.rmtree(folder, ignore_errors=True)


def _usable(folder: Path) -> bool:
    """Return whether files can be written into the folder, which is made if necessary. The folder is marked as used
    today."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
        os.utime(folder)
    except OSError:
        return False
    return True


def _user_cache() -> Path:
    """Return the folder of the user for files that a program can make again."""
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
