"""gmsh in a process of its own: errors and ends of it, and the same mesh whatever else was done before."""

import os
import threading
import time

import numpy as np
import pytest

from meshes import gmsh_process
from meshes.adaptation import adapted
from meshes.errors import InputError
from meshes.gmsh_model import generate
from meshes.gmsh_process import GmshEndedError, in_process_of_its_own
from meshes.quad_mesh import BadMeshError, check
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.fem_problems import BANK_OF_SAND

FREE = MeshSettings(method="free", size=0.8)


def test_an_error_comes_back_as_it_was():
    with pytest.raises(InputError, match=r"a\.toml: \d problems"):
        in_process_of_its_own(Section.parse, {}, "a.toml")
    with pytest.raises(FileNotFoundError, match="no such folder"):
        in_process_of_its_own(open, "no such folder/mesh.msh")
    folded = generate(BANK_OF_SAND, FREE)
    folded.points[:] = -folded.points[:, ::-1]
    with pytest.raises(BadMeshError, match="cells are folded"):
        in_process_of_its_own(check, folded)


def test_a_fault_comes_back_with_its_traceback():
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        in_process_of_its_own(divmod, 1, 0)


def test_what_ends_gmsh_does_not_end_the_program():
    with pytest.raises(GmshEndedError):
        in_process_of_its_own(os._exit, 3)
    assert in_process_of_its_own(divmod, 7, 2) == (3, 1)


def test_after_ctrl_c_the_next_mesh_is_none_that_was_left(monkeypatch):
    def interrupted(_: int) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(gmsh_process, "_read", interrupted)
        with pytest.raises(KeyboardInterrupt):
            in_process_of_its_own(divmod, 9, 5)
    assert in_process_of_its_own(divmod, 7, 2) == (3, 1)


def test_what_is_left_in_the_middle_of_its_work_is_not_waited_for():
    def ask() -> None:
        with pytest.raises(GmshEndedError):
            in_process_of_its_own(time.sleep, 30.0)

    asked = threading.Thread(target=ask)
    asked.start()
    time.sleep(2.0)
    start = time.monotonic()
    gmsh_process._server.end()
    asked.join()
    assert time.monotonic() - start < 10.0
    assert in_process_of_its_own(divmod, 7, 2) == (3, 1)


def test_threads_get_their_own_answers():
    found = {}

    def ask(k: int) -> None:
        found[k] = in_process_of_its_own(divmod, k, 3)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {k: divmod(k, 3) for k in range(8)}


def test_the_same_mesh_comes_from_a_process_that_has_made_others_and_from_a_new_one():
    first = generate(BANK_OF_SAND, FREE)
    band = np.exp(-np.abs(first.points[first.cells].mean(axis=1) @ [0.3, -1.0] - 2.0))
    meshes = []
    for number in range(4):
        meshes.append(adapted(BANK_OF_SAND, FREE, first, band, 2000))
        if number == 1:
            gmsh_process._server.end()
        generate(BANK_OF_SAND, MeshSettings(method="free", size=0.5 + 0.1 * number))
    assert all(np.array_equal(mesh.points, meshes[0].points) for mesh in meshes)
    assert all(np.array_equal(mesh.cells, meshes[0].cells) for mesh in meshes)
