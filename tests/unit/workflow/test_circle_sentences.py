"""What is said of slip circles."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from meshes.section.section import Section
from tests.support.answers import bounds, results
from tests.support.sections import analysed, layer, slope
from workflow.config import Config
from workflow.estimates.slices import LEFT
from workflow.estimates.slip_circles import SlipCircle, critical_circle
from workflow.report.circles import against_elements, of_circles, of_longer_sections
from workflow.report.slices import contradicted_circles, slices_sentences
from workflow.results.bounds import DirectionPart, SafetyPart
from workflow.results.continuum import FactorOfSafety, FemAnswer, StoredState
from workflow.results.slices import CirclePart, FactorCircles, LongerCircle, SlicesAnswer
from workflow.run.record import Entry
from workflow.stages.slices import _circle_parts, _is_endless


@pytest.fixture
def run() -> Config:
    return analysed(slope())


@pytest.mark.parametrize(("kh", "fails"), [(-0.039, True), (0.039, False)])
def test_a_negative_critical_kh_is_told_to_be_a_failure_without_shaking(kh: float, fails: bool) -> None:
    circle = CirclePart.model_construct(
        surface_m=((28.0, 30.0), (72.0, 12.0)), towards="right", bishop=kh, spencer=kh, strengthened=False
    )
    answer = SlicesAnswer.model_construct(factors=(), critical=(circle,), reason="", weak_layers=(), strong_blocks=())
    (sentence,) = slices_sentences(answer)
    assert f"{kh:.3f} by Bishop's method" in sentence
    assert sentence.endswith("the ground fails without shaking.") == fails


def test_only_the_side_that_fails_without_shaking_is_said_to_do_so() -> None:
    """ "To the left 0.379: the ground fails without shaking" stood beside a failure to the right."""

    def circle(towards: str, kh: float) -> CirclePart:
        line = ((28.0, 30.0), (72.0, 12.0))
        return CirclePart.model_construct(surface_m=line, towards=towards, bishop=kh, spencer=kh, strengthened=False)

    answer = SlicesAnswer.model_construct(
        factors=(),
        critical=(circle("right", -0.066), circle("left", 0.379)),
        reason="",
        weak_layers=(),
        strong_blocks=(),
    )
    (sentence,) = slices_sentences(answer)
    right, left = sentence.split("; ")
    assert right.endswith("-0.066 by Spencer's (the ground fails without shaking)")
    assert left.endswith("0.379 by Spencer's.")


def test_a_circle_without_a_balance_by_spencers_method_is_said_to_have_none() -> None:
    """Clay of 24 kPa, 6.1 m at 45° on rock: constant inclinations of side forces give 1.258 or more by forces, 1.242 by
    moments; the solver of xslope ends without a result, too. Bishop's number stood alone, without a word."""
    soil = layer(
        "Clay", cohesion="24 kPa", friction_angle="0 deg", density_ordinary="2 t/m^3", density_seismic="2 t/m^3"
    )
    clay = Section.parse(
        {"name": "cut", "surface": [[0, 0], [6.1, 6.1], [30, 6.1]], "base": {"elevation": 0}, "strata": [soil]}
    )
    circle = critical_circle(clay, LEFT)
    assert circle is not None
    assert circle.frictionless
    assert circle.spencer is None
    parts = _circle_parts(clay, 0.0, [(clay, circle)])
    group = FactorCircles(kh=0.0, circles=parts)
    answer = SlicesAnswer.model_construct(factors=(group,), critical=(), reason="", weak_layers=(), strong_blocks=())
    (sentence,) = slices_sentences(answer)
    assert sentence.endswith(
        "which without friction follows from moments alone (no balance of forces by Spencer's method)."
    )


def test_a_side_whose_circles_have_next_to_no_strength_is_told() -> None:
    """Pore pressure of the whole weight: no factor above 0, which was left out, with a warning of NumPy."""
    soil = layer("Sand", cohesion=0, friction_angle="30 deg", pore_pressure_ratio=1.0)
    sand = Section.parse(
        {"name": "ru", "surface": [[0, 10], [20, 10], [40, 20], [60, 20]], "base": {"elevation": 0}, "strata": [soil]}
    )
    with warnings.catch_warnings(action="error"):
        assert critical_circle(sand, LEFT) is None
        circle = critical_circle(sand, LEFT, None)
    assert circle is not None
    critical = _circle_parts(sand, None, [(sand, circle)])
    assert critical[0].bishop < 0.0
    answer = SlicesAnswer.model_construct(
        factors=(FactorCircles(kh=0.0, circles=()),), critical=critical, reason="", weak_layers=(), strong_blocks=()
    )
    sentences = list(slices_sentences(answer))
    assert sentences[0].startswith("Towards the left no slip circle has a factor of safety at Kh = 0")
    assert not any("no slip circle" in text for text in slices_sentences(answer, rises_by_shaking=True))


def test_slip_circles_above_a_strict_upper_bound_are_told(run: Config) -> None:
    """A slope on a seam: 1.06 by circles, which cannot follow it, and 0.713 to 0.721 by bounds."""

    def circles(factor: float, kc: float) -> SlicesAnswer:
        item = [
            CirclePart.model_construct(towards="right", bishop=value, spencer=None, surface_m=((0.0, 0.0), (9.0, 0.0)))
            for value in (factor, kc)
        ]
        factors = (FactorCircles.model_construct(kh=0.0, circles=(item[0],)),)
        return SlicesAnswer.model_construct(factors=factors, critical=(item[1],), faces=(), reason="")

    strict = bounds(run, 0.22, 0.26).model_copy(
        update={"safety": (SafetyPart(kh=0.0, lower=1.7, upper=1.72, cells=9),)}
    )
    both = run.with_settings("fem", direction="both")
    first, second = of_circles(results(both, slices=circles(2.1, 0.4), bounds=strict))
    assert first.startswith(
        "slip circles have a factor of safety of 2.10 at Kh = 0, above the strict upper bound of 1.72"
    )
    assert second.startswith("slip circles have a critical Kh of 0.400, above the strict upper bound of 0.260")
    console = list(contradicted_circles(results(both, slices=circles(2.1, 0.4), bounds=strict)))
    assert console[1].startswith("Warning: Slip circles have a critical Kh of 0.400, above the strict upper bound")
    assert ". To do: rely on finite elements and bounds" in console[1]
    assert first.endswith("the critical mechanism is no circle, for example along a weak layer")
    strata = [stratum.model_copy(update={"tension": 0.0}) for stratum in both.section.strata]
    cut_off = both.model_copy(update={"section": both.section.with_strata(strata)})
    first, second = of_circles(results(cut_off, slices=circles(2.1, 0.4), bounds=strict))
    for text in (first, second):  # both blamed a weak layer in one soil
        assert text.endswith("since circles have no tension cut-off, or give a [tension_crack], at which they end")
    assert list(of_circles(results(both, slices=circles(1.75, 0.27), bounds=strict))) == []
    assert list(of_circles(results(both, bounds=strict))) == []


def test_slip_circles_below_a_strict_lower_bound_are_told_with_the_ground_that_they_cut(run: Config) -> None:
    """A road embankment on soft clay: 0.031 by circles, 0.043 to 0.046 by bounds, 1.12 and 1.13 to 1.15 at rest."""
    fill = layer("Fill", cohesion="7 kPa", friction_angle="32 deg", bottom={"elevation": 0.0})
    clay = layer("Clay", cohesion="23 kPa", friction_angle="0 deg")
    ground = Section.parse({
        "name": "road", "surface": [[0, 0], [33, 0], [46, 6.5], [56, 6.5], [69, 0], [102, 0]],
        "base": {"elevation": -10.3}, "strata": [fill, clay],
    })  # fmt: skip
    surface = ((20.0, 0.0), (38.0, -10.0), (56.0, -2.0), (58.7, 5.2))

    def circles(kc: float, surface: tuple[tuple[float, float], ...] = surface) -> SlicesAnswer:
        item = CirclePart.model_construct(towards="left", bishop=kc, spencer=None, surface_m=surface)
        return SlicesAnswer.model_construct(factors=(), critical=(item,), faces=(), reason="")

    both = run.with_settings("fem", direction="both").model_copy(update={"section": ground})
    strict = bounds(run, 0.043, 0.046)
    (messages,) = of_circles(results(both, slices=circles(0.031), bounds=strict))
    assert messages.startswith("slip circles have a critical Kh of 0.031, below the strict lower bound of 0.043")
    assert 'cut steeply through "Fill"' in messages
    assert list(of_circles(results(both, slices=circles(0.042), bounds=strict))) == []
    (messages,) = of_circles(results(both, slices=circles(0.031, surface[:3]), bounds=strict))
    assert "although the circles cut no ground with friction steeply" in messages


def test_a_soil_that_cracks_part_is_named_once_where_circles_cut_it_steeply(run: Config) -> None:
    """A cut of loess with a tension crack: circles cut steeply through "Loess" and "Loess"."""
    loess = layer("Loess", cohesion="30 kPa", friction_angle="28 deg")
    data = {"name": "cut", "surface": [[0, 12], [20, 12], [22, 0], [45, 0]], "base": {"elevation": -6}}
    cracked = Config.parse({**data, "strata": [loess], "tension_crack": {"bottom": {"depth": 3.0}}}).section
    line = ((15.0, 12.0), (18.0, 4.0), (22.0, 0.0))
    item = CirclePart.model_construct(towards="right", bishop=-0.032, spencer=None, surface_m=line)
    circles = SlicesAnswer.model_construct(factors=(), critical=(item,), faces=(), reason="")
    both = run.with_settings("fem", direction="both").model_copy(update={"section": cracked})
    (message,) = of_circles(results(both, slices=circles, bounds=bounds(run, -0.012, -0.006)))
    assert 'steeply through "Loess", where' in message


def test_circles_are_not_compared_with_a_bound_that_is_no_number(run: Config) -> None:
    """An embankment on soft clay whose two faces fail at F = 0.74: circles of -0.084 were "above the strict upper bound
    of -4901.453"."""
    item = CirclePart.model_construct(towards="left", bishop=-0.084, spencer=None, surface_m=((0.0, 0.0), (9.0, 0.0)))
    circles = SlicesAnswer.model_construct(factors=(), critical=(item,), faces=(), reason="")
    both = run.with_settings("fem", direction="both")
    endless = bounds(run, 0.0, 0.0).model_copy(update={"lower": None, "upper": -4901.453})
    assert list(of_circles(results(both, slices=circles, bounds=endless))) == []
    (message,) = of_circles(results(both, slices=circles, bounds=endless.model_copy(update={"upper": -0.12})))
    assert "above the strict upper bound of -0.120" in message


def test_level_ground_that_slides_out_at_a_side_explains_circles_above_the_bounds(run: Config) -> None:
    item = CirclePart.model_construct(towards="left", bishop=0.19, spencer=None, surface_m=((0.0, 0.0), (9.0, 0.0)))
    circles = SlicesAnswer.model_construct(factors=(), critical=(item,), faces=(), reason="")
    strict = bounds(run, 0.13, 0.14)
    first = DirectionPart(direction="downhill", towards="left", lower=0.13, upper=0.14, leaves=("right",), history=())
    strict = strict.model_copy(update={"directions": (first,), "sides": "free-field"})
    (messages,) = of_circles(results(run.with_settings("fem", direction="both"), slices=circles, bounds=strict))
    assert "slides out at the right side" in messages


def test_a_circle_that_a_side_cuts_off_is_told_with_the_length_that_is_missing() -> None:
    longer = LongerCircle(side="left", past_m=12.2, beyond_m=60.0, bishop=0.0975)
    item = CirclePart.model_construct(towards="left", bishop=0.111, longer=longer)
    (messages,) = of_longer_sections((item,))
    assert "0.098 instead of 0.111" in messages
    assert "add 15 m to beyond" in messages  # a file with beyond = "30 m" was told to set 28 m, which shortened it
    whole = item.model_copy(update={"surface_m": ((0.0, 5.0), (9.0, 0.0)), "spencer": 0.115, "strengthened": False})
    answer = SlicesAnswer.model_construct(
        factors=(), critical=(whole,), reason="", after_shaking=None, endless=False, weak_layers=(), strong_blocks=()
    )
    first = next(slices_sentences(answer))
    assert "0.115 by Spencer's, and 0.098 by Bishop's in a longer section." in first, "the sentence on the critical Kh"
    alike = item.model_copy(update={"longer": longer.model_copy(update={"bishop": 0.110})})
    assert list(of_longer_sections((alike,))) == []
    weaker = CirclePart.model_construct(towards="right", bishop=0.05, longer=None)
    assert list(of_longer_sections((item, weaker))) == [], "the other direction fails at half of that"


def test_circles_of_an_endless_slope_are_warned_of(run: Config) -> None:
    """A slope with periodic sides had 2.21 by circles, and 1.807 to 1.815 by strict bounds; a longer section was
    advised."""
    assert _is_endless(run.with_settings("fem", sides="periodic"))
    assert not _is_endless(run.with_settings("fem", sides="smooth"))
    level = {**slope(), "surface": [[0, 30], [40, 35], [60, 35], [100, 30]]}
    assert not _is_endless(analysed(level).with_settings("fem", sides="periodic"))
    circle = CirclePart.model_construct(
        surface_m=((28.0, 30.0), (72.0, 12.0)), towards="right", bishop=0.27, spencer=None, strengthened=False
    )
    answer = SlicesAnswer.model_construct(
        factors=(), critical=(circle,), reason="", weak_layers=(), strong_blocks=(), endless=True
    )
    _, warning = slices_sentences(answer)
    assert warning.startswith("Warning: The slope continues beyond its periodic sides")


def test_circles_far_from_the_elements_are_told_with_the_surface_of_the_elements(run: Config) -> None:
    """A levee: 1.65 and 0.119 by circles, 1.36 and 0.078 by elements, which slip along the face below water."""

    def circles(factor: float, kc: float) -> SlicesAnswer:
        item = [
            CirclePart.model_construct(towards="right", bishop=value, spencer=None, surface_m=((0.0, 0.0), (9.0, 0.0)))
            for value in (factor, kc)
        ]
        factors = (FactorCircles.model_construct(kh=0.0, circles=(item[0],)),)
        return SlicesAnswer.model_construct(factors=factors, critical=(item[1],), faces=(), reason="")

    line = ((39.9, 5.8), (42.7, 6.5), (45.5, 7.8))
    state = StoredState.model_construct(slip_surface=line, past_equilibrium=False)
    factor = FactorOfSafety.model_construct(kh=0.0, factor=1.36, slip_surface=line)
    fem = FemAnswer.model_construct(
        kc=0.078, verdict="plateau", flow="associated", at_sides=(), states=(state,), safety_factors=(factor,)
    )
    both = run.with_settings("fem", direction="both")
    first, second = against_elements(results(both, slices=circles(1.65, 0.119), fem=fem))
    start = (
        "slip circles have a factor of safety of 1.65 at Kh = 0, while finite elements have 1.36, which slip "
        "from x = 39.9 to"
    )
    assert first.startswith(start)
    assert second.startswith("slip circles have a critical Kh of 0.119, while finite elements have 0.078, which slip")
    assert second.endswith("rely on the finite elements, whose slip surface is no circle")
    assert list(against_elements(results(both, slices=circles(1.4, 0.08), fem=fem))) == []
    (cautious,) = against_elements(results(both, slices=circles(1.2, 0.08), fem=fem))
    assert cautious.endswith("find strict bounds (bounds.run), and report the circles as the more cautious result")
    strict = bounds(run, 0.077, 0.079)  # these contradict the circles already
    (factors,) = against_elements(results(both, slices=circles(1.65, 0.119), fem=fem, bounds=strict))
    assert "factor of safety" in factors


@pytest.mark.parametrize(("kh", "value", "count"), [(None, 3.689, 0), (None, 0.9, 1), (0.0, 3.5, 1), (0.0, 12.0, 0)])
def test_a_circle_in_level_ground_is_no_failure(kh: float | None, value: float, count: int, run: Config) -> None:
    """Two metres of level ground at a side had a critical Kh of 3.689."""
    line = np.array([[0.0, 19.0], [2.0, 19.0]])
    circle = SlipCircle("left", (1.0, 30.0), 11.0, line, kh, value, None)
    assert len(_circle_parts(run.section, kh, ((run.section, circle),))) == count


@pytest.mark.parametrize(
    ("factor", "reason", "warned"),
    [
        (1.11, "the section fails under its own weight; its factor of safety is 0.92 with ψ = φ", True),
        (0.95, "the section fails under its own weight", False),
        (1.11, "no state on the path is in equilibrium", False),
    ],
)
def test_circles_that_stand_where_the_elements_fail_are_warned_of(
    run: Config, factor: float, reason: str, warned: bool
) -> None:
    """On a soft lens circles had a factor of safety of 1.11 without a word, where the elements had failed at 0.92."""
    circle = CirclePart.model_construct(
        towards="right", bishop=factor, spencer=None, surface_m=((28.0, 30.0), (72.0, 12.0)), strengthened=False
    )
    group = FactorCircles.model_construct(kh=0.0, circles=(circle,))
    answer = SlicesAnswer.model_construct(factors=(group,), critical=(), faces=(), reason="")
    known = replace(results(run, slices=answer), ends={"fem": Entry({}, "no answer", reason)})
    texts = list(contradicted_circles(known))
    assert [text.startswith("Warning: Slip circles have a factor of safety of 1.11") for text in texts] == [
        True
    ] * warned
    assert all(f"while finite elements find that {reason}. To do: rely on the finite" in text for text in texts)
