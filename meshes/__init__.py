"""The ground: a layered section, and the meshes made from it.

What a script needs stands here: ``Section`` is read from TOML, ``MeshSettings`` says how to mesh it, ``generate`` makes
the quadrilaterals of the finite elements (``QuadMesh``), ``triangulate`` the triangles of limit analysis (``TriMesh``).
Each is imported when it is first asked for, and not before: gmsh by the first of the last two.
"""

from typing import TYPE_CHECKING

from meshes.exports import exports

if TYPE_CHECKING:
    from meshes.adaptation import adapted
    from meshes.errors import InputError
    from meshes.gmsh_model import generate
    from meshes.quad_mesh import BadMeshError, QuadMesh, read, save
    from meshes.section.section import Section, Stratum
    from meshes.settings import MeshSettings
    from meshes.triangles import TriMesh, triangulate

__all__, __getattr__ = exports(__name__, __file__)
