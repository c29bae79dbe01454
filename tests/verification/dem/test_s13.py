"""The discs of S-13 with the springs of Table 2, against the paper (Sec. 4(2), 4(3), Figs 12 to 16)."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from dem.ground import Ground, ground_of, springs_of
from dem.model import DiscModel
from dem.search.critical import Search, critical_kh
from dem.search.equilibrium import KhRise, settle, try_kh, unbalanced_ratio
from dem.settings import SlideSettings
from dem.slides.liquefaction import Slider
from dem.slides.slide import Slide
from dem.slides.slip import cracked_shares
from tests.support import SECTIONS
from workflow.config import Config

pytestmark = pytest.mark.slow

WITHIN = 0.3
ASD = ("3 Asd", "4 Asd", "5 Asd")


@pytest.fixture(scope="module")
def run() -> Config:
    """The section with the paper's own discs."""
    whole = Config.load(SECTIONS / "s13.toml")
    return whole.model_copy(update={"dem": whole.dem.as_paper()})


@pytest.fixture(scope="module")
def ground(run: Config) -> Ground:
    return ground_of(run.section, run.dem)


@pytest.fixture(scope="module")
def settled(run: Config, ground: Ground) -> DiscModel:
    return settle(ground, springs_of(run.section, run.dem, ground.radius), run.dem)


@pytest.fixture(scope="module")
def search(run: Config, ground: Ground, settled: DiscModel) -> Search:
    return critical_kh(settled, ground, run.dem, threads=2)


@pytest.fixture(scope="module")
def slides(run: Config, ground: Ground, settled: DiscModel) -> list[Slide]:
    cases = [None, *run.slide.cases]
    sliders = [Slider(settled, ground, [3, 5] if case else [], case, run.slide) for case in cases]
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(Slider.run, sliders))


def test_settled(settled: DiscModel) -> None:
    assert unbalanced_ratio(settled) < 1e-4
    assert (settled.pore_length > 0.0).sum() > 3 * 3180 * 0.9


def test_stands_at_0_2_and_breaks_along_the_asd_layers_at_0_3(
    run: Config, ground: Ground, settled: DiscModel, search: Search
) -> None:
    """Figs 12 and 13."""
    model = settled.copy()
    assert try_kh(model, settled, ground, run.dem, KhRise(0.0, 0.2, search.flexibility_m), 2).verdict == "stands"
    model = settled.copy()
    try_kh(model, settled, ground, run.dem, KhRise(0.0, 0.3, search.flexibility_m), 2)
    shares = cracked_shares(model)
    assert max(shares[name] for name in ASD) > 0.1


def test_critical_kh_of_table_2(search: Search) -> None:
    """0.308 here; stands at 0.30 and fails at 0.32 in paper-notes' prototype. The paper only has 0.2 and 0.3."""
    assert search.verdict == "bracketed"
    assert search.kc_upper is not None
    assert search.kc_upper - search.kc_lower <= 0.005 * (1.0 + 1e-9)
    assert search.kc_lower >= 0.295
    assert search.kc_upper <= 0.325


def test_slides_of_table_2(slides: list[Slide]) -> None:
    """Largest slide 3.3 and 4.9 m in cases 2 and 3, case 1 only uphill; settlement 1.0 m in case 3 (Sec. 4(3))."""
    alone, *cases = slides
    assert all(slide.escaped == 0 for slide in cases)
    item, two, three = (slide.as_json(alone) for slide in cases)
    assert two["slide_max_m"] == pytest.approx(3.3, rel=WITHIN)
    assert three["slide_max_m"] == pytest.approx(4.9, rel=WITHIN)
    assert item["slide_max_m"] < 0.5
    assert item["slides_over_share_uphill"] > 2.0 * item["slides_over_share_downhill"]
    assert three["settlement_uphill_m"] == pytest.approx(1.0, rel=WITHIN)
    drops = [case["settlement_uphill_m"] for case in (item, two, three)]
    assert drops == sorted(drops)
    assert three["slides_over_share"] > 0.8


def test_the_chain_has_the_same_bits_twice(run: Config, ground: Ground, settled: DiscModel) -> None:
    again = settle(ground, springs_of(run.section, run.dem, ground.radius), run.dem)
    assert (again.x == settled.x).all()
    settings = SlideSettings(duration=5.0)
    case = run.slide.cases[2]
    iterate = Slider(settled, ground, [3, 5], case, settings).run(threads=1)
    two = Slider(again, ground, [3, 5], case, settings).run(threads=2)
    assert iterate == two
