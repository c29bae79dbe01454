"""The ground: a layered section, and the meshes made from it.

What a script needs stands here: ``Section`` is read from TOML, ``MeshSettings`` says how to mesh it, ``generate`` makes
the quadrilaterals of the finite elements (``QuadMesh``), ``triangulate`` the triangles of limit analysis (``TriMesh``).
Each is imported when it is first asked for, and not before: gmsh by the first of the last two.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from meshes.errors import InputError

if TYPE_CHECKING:
    from meshes.adaptation import adapted
    from meshes.gmsh_model import generate
    from meshes.quad_mesh import BadMeshError, QuadMesh, read, save
    from meshes.section.section import Section, Stratum
    from meshes.settings import MeshSettings
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

# What is imported when it is first used: gmsh and meshio take half a second, pydantic and NumPy a quarter.
LATER = {
    "adapted": "meshes.adaptation",
    "generate": "meshes.gmsh_model",
    "BadMeshError": "meshes.quad_mesh",
    "QuadMesh": "meshes.quad_mesh",
    "read": "meshes.quad_mesh",
    "save": "meshes.quad_mesh",
    "Section": "meshes.section.section",
    "Stratum": "meshes.section.section",
    "MeshSettings": "meshes.settings",
    "TriMesh": "meshes.triangles",
    "triangulate": "meshes.triangles",
}


def __getattr__(name: str) -> Any:
    """Import what stands in LATER (PEP 562)."""
    if name not in LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(LATER[name]), name)
