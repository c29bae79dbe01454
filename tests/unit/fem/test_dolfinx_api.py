"""dolfinx: missing, too old, and what importing it leaves behind."""

import subprocess
import sys

import pytest

from fem.solvers import dolfinx_api
from meshes.errors import InputError


def test_missing_dolfinx_comes_with_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "dolfinx", None)
    with pytest.raises(InputError, match="dolfinx: 1 problem\n  - cannot be imported") as caught:
        dolfinx_api.require()
    assert "apt-get install python3-dolfinx" in str(caught.value)
    assert "conda install -c conda-forge fenics-dolfinx" in str(caught.value)


@pytest.mark.parametrize(("version", "good"), [("0.4.1", False), ("0.5.2", True), ("0.11.0", True)])
def test_dolfinx_that_is_too_old_is_told_so(monkeypatch, version, good):
    dolfinx_api.require()
    import dolfinx

    monkeypatch.setattr(dolfinx, "__version__", version)
    if good:
        dolfinx_api.require()
    else:
        with pytest.raises(InputError, match=r"version 0\.4\.1 is too old; expected 0\.5 or newer; on Debian"):
            dolfinx_api.require()


FIRST_USES = ("require()", "distribute(COMM_SELF, array([[0, 0], [1, 0], [1, 1], [0, 1]]), array([[0, 1, 2, 3]]), 1)")


@pytest.mark.parametrize("use", FIRST_USES)
def test_it_leaves_libraries_that_are_loaded_later_to_themselves(use):
    """dolfinx 0.5 shows the symbols of all of them to each other; two versions of HarfBuzz did not survive that."""
    words = f"""
import sys
from mpi4py.MPI import COMM_SELF
from numpy import array
from fem.solvers import dolfinx_api
before = sys.getdlopenflags()
dolfinx_api.{use}
assert "dolfinx" in sys.modules
assert sys.getdlopenflags() == before
"""
    subprocess.run([sys.executable, "-c", words], check=True)


def test_a_broken_pipe_is_an_error_and_ends_no_program():
    """PETSc aborted the program where a worker process had died, so that its task was not tried again."""
    words = """
import os
import fem.continuum.discretisation
reading, writing = os.pipe()
os.close(reading)
try:
    os.write(writing, b"to nobody")
except BrokenPipeError:
    print("heard")
"""
    done = subprocess.run([sys.executable, "-c", words], check=True, capture_output=True, text=True)
    assert done.stdout == "heard\n"
