"""Describes the ground as a layered section, and makes meshes of it.

This package exports the names that a script needs: ``Section`` is read from TOML, ``MeshSettings`` are the settings of
a mesh, ``generate`` makes the quadrilaterals of the finite elements (``QuadMesh``), ``triangulate`` the triangles of
limit analysis (``TriMesh``). Each name is imported when it is first used; the last two import gmsh.
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
