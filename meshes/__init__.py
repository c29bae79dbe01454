"""The ground: a layered section, and the meshes made from it.

What a script needs stands here: ``Section`` is read from TOML, ``MeshSettings`` says how to mesh it, ``generate`` makes
the quadrilaterals of the finite elements (``QuadMesh``), ``triangulate`` the triangles of limit analysis (``TriMesh``).
gmsh is loaded by the first of the last two that is asked for, and not before.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from meshes.errors import InputError
from meshes.section import Section, Stratum
from meshes.settings import MeshSettings

if TYPE_CHECKING:
    from meshes.adaptation import adapted
    from meshes.gmsh_model import generate
    from meshes.quad_mesh import BadMeshError, QuadMesh, read, save
    from meshes.triangles import TriMesh, triangulate

__all__ = [
    "BadMeshError",
    "InputError",
    "MeshSettings",
    "QuadMesh",
    "Section",
    "Stratum",
    "TriMesh",
    "adapted",
    "generate",
    "read",
    "save",
    "triangulate",
]

# What is imported when it is first used: gmsh and meshio take half a second.
LATER = {
    "adapted": "meshes.adaptation",
    "generate": "meshes.gmsh_model",
    "BadMeshError": "meshes.quad_mesh",
    "QuadMesh": "meshes.quad_mesh",
    "read": "meshes.quad_mesh",
    "save": "meshes.quad_mesh",
    "TriMesh": "meshes.triangles",
    "triangulate": "meshes.triangles",
}


def __getattr__(name: str) -> Any:
    """Import what stands in LATER (PEP 562)."""
    if name not in LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(LATER[name]), name)
