"""Element tests of discs: the parts that need no long run, what they refuse, and what they hand on."""

import json
import signal
from dataclasses import replace
from threading import Event, Thread, main_thread

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem.engine.forces import contact_forces
from dem.engine.packer import unpack
from dem.engine.time_step import largest_step
from dem.errors import EscapeError, OverlapError
from dem.kernels.patch import share_inside
from dem.laboratory.element_table import element_tests
from dem.laboratory.element_test import ElementTest, element_test
from dem.laboratory.loading import Curve, confine, load, probe
from dem.laboratory.patch import Patch, PatchSample, StrainControl, lattice_patch, random_patch
from dem.laboratory.plane_elastic import PlaneElastic
from dem.laboratory.strength import dilation, from_plane, from_principal, verdict
from dem.model import DiscModel
from meshes.executor import is_interrupt
from meshes.section.section import Section, Stratum
from tests.support import SECTIONS
from tests.support.dem_cases import KN, RADIUS, SOIL_SPRINGS, stress

SMALL = (12, 14)
STRATUM = Stratum(
    name="sand", youngs_modulus="30 MPa", poissons_ratio=0.3, density_ordinary=1900.0, density_seismic=1900.0,
    cohesion="5 kPa", friction_angle="35 deg",
)  # fmt: skip


@pytest.fixture(scope="module")
def sand() -> ElementTest:
    return element_test(
        PatchSample(replace(SOIL_SPRINGS, cohesion=0.0), "random", RADIUS, size=SMALL), [2e6, 1e6], strain=0.1
    )


coordinate = st.floats(-5.0, 5.0)
point = st.tuples(coordinate, coordinate)
REGION = np.array([[-1.0, -2.0], [1.0, 2.0]])


@settings(deadline=None)  # the first call compiles
@given(point, point)
def test_share_of_a_segment_in_a_region(first: tuple[float, float], second: tuple[float, float]) -> None:
    a, b = np.array([first]).T, np.array([second]).T
    there, back = (*first, *(b - a).ravel()), (*second, *(a - b).ravel())
    share = share_inside(*there, REGION)
    assert 0.0 <= share <= 1.0
    assert share == pytest.approx(share_inside(*back, REGION), abs=1e-9)
    # counted point by point
    along = a + (b - a) * (np.arange(2000) + 0.5) / 2000
    inside = np.all((along >= REGION[0][:, None]) & (along <= REGION[1][:, None]), axis=0)
    assert share == pytest.approx(inside.mean(), abs=1.1e-3)


@given(st.floats(0.0, 1e5), st.floats(0.0, 1.3), st.lists(st.floats(1e3, 1e6), min_size=2, max_size=5, unique=True))
def test_mohr_coulombs_line_gives_back_what_it_was_drawn_from(c: float, phi: float, minor: list[float]) -> None:
    if np.ptp(minor) < 1e3:
        minor = [*minor, max(minor) + 1e4]
    ratio = (1.0 + np.sin(phi)) / (1.0 - np.sin(phi))
    major = [ratio * s + 2.0 * c * np.sqrt(ratio) for s in minor]
    assert from_principal(major, minor) == pytest.approx((c, phi), rel=1e-6, abs=1e-3)
    shear = [c + s * np.tan(phi) for s in minor]
    assert from_plane(minor, shear) == pytest.approx((c, phi), rel=1e-6, abs=1e-3)


def test_strength_that_falls_with_pressure_is_no_friction() -> None:
    assert np.isnan(from_principal([3.0, 2.0], [1.0, 2.0])).all()


@given(st.floats(1e4, 1e9), st.floats(0.0, 0.49))
def test_plane_strain_and_sheet(youngs: float, nu: float) -> None:
    """M, lame and G of Hooke's law in plane strain lead back to E and nu."""
    lame = youngs * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    shear = youngs / (2.0 * (1.0 + nu))
    elastic = PlaneElastic(lame + 2.0 * shear, lame, shear)
    assert (elastic.E, elastic.nu) == pytest.approx((youngs, nu), rel=1e-6, abs=1e-9)
    assert (elastic.E_2d, elastic.nu_2d) == pytest.approx((youngs / (1.0 - nu**2), nu / (1.0 - nu)), rel=1e-6, abs=1e-9)
    assert 2.0 * elastic.G / (elastic.M - elastic.lame) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("values", "stopped", "word"),
    [
        ([1, 2, 3, 2, 1], False, "peak"),
        ([1, 2, 3, 2, 1], True, "peak"),
        ([1, 2, 3, 4, 5], False, "still rising"),
        ([1, 2, 3, 4, 5], True, "stopped"),
        ([1, 2, 3, 3, 3, 3, 3], False, "levels off"),
    ],
)
def test_verdict(values: list[float], stopped: bool, word: str) -> None:
    assert verdict(np.repeat(values, 4).astype(float), stopped) == word


@pytest.mark.parametrize("psi", [-0.1, 0.0, 0.3])
def test_dilation_of_a_curve_that_grows_at_a_known_angle(psi: float) -> None:
    axial = np.linspace(0.0, 0.1, 21)
    # eps_v = sin psi (eps_1 - eps_3) with eps_v = -(eps_1 + eps_3)
    lateral = -axial * (1.0 + np.sin(psi)) / (1.0 - np.sin(psi))
    curves = {
        "biaxial": Curve(
            "biaxial", 1e5, axial, np.zeros((21, 2, 2)), -(axial + lateral), axial, axial, 1.0, ""
        ),
        "simple shear": Curve(
            "simple shear", 1e5, axial, np.zeros((21, 2, 2)), axial * np.tan(psi), axial, axial, 1.0, ""
        ),
    }  # fmt: skip
    for curve in curves.values():
        assert dilation(curve, 10) == pytest.approx(psi, abs=1e-9)


@pytest.mark.parametrize("make", [lattice_patch, random_patch])
def test_confined_on_all_sides_and_stress_as_the_forces_say(make: type) -> None:
    patch = make(SOIL_SPRINGS, RADIUS)
    confine(patch, 2e5)
    now = patch.stress_state()
    assert now.stress == pytest.approx(-2e5 * np.eye(2), abs=1.01e-3 * 2e5)
    assert now.unbalanced < 1e-3
    if make is lattice_patch:
        # disc by disc instead of by clipping: the mean over discs that have all their neighbours
        model = patch.model
        inner = np.all(np.abs(np.array([model.x, model.z]).T) < patch.region[1], axis=1)
        area = inner.sum() * 2.0 * np.sqrt(3.0) * RADIUS**2 * np.linalg.det(patch.deformation)
        assert stress(model, contact_forces(model), area, inner) == pytest.approx(now.stress, rel=1e-3, abs=10.0)


def test_what_a_press_keeps_is_what_the_model_would_say() -> None:
    made = PatchSample(replace(SOIL_SPRINGS, cohesion=0.0), "random", RADIUS, size=SMALL, law="soil").patch()
    confine(made, 1e6)
    disc_model, renewed = made.copy(), made.copy()
    per_second = 1e-3 / made.time_unit
    drive = np.array([[0.2, 0.5], [0.0, -1.0]]) * per_second
    with StrainControl(disc_model) as press:
        for k in range(1, 6):
            press.strain(k * drive, 0.002 / per_second)
            inside = disc_model.stress_state()
            assert press.stable_step() == pytest.approx(largest_step(whole(disc_model)).seconds, rel=1e-12)
    with StrainControl(renewed) as press:
        for k in range(1, 6):
            press.strain(k * drive, 0.002 / per_second)
            press.run.update()  # the contacts go back to the model, and a new layout is made of it
    for name in ("x", "z", "vx", "vz", "roll", "shear", "force_x", "force_z", "pair_i"):
        assert np.array_equal(getattr(disc_model.model, name), getattr(renewed.model, name)), name
    model, after = disc_model.model, disc_model.stress_state()
    assert np.array_equal(after.stress, inside.stress)
    assert after.unbalanced == inside.unbalanced
    total = [np.bincount(model.pair_j, f, len(model)) - np.bincount(model.pair_i, f, len(model))
             for f in (model.force_x, model.force_z)]  # fmt: skip
    forces = np.hypot(model.force_x, model.force_z)
    unbalanced = np.hypot(*total)[~disc_model.frame].mean() / forces[forces > 0.0].mean()
    assert after.unbalanced == pytest.approx(unbalanced, rel=1e-12)


def whole(patch: Patch) -> DiscModel:
    """The model of a patch in a press, with its contacts, as a copy."""
    model = patch.model.copy()
    unpack(patch.layout, model)
    return model


def test_frame_follows_its_affine_motion_to_rounding() -> None:
    patch = lattice_patch(SOIL_SPRINGS, RADIUS)
    start = np.array([patch.model.x, patch.model.z])
    confine(patch, 1e5)
    load(patch, "simple shear", 1e5, 0.02, 1e-3, probe(patch, 1e5)[0])
    now = np.array([patch.model.x, patch.model.z])
    frame = patch.frame
    assert now[:, frame] == pytest.approx(patch.deformation @ start[:, frame], abs=1e-9)
    assert np.abs(now - patch.deformation @ start)[:, ~frame].max() > 1e-6  # the others are free to differ


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"packing": "square"}, "'lattice' or 'random'"),
        ({"pressures": [1e4]}, "two or more"),
        ({"pressures": [1e4, -1e4]}, "above 0 Pa"),
        ({"pressures": [1e4, float("nan")]}, "above 0 Pa"),
        ({"strain": 0.0}, "strain = 0.0"),
        ({"rate": 1.0}, "rate = 1.0"),
        ({"size": (4, 18)}, "4 x 18"),
    ],
)
def test_refuses(changes: dict[str, object], words: str) -> None:
    sample = {"layer": SOIL_SPRINGS, "packing": "lattice", "radius": RADIUS, "size": None}
    test = {"pressures": [1e4, 2e4], "strain": 0.2, "rate": 2e-4}
    with pytest.raises(ValueError, match=words):
        element_test(
            PatchSample(**{key: changes.get(key, value) for key, value in sample.items()}),  # type: ignore[arg-type]
            **{key: changes.get(key, value) for key, value in test.items()},  # type: ignore[arg-type]
        )


def test_a_disc_outside_of_the_frame_is_found() -> None:
    patch = lattice_patch(SOIL_SPRINGS, RADIUS)
    patch.check_frame()
    disc = int(np.flatnonzero(~patch.frame)[0])
    patch.model.x[disc] += 100.0 * RADIUS
    with pytest.raises(EscapeError, match=f"disc {disc} has slipped out"):
        patch.check_frame()


def test_discs_too_soft_for_the_pressure_are_said_to_be() -> None:
    with pytest.raises(OverlapError, match="overlap"):
        confine(lattice_patch(SOIL_SPRINGS, RADIUS), 2.0 * KN)


def test_a_test_that_cannot_go_on_keeps_its_curve_and_says_why() -> None:
    """A lattice locks: its discs are pressed into each other until they may not be."""
    patch = lattice_patch(replace(SOIL_SPRINGS, allowed_overlap=0.03), RADIUS)
    confine(patch, 4e5)
    curve = load(patch, "biaxial", 4e5, 0.2, 1e-3, probe(patch, 4e5)[0])
    assert "overlap" in curve.stopped
    assert 0.005 < curve.strain[-1] < 0.1
    assert verdict(curve.resistance, True) == "stopped"


def test_as_json_holds_soil_beside_discs(sand: ElementTest) -> None:
    data = json.loads(json.dumps(sand.as_json(STRATUM), allow_nan=False))
    assert data["stratum"] == "sand"
    assert data["packing"] == "random"
    assert data["soil"] == pytest.approx({"E_Pa": 30e6, "nu": 0.3, "c_Pa": 5e3, "phi_deg": 35.0})
    assert data["assembly"]["E_Pa"] == sand.E
    assert data["assembly"]["phi_deg"] == pytest.approx(np.degrees(sand.phi))
    assert [t["pressure_Pa"] for t in data["tests"]] == [1e6, 2e6]
    assert data["verdicts"] == list(sand.verdicts)


def test_element_tests_hear_an_interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C ends the tests of all layers within an interval of each, not when all of them are through."""
    ended: list[ElementTest] = []
    is_started, heard = Event(), Event()

    def counted(sample: PatchSample, pressures: list[float]) -> ElementTest:
        is_started.set()
        ended.append(element_test(sample, pressures))
        return ended[-1]

    monkeypatch.setattr("dem.laboratory.element_table.element_test", counted)
    section = Section.read(SECTIONS / "s13.toml")
    layers = [replace(SOIL_SPRINGS, kn=4e6, ks=1.6e6, allowed_overlap=1.0)] * len(section.strata)
    element_test(PatchSample(layers[0], "lattice", RADIUS, size=(8, 8)), [1e4, 2e4], strain=0.01)  # compiled by then

    def press() -> None:
        """As a person does: once more where Python lost the first one, as it does within a finaliser."""
        is_started.wait()
        while not heard.wait(0.2):
            signal.pthread_kill(main_thread().ident, signal.SIGINT)  # type: ignore[arg-type]

    Thread(target=press, daemon=True).start()
    try:
        with pytest.raises((KeyboardInterrupt, SystemError)) as stopped:
            element_tests(section, layers, RADIUS)
    finally:
        heard.set()
        is_started.set()
    assert is_interrupt(stopped.value)  # which is what Python calls one that is heard as a kernel returns
    assert len(ended) < len(layers)  # of two for each


def test_quality_is_recorded(sand: ElementTest) -> None:
    assert 0.0 < sand.quality["unbalanced_median"] < 0.05
    assert 0.0 < sand.quality["inertial_number_largest"] < 5e-3
    assert sand.quality["pressure_error_rms"] < 0.05


def test_same_bits_twice_and_with_two_threads(sand: ElementTest) -> None:
    """Those of another seed differ: tests/verification/dem/test_element_tests.py."""
    again = element_test(sand.sample, [1e6, 2e6], strain=0.1, threads=2)
    assert again.as_json(STRATUM) == sand.as_json(STRATUM)
