"""Studies against exact distributions and published indices."""

import csv
import io
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad

from fem.errors import NoEquilibriumError, UnstableError
from meshes.errors import NoAnswerError
from tests.support.sections import analysed, slope
from tests.support.tasks import Numbers, infinite_slope, ishigami
from workflow.config import Config
from workflow.report.study import _spread_words as where
from workflow.report.study import _strongest as strongest
from workflow.report.study import sentences
from workflow.results.cases import Spread
from workflow.results.study import Effect, Result, StudyAnswer
from workflow.study import parts, task
from workflow.study.ensemble import Ensemble
from workflow.study.fragility import curve, fit, fragility
from workflow.study.statistics import effects, probability
from workflow.study.study import _spread as spread_of
from workflow.study.table import SampleRow, SampleTable
from workflow.study.task import Task
from workflow.uncertain.distribution import Distribution
from workflow.uncertain.sampling import probabilities

COHESION, FRICTION = Distribution(lognormal=(12.0, 4.0)), Distribution(normal=(30.0, 3.0))


def exact(kh: float) -> float:
    """P(kc < kh) of the infinite slope: for every φ the chance that c is too small, integrated."""
    sigma = math.sqrt(math.log(1.0 + (4.0 / 12.0) ** 2))
    slope, fixed = math.tan(math.radians(20.0)), 18.0 * 5.0 * math.cos(math.radians(20.0)) ** 2

    def chance(friction: float) -> float:
        strength = math.tan(math.radians(friction))
        needed = (kh * (1.0 + slope * strength) - strength + slope) * fixed
        return float(stats.lognorm.cdf(needed, sigma, scale=12.0 * math.exp(-0.5 * sigma**2)))

    return float(quad(lambda f: chance(f) * stats.norm.pdf(f, 30.0, 3.0), 12.0, 48.0, limit=200)[0])


@pytest.mark.parametrize(
    ("method", "furthest"), [("sobol", 0.01), pytest.param("latin", 0.043, marks=pytest.mark.slow)]
)
def test_a_thousand_infinite_slopes_have_the_exact_distribution(method: str, furthest: float, tmp_path: Path) -> None:
    """In Kolmogorov's sense; 1.36 / sqrt(n) = 0.043 is what 95 % of independent samples keep within."""
    drawn = probabilities(2, 1000, method, 0)  # type: ignore[arg-type]
    tasks = [Task(infinite_slope, Numbers(values=(COHESION.at(c), FRICTION.at(f)))) for c, f in drawn]
    rows = Ensemble(tmp_path, 2).rows(tasks)
    kc = np.array([row.answer.value for row in rows if row.answer is not None])
    assert len(kc) == 1000
    over = np.quantile(kc, np.linspace(0.02, 0.98, 25))
    curve = probability("kc < Kh", over, kc[:, None] < over)
    truth = np.array([exact(kh) for kh in over])
    assert np.abs(np.array(curve.probability) - truth).max() < furthest
    assert np.all((np.array(curve.low) <= truth) & (truth <= np.array(curve.high)))


def test_sobol_indices_of_the_ishigami_function() -> None:
    """T. Ishigami & T. Homma (1990) with a = 7, b = 0.1: S = 0.3139, 0.4424, 0; S_T = 0.5576, 0.4424, 0.2437."""
    points = (2.0 * probabilities(3, 4096, "saltelli", 0) - 1.0) * math.pi
    rows = []
    for point in points:
        values = tuple(float(value) for value in point)
        result = task.Numbers(numbers={"y": ishigami(Numbers(values=values)).value})
        rows.append(SampleRow(dict(zip(("x1", "x2", "x3"), values, strict=True)), result))
    result = {
        effect.path: effect
        for effect in effects(SampleTable({"x1": "", "x2": "", "x3": ""}, rows), "y", (), indices=True)
    }
    assert [result[x].first_order for x in ("x1", "x2", "x3")] == pytest.approx([0.3139, 0.4424, 0.0], abs=0.01)
    assert [result[x].total_order for x in ("x1", "x2", "x3")] == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.01)
    for item in result.values():
        assert item.total_order_ci95 is not None
        assert item.total_order is not None
        assert item.total_order_ci95[0] < item.total_order < item.total_order_ci95[1]


def table_of(values: list[float | None], **drawn: list[object]) -> SampleTable:
    rows = [
        SampleRow({path: column[k] for path, column in drawn.items()}, task.Numbers(numbers={"kc": value}),
                  "" if value is not None else "no answer")
        for k, value in enumerate(values)
    ]  # fmt: skip
    return SampleTable(dict.fromkeys(drawn, ""), rows)


def test_rank_correlation_and_words() -> None:
    x, sides = [1.0, 2.0, 3.0, 4.0, 9.0], ["free-field", "fixed", "free-field", "fixed", "free-field"]
    table = table_of([1.0, 4.0, 9.0, 16.0, None], x=x, sides=sides)
    values = {effect.path: effect.correlation for effect in effects(table, "kc", ["sides"], indices=False)}
    assert values["x"] == pytest.approx(1.0)
    # between groups: means 5 and 10 of values 1, 9 and 4, 16
    assert values["sides"] == pytest.approx(np.std([5.0, 10.0, 5.0, 10.0]) / np.std([1.0, 4.0, 9.0, 16.0]))
    assert table.failed == 1


def test_a_table_keeps_all_digits_and_the_order_of_samples() -> None:
    table = table_of([0.1 + 0.2, None], x=[1e-17, 3.0])
    read = list(csv.DictReader(io.StringIO(table.text())))
    assert [row["sample"] for row in read] == ["1", "2"]
    assert float(read[0]["kc"]) == 0.1 + 0.2
    assert float(read[0]["x"]) == 1e-17
    assert (read[1]["kc"], read[1]["failed"]) == ("", "no answer")


@pytest.mark.parametrize("n", [10, 100, 1000])
def test_intervals_of_a_probability_hold_it_19_times_in_20(n: int) -> None:
    truth = np.array([0.1, 0.5, 0.9])
    drawn = np.random.default_rng(0).random((400, n))
    fixed = 0
    for item in drawn:
        curve = probability("p", truth, item[:, None] < truth)
        fixed += int(np.sum((np.array(curve.low) <= truth) & (truth <= np.array(curve.high))))
    assert fixed / (3 * 400) == pytest.approx(0.95, abs=0.02)


def test_curves_of_the_block_reach_the_shaking_of_the_section_file() -> None:
    """A slope of critical Kh 0.015 had its fragility drawn up to 0.023, where nothing slides, for Kh = 0.195."""
    config = analysed({**slope(), "earthquake": {"magnitude": 7.0, "peak_acceleration": "0.3 g"}})
    table = cast(SampleTable, SimpleNamespace(names=(), column=lambda name: np.array([0.014, 0.015])))
    curves = list(fragility(config, table))
    assert len(curves) == len(config.study.exceeds)
    assert all(each.coefficient[-1] == pytest.approx(config.slide.kh) for each in curves)
    assert curves[0].probability[-1] > 0.5


def test_the_fit_over_kh_finds_the_fragility_that_samples_were_drawn_from() -> None:
    """θ and β of 4,000 samples of a lognormal fragility, to three standard errors; the interval holds the truth."""
    rng = np.random.default_rng(3)
    theta, beta, levels = 0.15, 0.4, rng.uniform(0.02, 0.5, 4000)
    happens = rng.uniform(size=4000) < stats.norm.cdf(np.log(levels / theta) / beta)
    result = fit(levels, happens)
    assert result == (pytest.approx(theta, rel=0.03), pytest.approx(beta, rel=0.08))
    count = curve("discs", levels[:200], happens[:200])
    assert count is not None
    truth = stats.norm.cdf(np.log(np.array(count.coefficient) / theta) / beta)
    assert np.mean((np.array(count.low) <= truth) & (truth <= np.array(count.high))) > 0.9
    assert np.all(np.diff(count.probability) >= 0.0)
    assert curve("discs", levels, np.zeros(4000, bool)) is None
    assert curve("discs", levels, np.ones(4000, bool)) is None


@pytest.mark.parametrize("error", [NoEquilibriumError, UnstableError])
def test_a_path_without_equilibrium_is_no_answer_and_not_a_critical_kh_of_0(
    error: type[NoAnswerError], monkeypatch: pytest.MonkeyPatch
) -> None:
    def ended(*paths: Any) -> None:
        raise error("it ended")

    monkeypatch.setattr(parts, "_critical", ended)
    sample = task.StudySample(data={**slope(), "mesh": {"size": 10}})
    if error is UnstableError:
        assert parts.continuum(sample).numbers == {"kc": 0.0}
    else:
        with pytest.raises(NoEquilibriumError):
            parts.continuum(sample)


@pytest.mark.parametrize("samples", [8, 30])
def test_what_a_result_depends_on_is_rarely_named_by_chance(samples: int) -> None:
    """Results that depend on none of three numbers: in at most one study of twenty any of them is named (0.05 and two
    standard errors of 400 studies)."""
    rng = np.random.default_rng(3)
    named = 0
    for _ in range(400):
        drawn, values = rng.normal(size=(3, samples)), rng.normal(size=samples)
        computed = [Effect(path=str(k), correlation=float(stats.spearmanr(item, values).statistic))
                 for k, item in enumerate(drawn)]  # fmt: skip
        computed.sort(key=lambda entry: -abs(entry.correlation or 0.0))
        spread = Spread.of(values.tolist())
        result = Result(name="kc", samples=samples, spread=spread, effects=tuple(computed), groups=())
        named += "depends most on" in strongest(result)
    assert named <= 400 * 0.072


def test_samples_that_fail_under_their_own_weight_are_told_to_do_so() -> None:
    """It was "Critical Kh: half of the samples are below 0.000"."""
    config = Config.parse(slope())
    for values, item in (([0.0] * 4, "All samples fail"), ([0.0, 0.0, 0.0, 0.1], "Half or more of the samples fail")):
        result = Result(name="kc", samples=4, spread=Spread.of(values), effects=(), groups=())
        answer = StudyAnswer.model_construct(
            samples=4, method="sobol", seed=0, failed=0, results=(result,), failures=(), section=None
        )
        assert [line for line in sentences(config, answer) if line.startswith(item)]


def test_blocks_that_do_not_slide_have_0_and_no_interval_below_0() -> None:
    """ "Half of the samples are below 0.000" stood above an interval of the mean from -0.0547 to 0.1468 m."""
    values = [0.0, 0.34, 0.0, 0.0, 0.03, 0.0, 0.0, 0.0]
    assert where(Spread.of(values), 8) == "half or more of the samples have 0"
    assert where(Spread.of([0.0] * 8), 8) == "all samples have 0"
    spread = spread_of(np.array(values))
    assert spread.mean_ci95 is not None
    assert spread.mean_ci95[0] == 0.0


def test_axes_of_samples_have_the_units_of_the_numbers() -> None:
    table = SampleTable({"strata.Clay.cohesion": "kPa", "triggering.borings.*.spt.*.N": ""}, [])
    assert [*map(table.heading, table.units)] == ["strata.Clay.cohesion (kPa)", "triggering.borings.*.spt.*.N"]


def test_four_samples_tell_no_more_than_their_median() -> None:
    perfect = Effect(path="strata.Fill.cohesion", correlation=-1.0)
    values = [0.096, 0.119, 0.098, 0.113]
    result = Result(name="kc", samples=4, spread=Spread.of(values), effects=(perfect,), groups=())
    assert strongest(result) == "; the samples are too few to show on which numbers it depends"
    assert where(result.spread, 4) == "half of the samples are below 0.106"
    assert "90 % of the samples" in where(Spread.of(values * 5), 20)
