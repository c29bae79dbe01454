"""The critical Kh for the dilation angles of the strata, by an iteration of pressures."""

import math

import pytest
from mpi4py import MPI

from fem.limit_load.limit_load import critical_limit_load
from fem.limit_load.nonassociated_limit_load import NonassociatedLimitLoad, nonassociated_limit_load
from fem.search.own_dilation import own_dilation
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.shipped import file_of
from tests.support.published import cases
from tests.support.water import section, soil

FALL, DEPTH = 0.25, 6.0


def limit_load_of(ground: Section, settings: FemSettings, mesh: MeshSettings | None = None) -> NonassociatedLimitLoad:
    """The limit load on one mesh, from rest and from the pressures of ψ = φ."""
    settings = settings.changed(flow="associated", direction="downhill")
    cells = generate(ground, mesh)
    full = critical_limit_load(ground, cells, settings, MPI.COMM_SELF)
    assert full.mechanism is not None
    loads = full.ground.constant, full.ground.load
    return nonassociated_limit_load(full.ground.problem, cells, *loads, full.mechanism.stress)


def sliding(cohesion: float, tan: float) -> float:
    """Kh at which an endless slope slides along its base with a resistance of ``cohesion`` and ``tan`` there."""
    beta = math.atan(FALL)
    sin, cos = math.sin(beta), math.cos(beta)
    return (cohesion / (20e3 * DEPTH) + cos**2 * tan - sin * cos) / (cos**2 + sin * cos * tan)


@pytest.mark.parametrize("psi", [0.0, 30.0])
def test_an_endless_slope_has_its_closed_form_or_no_answer(psi: float) -> None:
    """Along a plane that does not stretch, ground that flows with ψ bears c and tan φ times
    cos ψ cos φ / (1 - sin ψ sin φ) (Davis 1968). For ψ = 0 rows of cells yield in turn, and nothing is told."""
    ground = section(
        soil(cohesion="10 kPa", friction_angle="30 deg", dilation_angle=f"{psi} deg", density="20 kN/m^3"),
        surface=[[0.0, 5.0], [20.0, 0.0]],
        base={"depth": DEPTH},
    )
    phi, dilation = math.radians(30.0), math.radians(psi)
    share = math.cos(dilation) * math.cos(phi) / (1.0 - math.sin(dilation) * math.sin(phi))
    answer = limit_load_of(ground, FemSettings(sides="periodic"), MeshSettings(columns=2, rows=24))
    if psi == 0.0:
        assert answer.kh is None
        assert answer.reason.startswith("pressures still change")
    else:
        assert answer.kh == pytest.approx(sliding(share * 10e3, share * math.tan(phi)), rel=0.02)


@pytest.mark.slow
def test_a_slope_settles_on_one_mesh() -> None:
    """A step of the same kind by another program, on 454 cells; ψ = φ has 0.210, Davis 0.119."""
    case = cases()["cheng_homogeneous"]
    assert limit_load_of(case.section, case.fem).kh == pytest.approx(0.1505, rel=0.02)


@pytest.mark.slow
def test_a_slope_settles_on_three_meshes() -> None:
    """Griffiths & Lane 1: another program has 0.1278 on 924 cells, where this iteration does not settle."""
    case = cases()["griffiths_lane_1"]
    settings = case.fem.changed(flow="associated", direction="downhill")
    full = critical_limit_load(case.section, generate(case.section), settings, MPI.COMM_SELF)
    assert own_dilation(case.section, settings, full).kc == pytest.approx(0.1278, rel=0.02)


@pytest.mark.slow
def test_a_section_of_bare_sand_does_not_settle_and_is_not_told() -> None:
    """S-13: λ wanders within 3 %."""
    ground = Section.read(file_of("s13"))
    settings = FemSettings(flow="associated", direction="downhill")
    full = critical_limit_load(ground, generate(ground), settings, MPI.COMM_SELF)
    assert own_dilation(ground, settings, full).kc is None
