"""A narrow edge of a layer without cohesion is no shallow failure of a face."""

from fem.settings import FemSettings
from tests.support.answers import bounds as strict_bounds
from tests.support.answers import fem, results
from tests.support.sections import analysed, slope
from workflow.report.bounds_text import bounds_sentences
from workflow.report.console import comparison_sentences
from workflow.results.bounds import BoundsAnswer, SafetyPart, ShallowBoundPart
from workflow.results.continuum import FactorOfSafety, FemAnswer, ShallowFailurePart


def elements(width: float) -> str:
    face = ShallowFailurePart(stratum="Liner", start_x_m=32.9, end_x_m=32.9 + width, angle_deg=18.0, kh=-0.1)
    settings = FemSettings(least_depth=0.5)
    answer = FemAnswer.model_construct(
        associated=None, opposite=None, shallow_failures=(face,), kc=0.115, settings=settings
    )
    [messages] = comparison_sentences(answer)
    return messages


def bounds(width: float, *reported_faces: ShallowFailurePart) -> str:
    face = ShallowBoundPart(stratum="Liner", start=32.9, end=32.9 + width, kh=0.05)
    answer = BoundsAnswer.model_construct(
        shallow_failures=(face,), shallow=None, least_depth=0.5, load_ends=(), water_exits=(), description="0.1 <= Kh",
        verdict="bracketed", safety=(), substitute=None,
    )  # fmt: skip
    reported = FemAnswer.model_construct(shallow_failures=reported_faces, safety_factors=(), after_shaking=None)
    return next(iter(bounds_sentences(answer, reported)))


def test_seven_centimetres_of_a_liner_are_an_edge() -> None:
    assert elements(0.07) == (
        'The edge of "Liner", 0.07 m wide where it comes out of the ground at x = 32.9 m, has no cohesion and '
        "fails locally by its own weight: this is no slope failure."
    )
    assert bounds(0.07).startswith('The edge of "Liner", 0.07 m wide')
    assert "fails locally at Kh = 0.050" in bounds(0.07)


def test_three_metres_are_a_face() -> None:
    assert elements(3.0).startswith('Shallow failure of the face of "Liner" from x = 32.9')
    assert bounds(3.0).startswith('Shallow failure of the face of "Liner" from x = 32.9')


def test_a_face_is_compared_with_the_critical_kh_that_counts() -> None:
    """A bank of loose sand: "the slope as a whole fails at 0.085" stood below a critical Kh of at most 0.082."""
    run = analysed(slope())
    face = ShallowFailurePart(stratum="Sand", start_x_m=32.9, end_x_m=35.9, angle_deg=34.0, kh=-0.1)
    answer = fem(run, 0.085).model_copy(update={"shallow_failures": (face,)})
    (alone,) = comparison_sentences(answer)
    assert alone.endswith("the slope as a whole fails at 0.085.")
    (bounded,) = comparison_sentences(answer, results(run, fem=answer, bounds=strict_bounds(run, 0.0782, 0.0824)))
    assert bounded.endswith("the slope as a whole fails at 0.082.")


def test_a_face_that_the_elements_report_is_not_reported_again_by_the_bounds() -> None:
    """The same sentence stood twice below `noshiro fem --safety-factor`."""
    face = ShallowFailurePart(stratum="Liner", start_x_m=32.9, end_x_m=32.9 + 3.0, angle_deg=18.0, kh=0.05001)
    assert bounds(3.0, face) == "The bounds below are for failures deeper than 0.5 m."
    other = face.model_copy(update={"kh": 0.06})
    assert bounds(3.0, other).startswith("Shallow failure of the face")


def test_a_factor_of_the_face_that_the_elements_report_is_not_reported_again_by_the_bounds() -> None:
    """The elements had "fails in a shallow failure at a smaller factor, 1.090", the bounds "fails before, at 1.090"."""
    part = SafetyPart(kh=0.0, lower=1.282, upper=1.288, cells=100, shallow_failure=1.0904)
    answer = BoundsAnswer.model_construct(
        shallow_failures=(), shallow=None, least_depth=0.5, load_ends=(), water_exits=(), description="0.1 <= Kh",
        verdict="bracketed", safety=(part,), after_shaking=None, substitute=None,
    )  # fmt: skip
    is_reported = {}
    for factor in (1.0902, 1.05, None):
        row = FactorOfSafety.model_construct(kh=0.0, after_shaking=False, shallow_failure=factor)
        elements = FemAnswer.model_construct(shallow_failures=(), safety_factors=(row,), after_shaking=None)
        is_reported[factor] = "fails before, at 1.090 at most" in " ".join(bounds_sentences(answer, elements))
    assert is_reported == {1.0902: False, 1.05: True, None: True}
    assert "fails before, at 1.090 at most" in " ".join(bounds_sentences(answer))
