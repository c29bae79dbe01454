"""Tells Numba where compiled kernels are kept: by the place of their source in the program, not in the file system.

Each copy of the program with the same kernels then finds what another copy has compiled, within the folder of
`meshes.compiled`, whose name contains a hash of all kernels. Numba imports this module by the name in its environment
variable NUMBA_CACHE_LOCATOR_CLASSES.
"""

from pathlib import Path

from numba.core.caching import UserProvidedCacheLocator

_TOP = Path(__file__).resolve().parents[1]


class KernelPlace(UserProvidedCacheLocator):
    """Locates the compiled functions of a file in a folder `kernels` of this program; other files are left to Numba."""

    @classmethod
    def from_function(cls, py_func: object, py_file: str) -> "KernelPlace | None":
        """Return the place of a function of a file, None if the file is no kernel of this program."""
        path = Path(py_file).resolve()
        if path.parent.name != "kernels" or path.parent.parent.parent != _TOP:
            return None
        place: KernelPlace | None = super().from_function(py_func, py_file)
        return place

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """Return the name of the folder for the functions of a file: that of its package."""
        return Path(py_file).resolve().parents[1].name
