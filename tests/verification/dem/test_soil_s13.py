"""Soil discs on S-13: a prediction without any factor, and slides that come to rest."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.integrate import trapezoid

from dem.laboratory.element_test_programme import ElementTestProgramme, compressed
from dem.laboratory.layer_check import LayerCheck
from dem.laboratory.soil_contacts import LARGEST_STIFFNESS, SoilLayer, soil_layers
from dem.model import DiscModel
from dem.search.critical import Search
from dem.search.deposit import Deposit, deposit
from dem.search.levelling import misfit
from dem.search.pushover import Continuum, pushover_critical_kh
from dem.slides.balance import AREA_TOLERANCE
from dem.slides.liquefaction import Slider
from dem.slides.slide import Slide
from dem.slides.slip import compare, slip_surface
from dem.slides.surface import Surface
from fem.search.dem_counterpart import non_associated_path
from meshes.executor import SERIAL
from meshes.gmsh_model import generate
from tests.support import SECTIONS
from workflow.config import Config
from workflow.config.after_triggering import load_config
from workflow.stages.shaking import shaking_of

pytestmark = pytest.mark.slow

KC = 0.339  # finite elements, fixed sides, psi = 0 as it is; Davis's substitute gives 0.314
YIELDING = 0.243  # m, where it has come to 0.99 of that
LIQUEFIED = [3, 5]


@pytest.fixture(scope="module")
def run() -> Config:
    return Config.load(SECTIONS / "s13.toml")


@pytest.fixture(scope="module")
def layers(run: Config) -> list[SoilLayer]:
    return soil_layers(run.section)


@pytest.fixture(scope="module")
def ground(run: Config, layers: list[SoilLayer]) -> Deposit:
    return deposit(run.section, run.dem, layers)


@pytest.fixture(scope="module")
def checks(run: Config, layers: list[SoilLayer]) -> dict[str, LayerCheck]:
    programme = ElementTestProgramme(layers, run.dem.mean_radius(run.section))
    layer_checks = programme.checks(SERIAL.compute(compressed, programme.tasks))
    return {check.stratum: check for check in layer_checks}


@pytest.fixture(scope="module")
def displaced(run: Config, ground: Deposit) -> tuple[Search, DiscModel]:
    return pushover_critical_kh(ground.settled, ground.ground, run.dem, Continuum(KC, YIELDING), threads=2)


@pytest.fixture(scope="module")
def with_shaking() -> Config:
    """S-13 in the cycles of its earthquake. A Kh of 0.1, held for ever, is its limit load after liquefaction."""
    return load_config(SECTIONS / "s13.toml")


@pytest.fixture(scope="module")
def slides(with_shaking: Config, ground: Deposit) -> list[Slide]:
    start, cases = ground.settled, with_shaking.slide.cases[::2]
    shaking = shaking_of(with_shaking, LIQUEFIED)
    sliders = [Slider(start, ground.ground, LIQUEFIED, case, with_shaking.slide, shaking=shaking) for case in cases]
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(Slider.run, sliders))


def test_sands_are_the_soil(checks: dict[str, LayerCheck], layers: list[SoilLayer]) -> None:
    """On average E within 20 %, the angle within 2 degrees; E of one layer scatters by 10 %, its strength by 7 %. Where
    E is beyond what contacts of LARGEST_STIFFNESS times the stress give, E / kn = 0.493 (kappa / 400)^-0.22, it is
    that.

    At the layer's stress four fifths of the peak are left at 15 % of compression.
    """
    sands = [check for check in checks.values() if check.c_soil_Pa == 0.0]
    assert len(sands) == 7
    stiffest = {
        soil.stratum.name: 0.493 * LARGEST_STIFFNESS * (LARGEST_STIFFNESS / 200.0) ** -0.22 * soil.stress
        for soil in layers
    }
    moduli = [min(check.E_soil_Pa, stiffest[check.stratum]) for check in sands]
    for check, modulus in zip(sands, moduli, strict=True):
        assert check.E_discs_Pa == pytest.approx(modulus, rel=0.3)
        assert check.phi_discs_deg == pytest.approx(check.phi_soil_deg, abs=3.0)
    ratios = [check.E_discs_Pa / modulus for check, modulus in zip(sands, moduli, strict=True)]
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.2)
    assert np.mean([check.phi_discs_deg for check in sands]) == pytest.approx(35.0, abs=2.0)
    left = [check.strength_discs_Pa[-1] / check.peak_discs_Pa[-1] for check in sands]
    assert min(left) > 0.7  # layer 1: 0.71, 0.78, 0.85 with four, eight, twelve patches
    assert np.mean(left) > 0.8


def test_clays_are_the_soil(checks: dict[str, LayerCheck]) -> None:
    """Their strength does not go with the stress, not even where it is ten times that, as in layer 2."""
    for name in ("2 Ac1", "7 Ac2"):
        check = checks[name]
        assert check.E_discs_Pa == pytest.approx(check.E_soil_Pa, rel=0.25)
        assert check.strength_discs_Pa == pytest.approx(check.strength_soil_Pa, rel=0.08)
        assert check.strength_discs_Pa[-1] > 0.8 * check.peak_discs_Pa[-1]


def test_the_ground_is_the_sections(run: Config, ground: Deposit) -> None:
    """In every column of two diameters, and its area, below the tops of the discs, within 1 %."""
    assert ground.ground.section is not None
    away = misfit(ground.ground.section, ground.settled, ground.ground.radius)
    assert abs(away.mean()) < 0.15
    assert np.abs(away).mean() < 0.2 * ground.ground.radius
    assert np.abs(away).max() <= 0.6 * ground.ground.radius
    x, top = Surface.of(ground.settled, ground.ground).points(ground.settled, ground.ground).T
    missing = trapezoid(np.interp(x, *run.section.ground.T) - top, x)
    assert abs(missing) < 0.01 * run.section.layering.areas().sum()


def test_the_critical_kh_is_predicted(displaced: tuple[Search, DiscModel]) -> None:
    kc = displaced[0].kc
    assert kc is not None
    assert 0.85 <= kc / KC <= 1.15


def test_discs_fail_where_the_continuum_does(
    run: Config, layers: list[SoilLayer], ground: Deposit, displaced: tuple[Search, DiscModel]
) -> None:
    """With fixed sides and psi as given. Three packings: 3.1, 3.0 and 1.8 m; from the slip surface of Davis's
    substitute, which weakens sand and leaves clay alone, 7.7, 8.6 and 6.2 m."""
    wish = run.fem.changed(direction="downhill", sides="fixed")
    continuum, line = non_associated_path(run.section, generate(run.section, run.mesh), wish)
    assert continuum.kc == pytest.approx(KC, abs=0.002)
    surfaces = [slip_surface(displaced[1], ground.settled, ground.ground)]
    for seed in (1, 2):
        settings = run.dem.model_copy(update={"seed": seed})
        other = deposit(run.section, settings, layers)
        failed = pushover_critical_kh(other.settled, other.ground, settings, Continuum(KC, YIELDING), threads=2)[1]
        surfaces.append(slip_surface(failed, other.settled, other.ground))
    apart = [compare(run.section, surface, line) for surface in surfaces]
    assert np.mean([item.mean_distance_m for item in apart if item is not None]) < 3.0
    assert None not in apart


def test_slides_come_to_rest_where_one_can_believe_it(slides: list[Slide]) -> None:
    for slide in slides:
        assert slide.settled
        assert slide.seconds_simulated <= 60.0  # 29
        assert slide.overlap < 0.5
        assert slide.escaped == 0
        assert slide.area_lost_share < AREA_TOLERANCE
    # The stiffness of the paper's cases does not count for sand that keeps a residual strength. It slides 1.14 m by the
    # limiting strains of 25 and 16 % of its blow counts, 1.07 and 1.14 m in other packings, about 3 m in the field.
    first, last = (slide.rows[-1] for slide in slides)
    assert first.slide_max_m == last.slide_max_m
    assert 0.9 < first.slide_max_m < 1.4
    assert 0.15 < first.settlement_uphill_m < 0.4  # 0.23


def test_ground_that_does_not_liquefy_hardly_moves(with_shaking: Config, ground: Deposit) -> None:
    """Cycles of Kh = 0.17 are half the critical Kh: 0.1 to 0.3 m where most, 0.4 to 0.8 m on a rigid base."""
    slide = Slider(
        ground.settled, ground.ground, [], None, with_shaking.slide, shaking=shaking_of(with_shaking, [])
    ).run()
    assert slide.rows[-1].slide_max_m < 0.35
    assert slide.rows[-1].slide_middle_m < 0.15


def test_discs_of_half_the_radius_slide_as_far(
    run: Config, with_shaking: Config, layers: list[SoilLayer], slides: list[Slide]
) -> None:
    """0.80 m for 0.95 m; material points 0.95 m."""
    dem = run.dem.model_copy(update={"radius": 0.5 * run.dem.mean_radius(run.section)})
    fine = deposit(run.section, dem, layers)
    shaking = shaking_of(with_shaking, LIQUEFIED)
    slider = Slider(
        fine.settled, fine.ground, LIQUEFIED, with_shaking.slide.cases[0], with_shaking.slide, shaking=shaking
    )
    slide = slider.run(threads=2)
    assert slide.settled
    assert slide.rows[-1].slide_max_m == pytest.approx(slides[0].rows[-1].slide_max_m, rel=0.3)
