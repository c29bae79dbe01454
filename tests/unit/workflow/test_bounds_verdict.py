"""What is said of bounds, for every reason for which their search ends."""

import math
from typing import get_args

import pytest

from fem.limit.bracket import EndReason, MeshBounds, OpenEnd
from fem.limit.directions import DirectionBounds, SmallerKhBounds
from fem.limit.safety_bounds import SafetyBounds
from fem.settings import BoundsSettings
from tests.support.answers import bounds
from tests.support.sections import analysed, slope
from workflow.results.bounds import BoundsAnswer, BracketPart, SafetyPart
from workflow.stages.bounds import _reason, _verdict, bracket_part, in_words


class ComputedBounds(DirectionBounds):
    """Bounds without the fields that prove them."""

    lower, upper = -0.0733, 0.0608
    gap = 2.0


class Smaller(SmallerKhBounds):
    lower, upper = -0.0733, 0.0608
    gap = 2.0


def result(ended, leaves=()):
    notes = ("lower bound: the solver ended early (NumericalError)",)
    meshes = [MeshBounds(900, -0.0733, 0.0608, notes, 1.0, ("lower",))]
    item = ComputedBounds(None, None, meshes, None, ended, (1.0, 2.0), leaves=leaves)
    return Smaller(None, None, meshes, None, ended, (1.0, 2.0), directions=(item,))


REASONS = (*get_args(OpenEnd), "gap", "enough")


def test_all_reasons_are_looked_at():
    assert set(REASONS) == {reason for part in get_args(EndReason) for reason in get_args(part) or [part]}


@pytest.mark.parametrize("ended", [*REASONS, None])
def test_every_reason_has_its_words(ended):
    """Without "enough" this was KeyError, after 90 s, on a face of sand after drawdown."""
    part = bracket_part(result(ended), BoundsSettings())
    words = {
        "gap": "is within the required 0.0020 in Kh",
        "enough": "fails under its own weight: the critical Kh is at most 0.0608",
        "triangles": "900 triangles, 20000 allowed",
        "time": "more than the allowed computing work (60 s)",
        "stalled": "no longer reduce the gap",
        "solver": "the solver of cone programs failed on the last 2 meshes",
        None: "the other direction fails first",
    }
    assert words[ended] in part.reason
    assert (part.verdict == "unstable") == (ended == "enough")
    assert ended in ("gap", "enough") or "The gap of 0.1341 in Kh is above the required 0.0020 in Kh" in part.reason


def test_the_words_name_the_side_at_which_the_ground_slides_out_in_the_direction_that_counts():
    """Until now only the other direction had it; free-field sides give 0.049 where an endless slope has 0.067."""
    out = ", and the failing ground reaches the left side"
    assert bracket_part(result("triangles", ("left",)), BoundsSettings()).description.endswith(f"900 triangles{out}")
    assert out not in bracket_part(result("triangles"), BoundsSettings()).description


def test_notes_of_the_last_mesh_are_sentences():
    reason = bracket_part(result("time"), BoundsSettings()).reason
    assert reason.endswith(". Lower bound: the solver ended early (NumericalError).")


def test_a_bound_that_failed_on_the_last_mesh_is_not_reported_of_the_stated_bound():
    """A strict lower bound of a coarser mesh was stated beside "The lower bound does not hold"."""
    part = result("time")
    failed = ("lower bound: the solver ended early (NumericalError)", "the lower bound does not hold: beyond yield")
    part.meshes.append(MeshBounds(1800, None, 0.0608, failed, 1.0, ("lower",)))
    reason = bracket_part(part, BoundsSettings()).reason
    assert reason.endswith(f". The lower bound is that of a coarser mesh. On the last mesh: {'; '.join(failed)}.")


def test_ground_that_no_force_could_hold_has_no_kh():
    """An embankment of normally consolidated clay was told as "no lower bound <= Kh <= -9799.7651" on its way."""

    class Sinking(SmallerKhBounds):
        upper = -9799.7651

    meshes = result("triangles").meshes
    sinking = Sinking(None, object(), meshes, None, directions=(ComputedBounds(None, None, meshes, None),))
    assert in_words(sinking) == "it fails under its own weight, 900 triangles"


def test_where_one_direction_lacks_a_bound_the_other_one_is_reported():
    """A lower bound of the smaller Kh needs one in both directions; without it a bracket of 3 % was not reported."""

    class Bracketed(ComputedBounds):
        lower, upper = 0.0484, 0.0501

    class Missing(Smaller):
        gap = float("inf")

    without = result("solver")
    with_both = Bracketed(object(), object(), without.meshes, None, "gap", None, direction="downhill")
    smaller = Missing(
        None, None, without.meshes, None, "solver", (1.0, 2.0), directions=(with_both, *without.directions)
    )
    verdict, reason = _verdict(smaller, BoundsSettings())
    assert verdict == "no bracket"
    assert reason.endswith("With the seismic force downslope the critical Kh is bounded: 0.0484 <= Kh <= 0.0501.")


def test_bounds_of_one_quantity_count_where_another_has_none() -> None:
    """A dam had no lower bound of Kh in one direction: its bounds in the other one, and of its factor of safety, were
    thrown away, and "a finer mesh may give 11.8 % less" stood there."""
    run = analysed(slope())
    known = bounds(run, 0.1, 0.11)
    none = known.model_copy(update={
        "lower": None, "directions": (known.directions[0].model_copy(update={"lower": None}),), "verdict": "no bracket"
    })  # fmt: skip
    assert not none.has_interval
    assert none.model_copy(update={"directions": known.directions}).has_interval
    assert none.model_copy(update={"safety": (SafetyPart(kh=0.0, lower=1.3, upper=1.4, cells=100),)}).has_interval
    assert none.model_copy(update={"substitute": bracket(known)}).has_interval


def bracket(answer: BoundsAnswer) -> BracketPart:
    return BracketPart.model_validate({name: getattr(answer, name) for name in BracketPart.model_fields})


@pytest.mark.parametrize(
    ("lower", "upper", "words"),
    [
        (1.2, 1.3, "The bounds of the factor of safety are wider than the required 0.5 %"),
        (0.0, 1.252, "There is no lower bound of the factor of safety"),
        (0.0, math.inf, "There is no lower and no upper bound of the factor of safety"),
    ],
)
def test_a_missing_bound_of_a_factor_is_told_as_missing(lower: float, upper: float, words: str) -> None:
    """A quay with "FS <= 1.252" had "bounds wider than the required 0.5 %"."""
    answer = SafetyBounds(0.0, lower, upper, 900, [], end_reason="time")
    assert _reason(answer, BoundsSettings()) == f"{words}: the share of the allowed computing work (60 s) is used up."
