"""What is said of sections, meshes and installations that the finite elements cannot use."""

import meshio
import numpy as np
import pytest
from mpi4py import MPI

from fem.errors import UnstableError
from fem.search.critical import critical_coefficient
from fem.settings import FemSettings
from meshes.errors import InputError
from meshes.gmsh_model import generate
from meshes.quad_mesh import read
from meshes.settings import MeshSettings
from tests.support.fem_problems import section, soil

SLOPE = [[0.0, 6.0], [12.0, 6.0], [24.0, 0.0], [36.0, 0.0]]


def answer(ground, **settings):
    mesh = generate(ground, MeshSettings(columns=9, rows=4))
    return critical_coefficient(ground, mesh, FemSettings(element="bilinear", **settings), MPI.COMM_SELF)


def test_every_stratum_without_strength_is_named():
    ground = section(SLOPE, 6.0, soil("a", c=0.0, phi=0.0, bottom={"depth": 2.0}), soil("b", c=0.0, phi=0.0))
    with pytest.raises(InputError) as caught:
        answer(ground)
    assert caught.value.problems == tuple(
        f'strata {k} "{name}": cohesion and friction angle are both 0; expected a strength'
        for k, name in ((1, "a"), (2, "b"))
    )


def test_sides_that_differ_cannot_be_tied():
    """The layers of the left side are as high as those of the right side put together in another way."""
    ground = section([[0.0, 3.0], [36.0, 0.0]], 6.0, soil("a", bottom={"depth": [[0.0, 2.0], [36.0, 3.0]]}), soil("b"))
    with pytest.raises(
        InputError, match='sides = "periodic": the left and right sides differ; expected layers of the same thickness'
    ) as caught:
        answer(ground, sides="periodic")
    assert 'use sides = "smooth", "free-field" or "fixed"' in str(caught.value)


def test_mesh_file_without_named_groups(tmp_path):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    meshio.write(tmp_path / "bare.msh", meshio.Mesh(points, [("quad", [[0, 1, 2, 3]])]), file_format="gmsh")
    with pytest.raises(InputError) as caught:
        read(tmp_path / "bare.msh")
    said = "\n".join(caught.value.problems)
    assert all(f'there is no boundary group "{name}"' in said for name in ("surface", "base", "left", "right"))
    assert "there is no surface group; expected one for each stratum" in said


def test_section_that_fails_under_its_own_weight_says_how_much_it_carries():
    """A bank 6 m high, of γ = 20 kN/m³ and c = 5 kPa, γH/c = 24, at 76°: far above the 4 to 6 that it could carry."""
    bank = [[0.0, 6.0], [12.0, 6.0], [13.5, 0.0], [24.0, 0.0]]
    with pytest.raises(UnstableError, match="fails under its own weight") as caught:
        answer(section(bank, 3.0, soil(c=5e3, phi=0.0)))
    share = int(str(caught.value).split("supports about ")[1].split(" %")[0])
    assert 10 < share < 70, "coarse bilinear cells carry too much, but not all"
    assert "factor of safety at Kh = 0" in str(caught.value)


def test_densities_of_zero_are_told_apart():
    # A stratum cannot be given a density of 0; what is built from one can.
    weightless = soil().model_copy(update={"density_ordinary": 0.0})
    with pytest.raises(InputError, match="density_ordinary is 0 in all strata, so that the ground has no weight"):
        answer(section(SLOPE, 6.0, weightless, unusual=True))
