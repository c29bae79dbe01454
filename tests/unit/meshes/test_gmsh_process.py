"""gmsh in processes of its own: errors and ends of it, and the same mesh whatever else was done before."""

import os

import numpy as np
import pytest

from meshes import gmsh_model
from meshes.adaptation import adapted
from meshes.errors import InputError
from meshes.executor import LostError
from meshes.gmsh_model import generate
from meshes.quad_mesh import BadMeshError, check
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.executor_tasks import ends
from tests.support.fem_problems import BANK_OF_SAND

FREE = MeshSettings(method="free", size=0.8)
there = gmsh_model._in_fresh_processes


def test_an_error_comes_back_as_it_was():
    with pytest.raises(InputError, match=r"a\.toml: \d problems"):
        there.submit(Section.parse, {}, "a.toml").result()
    folded = generate(BANK_OF_SAND, FREE)
    folded.points[:] = -folded.points[:, ::-1]
    with pytest.raises(BadMeshError, match="cells are folded"):
        there.submit(check, folded).result()


def test_what_ends_gmsh_does_not_end_the_program(monkeypatch):
    with pytest.raises(LostError):
        there.submit(os._exit, 3).result()
    assert there.submit(divmod, 7, 2).result() == (3, 1)
    monkeypatch.setattr(gmsh_model, "make_free_mesh", ends)
    with pytest.raises(BadMeshError, match="the process of gmsh ended without a mesh; try another size of cells"):
        generate(BANK_OF_SAND, FREE)


def test_the_same_mesh_comes_from_a_process_that_has_made_others_and_from_a_new_one():
    first = generate(BANK_OF_SAND, FREE)
    band = np.exp(-np.abs(first.points[first.cells].mean(axis=1) @ [0.3, -1.0] - 2.0))
    meshes = []
    for number in range(4):
        meshes.append(adapted(BANK_OF_SAND, FREE, first, band, 2000))
        if number == 1:
            with pytest.raises(LostError):  # the next one comes from a new process
                there.submit(os._exit, 3).result()
        generate(BANK_OF_SAND, MeshSettings(method="free", size=0.5 + 0.1 * number))
    assert all(np.array_equal(mesh.points, meshes[0].points) for mesh in meshes)
    assert all(np.array_equal(mesh.cells, meshes[0].cells) for mesh in meshes)
