"""Crests after slides, faces of structures and criteria in the report, of slides made by hand."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support import TOP, dem_fixture
from tests.support.answers import bounds, fem, results
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.criteria.settings import CriteriaSettings
from workflow.estimates.structures import structures_of
from workflow.report import side_by_side
from workflow.report.console import slide_sentences
from workflow.report.crests import crest_parts, water_at_crest
from workflow.report.first_page import headlines
from workflow.report.slide_headline import block_slides
from workflow.report.structures import face_rows, structure_sentences
from workflow.report.summary import summary
from workflow.report.verdicts import interval_words, verdict_paragraph, verdicts
from workflow.results.answer import SectionLabel, line
from workflow.results.cases import CaseAnswer, CasesAnswer
from workflow.results.continuum import FailureAnswer
from workflow.results.faces import FacesAnswer, FaceStrength, FaceValue
from workflow.results.slices import CirclePart, FacePart, FactorCircles, SlicesAnswer
from workflow.results.verdicts import VerdictPart
from workflow.texts.report_texts import Texts


def levee(**tables: Any) -> Config:
    data = tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    del data["sliding_block"]
    return analysed({**data, **tables})


def sunk(config: Config, by: float, far: float = 0.0, **more: Any) -> CaseAnswer:
    """A slide in which all ground sinks (m), and slides ``far`` (m)."""
    ground = config.section.ground
    along = line(np.column_stack([ground[:, 0], np.full(len(ground), far)]))
    update = {"surface_before": line(ground), "surface_after": line(ground - [0.0, by]), "slide_along": along}
    return dem_fixture.case(0.1, far).model_copy(update={**update, "settled": True, **more})


def slid(case: CaseAnswer) -> CasesAnswer:
    return CasesAnswer(sets={"calibrated": {1: case}}, random=None)


def circle(
    towards: Any, value: float, x: tuple[float, float] = (50.0, 70.0), spencer: float | None = None
) -> CirclePart:
    return CirclePart(
        towards=towards, centre_m=(0.0, 0.0), radius_m=1.0, surface_m=((x[0], 10.0), (x[1], 15.0)), bishop=value,
        spencer=spencer,
    )  # fmt: skip


def by_slices(config: Config) -> SlicesAnswer:
    """A levee with a face on either side, and a bank beside it that fails before."""
    faces = tuple(
        FacePart(
            structure="embankment at x = 69 m", kind="levee", start_m=56.0, end_m=86.0, crest_m=(66.0, 72.0),
            towards=side, factors=(FactorCircles(kh=0.0, circles=(circle(side, factor, spencer=factor + 0.02),)),),
            critical=circle(side, kc, spencer=kc + 0.01),
        )
        for side, factor, kc in (("left", 1.65, 0.144), ("right", 2.17, 0.266))
    )  # fmt: skip
    bank = (40.0, 46.0)
    return SlicesAnswer(
        section=SectionLabel.of(config.section),
        factors=(FactorCircles(kh=0.0, circles=(circle("left", 1.2, bank), circle("right", 2.17))),),
        critical=(circle("left", 0.039, bank), circle("right", 0.266)),
        faces=faces, least_depth=0.0, reason="", source="",
    )  # fmt: skip


def test_the_crest_of_the_levee_after_a_slide() -> None:
    """15 m less 0.5 m above water that stands at 9.8 m at the riverward foot; 5 m of sand lost 3.83 % of its volume."""
    config = levee()
    (part,) = crest_parts(config, slid(sunk(config, 0.5)))
    assert part.settlement_m == pytest.approx(0.5)
    assert part.reconsolidation_m == pytest.approx(0.19, abs=0.005)  # within the slide, whose discs shrink
    assert (part.water_m, part.freeboard_m) == (pytest.approx(9.8), pytest.approx(4.7))
    text = " ".join(slide_sentences(config, slid(sunk(config, 0.5))))
    assert "the crest settles 0.50 m, 0.19 m of it by reconsolidation; the remaining freeboard is 4.7 m." in text


@pytest.mark.parametrize("kind", ["levee", "embankment", "dam", "quay", "bank", "building", "other"])
def test_a_structure_has_a_kind_that_practitioners_name(kind: str) -> None:
    data = levee().to_data()
    data["structures"] = [{"name": "A", "from": 56.0, "to": 86.0, "kind": kind}]
    assert analysed(data).section.structures[0].kind == kind


def test_a_road_above_ground_water_has_no_freeboard_and_no_upslope_third() -> None:
    """Water in the ground is retained by no embankment; both ends of the ground are level, so that neither is
    upslope."""
    config = levee()
    dry = config.to_data()
    dry["water"] = {"table": float(config.section.ground[:, 1].min()) - 1.0}
    config = analysed(dry)
    (part,) = crest_parts(config, slid(sunk(config, 0.5)))
    assert (part.water_m, part.freeboard_m) == (None, None)
    text = " ".join(slide_sentences(config, slid(sunk(config, 0.5))))
    assert "freeboard" not in text
    assert "upslope third" not in text


def test_free_water_counts_for_freeboard_not_the_water_in_the_ground_below_a_building() -> None:
    """Flats behind a river bank had a freeboard of -0.93 m over ground water, and the bank that over ground water 0.4 m
    above the river."""
    surface = [[0, -3], [40, -3], [52, 3], [120, 3]]
    places = [{"name": "flats", "from": 62, "to": 74, "kind": "building"},
              {"name": "bank", "from": 40, "to": 52, "kind": "bank"}]  # fmt: skip
    data = {**tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8")), "surface": surface,
            "base": {"elevation": -15}, "structures": places,
            "water": {"table": [[0, 0], [46, 0], [60, 1], [120, 1.5]]}}  # fmt: skip
    soil = {key: value for key, value in data["strata"][-1].items() if key != "bottom"}
    data["strata"] = [{**soil, "liquefies_in": [1], "density": "18 kN/m^3", "density_saturated": "19 kN/m^3"}]
    config = Config.parse({key: data[key] for key in ("name", "surface", "base", "structures", "water", "strata")})
    water = {structure.name: water_at_crest(config, structure) for structure in structures_of(config.section)}
    assert water == {"flats": None, "bank": 0.0}


def test_the_freeboard_after_a_drawdown_is_above_the_lowered_water() -> None:
    """It was that above the flood, which had gone."""
    data = levee().to_data()
    left = float(levee().section.ground[0, 1])
    data["water"] = {"table": left + 4.0, "after_drawdown": left + 1.5}
    data["criteria"] = {"freeboard": {"limit": 1.0}}
    config = analysed(data)
    (structure,) = structures_of(config.section)
    assert water_at_crest(config, structure) == pytest.approx(left + 1.5)


def test_lengths_of_a_verdict_have_the_digits_of_tables_and_the_worst_are_named() -> None:
    """ "11.72 m to 14.21 m" stood beside a slide of 13 m, and three structures that slid less were named."""

    def part(subject: str, low: float, high: float | None) -> VerdictPart:
        return VerdictPart(criterion="displacement", subject=subject, low=low, high=high, limit=0.3, kh=None, source="",
                           verdict="not satisfied", reason="")  # fmt: skip

    assert [interval_words(part("flats", *ends)) for ends in ((11.72, 14.21), (0.304, 0.35), (2.0, None))] == [
        "12 to 14 m", "0.30 to 0.35 m", "at least 2.0 m",
    ]  # fmt: skip
    parts = [part("a", 1.0, 2.0), part("b", 3.0, 4.0), part("c", 0.5, 0.6), part("d", 0.4, None)]
    [sentence] = verdict_paragraph(parts)
    assert sentence.endswith("not satisfied (d: at least 0.40 m, b: 3.0 to 4.0 m and a: 1.0 to 2.0 m).")


def test_reconsolidation_is_added_to_slides_that_lose_no_volume() -> None:
    config = levee(slide={"cases": [{"stiffness": 0.1}]}, triggering={**_triggering(), "cases": []})
    (part,) = crest_parts(config, slid(sunk(config, 0.5)))
    assert part.settlement_m == pytest.approx(0.69, abs=0.005)
    assert part.freeboard_m == pytest.approx(4.51, abs=0.005)


def _triggering() -> dict[str, Any]:
    data = tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    result: dict[str, Any] = data["triggering"]
    return result


def test_faces_the_smallest_and_failures_elsewhere() -> None:
    config = levee()
    rows = face_rows(config, by_slices(config))
    assert [(row.kc, row.counts) for row in rows] == [(0.144, True), (0.266, False)]
    messages = list(structure_sentences(config, by_slices(config)))
    assert messages[2] == "The smallest counts: embankment at x = 69 m, towards the left."
    assert messages[3:] == [
        "Elsewhere, from x = 40 to 46 m towards the left, factor of safety at Kh = 0 is 1.20: no crest is part "
        "of this failure.",
        "Elsewhere, from x = 40 to 46 m towards the left, critical Kh is 0.039: no crest is part of this failure.",
    ]


def test_a_face_without_a_circle_says_so_and_is_held_against_no_criterion() -> None:
    config = levee(criteria={"critical_kh": {"limit": 0.1}})
    slides = by_slices(config)
    bare = slides.faces[1].model_copy(
        update={"factors": (FactorCircles(kh=0.0, circles=()),), "critical": None, "reason": "no circle slides"}
    )
    answer = slides.model_copy(update={"faces": (slides.faces[0], bare)})
    assert (
        list(structure_sentences(config, answer))[1] == "embankment at x = 69 m, towards the right: no circle slides."
    )
    assert [part.verdict for part in verdicts(results(config, slices=answer))] == ["satisfied"]


def test_criteria_are_satisfied_or_not_or_not_decided() -> None:
    limits = {
        "factor_of_safety": {"limit": 1.3, "source": "design brief"},
        "critical_kh": {"limit": 0.15},
        "displacement": {"limit": "0.3 m"},
        "crest_settlement": {"limit": "0.4 m"},
        "freeboard": {"limit": "1 m", "water": 13.0},
    }
    config = levee(criteria=limits)
    cases = slid(sunk(config, 0.5, far=0.2))
    result = verdicts(results(config, slices=by_slices(config), cases=cases))
    messages = {(part.criterion, part.subject.split(", ", 1)[1]): part.verdict for part in result}
    assert messages["factor of safety", "towards the left, by slices"] == "satisfied"
    assert messages["critical Kh", "towards the left, by slices"] == "not decided"  # 0.144 by Bishop, 0.154 by Spencer
    assert messages["critical Kh", "towards the right, by slices"] == "satisfied"
    assert messages["displacement", "discs, case 1, median"] == "satisfied"
    assert messages["crest settlement", "discs, case 1, median"] == "not satisfied"
    assert messages["freeboard", "discs, case 1, median"] == "satisfied"
    assert messages["freeboard", "case 2, low strength"] == "not decided"  # of which no slide was computed
    (paragraph,) = verdict_paragraph(result)
    assert "factor of safety of the faces of structures at least 1.30 at Kh = 0 [design brief]: satisfied;" in paragraph
    assert "crest settlement at most 0.40 m: not satisfied (" in paragraph
    (paragraph,) = verdict_paragraph(result, liquefies=True)
    assert "at least 1.30 at Kh = 0, without liquefaction [design brief]: satisfied;" in paragraph
    assert "crest settlement at most 0.40 m: not satisfied (" in paragraph


def test_finite_elements_are_held_against_a_criterion_where_a_crest_slides_with_them() -> None:
    """Else the first page tells that no crest slides with their mechanism, beside a criterion of the faces alone."""
    config = levee(criteria={"critical_kh": {"limit": 0.1}})
    elements, shown = fem(config, 0.078), Texts()
    for surface, verdict in ((((40.0, 6.0), (46.0, 9.0)), "satisfied"), (((40.0, 6.0), (70.0, 15.0)), "not satisfied")):
        states = tuple(state.model_copy(update={"slip_surface": surface}) for state in elements.states)
        answer = elements.model_copy(update={"states": states})
        result = results(config, fem=answer, slices=by_slices(config))
        (paragraph,) = verdict_paragraph(verdicts(result))
        assert f"0.100: {verdict}" in paragraph
        apart = "from x = 40 to 46 m, and no crest is part of this failure" in headlines(result, shown)[0].conclusion
        assert apart == ("of the faces of structures" in paragraph) == (verdict == "satisfied")


def test_a_face_that_slides_without_shaking_keeps_no_displacement() -> None:
    config = levee(criteria={"displacement": {"limit": "0.3 m"}})
    stands = by_slices(config)
    falls = stands.faces[0].model_copy(update={"critical": circle("left", -0.02)})
    messages = verdicts(results(config, slices=stands.model_copy(update={"faces": (falls, stands.faces[1])})))
    (part,) = [item for item in messages if item.subject.startswith(f"{falls.structure}, towards the left")]
    assert (part.verdict, part.reason) == ("not decided", "it slides without any shaking")


def test_a_block_has_the_smaller_critical_kh_of_circle_and_elements() -> None:
    """A caisson had 0.140 by circles, which go round it, and 0.068 by elements: its block slid 0.13 m."""
    config = levee(criteria={"displacement": {"limit": "0.3 m"}})
    stands = by_slices(config)
    strengths = tuple(
        FaceStrength(
            structure=face.structure, towards=face.towards, safety=None,
            critical=FaceValue(value=value, davis=value, upper=upper, reaches_crest=crest),
        )
        for face, value, upper, crest in zip(stands.faces, (0.09, 0.01), (0.08, None), (True, False), strict=True)
    )  # fmt: skip
    elements = FacesAnswer(section=stands.section, faces=strengths)
    assert [row.block_kh for row in face_rows(config, stands)] == [0.144, 0.266]
    rows = face_rows(config, stands, elements)
    assert [(row.kc, row.block_kh) for row in rows] == [(0.144, 0.08), (0.266, 0.266)]
    assert [row.counts for row in rows] == [True, False]
    weaker = strengths[1].model_copy(update={"critical": FaceValue(value=0.07, davis=0.07, upper=None)})
    others = face_rows(config, stands, elements.model_copy(update={"faces": (strengths[0], weaker)}))
    assert [row.counts for row in others] == [False, True]  # the face with the smaller circle was in bold
    judged = verdicts(results(config, slices=stands, faces=elements))
    assert rows[0].block is not None
    assert judged[0].high == pytest.approx(rows[0].block.high)


def test_a_structure_that_slides_to_the_left_is_displaced() -> None:
    config = levee(criteria={"displacement": {"limit": "0.3 m"}})
    (case,) = slid(sunk(config, 0.5)).sets["calibrated"].values()
    moved = case.model_copy(update={"slide_along": ((56.0, 0.1), (60.0, -1.2), (86.0, 0.2))})
    judged = verdicts(results(config, cases=slid(moved)))
    (part,) = [item for item in judged if "discs" in item.subject]
    assert (part.verdict, part.low) == ("not satisfied", pytest.approx(1.2))


def test_a_crest_in_ground_that_does_not_liquefy_settles_no_more_than_a_block_slides() -> None:
    """A dike on clay had crest settlement and freeboard "not decided: there is no answer"."""
    limits = {"crest_settlement": {"limit": "0.3 m"}, "freeboard": {"limit": "0.5 m", "water": 13.0}}
    data = {"criteria": limits, "earthquake": {"magnitude": 7.0, "peak_acceleration": "0.3 g", "distance": "20 km"}}
    config = levee(**data, strata=[stratum | {"liquefies_in": []} for stratum in _strata()], triggering={})
    answers = results(config, slices=by_slices(config))
    left = face_rows(config, answers.slices)[0]
    assert left.block is not None
    assert left.block.high > 0.0
    judged = verdicts(answers)
    assert [(part.criterion, part.verdict) for part in judged] == [
        ("crest settlement", "satisfied"), ("crest settlement", "satisfied"),
        ("freeboard", "satisfied"), ("freeboard", "satisfied"),
    ]  # fmt: skip
    assert (judged[0].low, judged[0].high) == (0.0, pytest.approx(left.block.high))
    assert (judged[2].low, judged[2].high) == (pytest.approx(2.0 - left.block.high), pytest.approx(2.0))
    too_wide = levee(**data | {"criteria": {"freeboard": {"limit": "2 m", "water": 13.0}}},
                     strata=[stratum | {"liquefies_in": []} for stratum in _strata()], triggering={})  # fmt: skip
    assert verdicts(results(too_wide, slices=by_slices(too_wide)))[0].verdict == "not decided"


def _strata() -> list[dict[str, Any]]:
    data = tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    result: list[dict[str, Any]] = data["strata"]
    return result


def test_what_still_moves_or_was_not_computed_is_not_decided() -> None:
    config = levee(criteria={"crest_settlement": {"limit": "0.4 m"}, "freeboard": {"limit": "1 m"}})
    moving = verdicts(results(config, cases=slid(sunk(config, 0.1, settled=False))))
    messages = [(part.verdict, part.reason) for part in moving if "case 1" in part.subject]
    assert messages == [("not decided", "the slide is not at rest")] * 2
    too_far = verdicts(results(config, cases=slid(sunk(config, 0.5, settled=False))))
    assert too_far[0].verdict == "not satisfied"
    nothing = verdicts(results(config))
    assert {(part.verdict, part.reason) for part in nothing} == {("not decided", "no slide was computed")}
    assert not verdicts(results(levee()))
    assert list(verdict_paragraph([])) == []


@pytest.mark.parametrize(("upper", "verdict"), [(None, "satisfied"), (1.29, "not satisfied")])
def test_a_criterion_counts_the_elements_of_a_face_and_their_upper_bound(upper: float | None, verdict: str) -> None:
    """Circles of 1.65 satisfied a criterion of 1.3 beside elements of another number, which no verdict had."""
    config = levee(criteria={"factor_of_safety": {"limit": 1.3}})
    slices, value = by_slices(config), FaceValue(value=1.31, upper=upper)
    strengths = FacesAnswer(
        section=SectionLabel.of(config.section),
        faces=(FaceStrength(structure="embankment at x = 69 m", towards="left", critical=None, safety=value),),
    )
    parts = verdicts(results(config, slices=slices, faces=strengths))
    [part] = [part for part in parts if part.subject.endswith("by finite elements")]
    assert part.subject == "embankment at x = 69 m, towards the left, by finite elements"
    assert (part.low, part.high) == (upper or 1.31, upper or 1.31)
    assert part.verdict == verdict
    other = [part for part in parts if part.subject.endswith("by slices")]
    assert {part.verdict for part in other} == {"satisfied"}


def test_the_displacement_of_a_slope_without_structures_is_that_of_its_block_and_of_its_surface() -> None:
    """A hillside moved "0 to 0.01 m" on the first page, and the limit of 0.15 m was "not decided: not computed"."""
    quake = {"magnitude": 7.0, "peak_acceleration": "0.3 g", "distance": "20 km"}
    config = analysed({**slope(), "criteria": {"displacement": {"limit": "0.1 m"}}, "earthquake": quake})
    for kc, verdict in ((0.28, "satisfied"), (0.02, "not satisfied")):
        answer = results(config, fem=fem(config, kc))
        (part,) = verdicts(answer)
        assert part.subject == "the section, rigid block without loss of strength"
        slides = block_slides(answer).values()
        assert (part.low, part.high) == (min(slides), max(slides))
        assert part.verdict == verdict
    moved = results(config, cases=slid(sunk(config, 0.5, far=0.8)))
    assert [(part.subject, part.high) for part in verdicts(moved)][-1] == ("the section, discs, case 1, median", 0.8)


@pytest.mark.parametrize("proven", [False, True])
def test_ground_that_fails_by_its_weight_is_held_against_the_criteria_and_compared(proven: bool) -> None:
    """Both criteria were "not decided: it was not computed", and `noshiro compare` had dashes."""
    run = analysed(slope())
    failure = FailureAnswer(
        section=SectionLabel.of(run.section), factor=0.86, flow="associated", davis=0.64, associated=None,
        slip_surface=((20.0, 15.0), (40.0, 10.0)),
    )  # fmt: skip
    limits = {"critical_kh": {"limit": 0.1}, "factor_of_safety": {"limit": 1.2, "kh": 0.0}}
    run = run.model_copy(update={"criteria": CriteriaSettings.model_validate(limits)})
    strict = bounds(run, -0.13, -0.0275).model_copy(update={"verdict": "unstable"}) if proven else None
    answers = results(run, failure=failure, bounds=strict)
    parts = verdicts(answers)
    assert [(part.criterion, part.verdict, interval_words(part)) for part in parts] == [
        ("factor of safety", "not satisfied", "0.86"),
        ("critical Kh", "not satisfied", f"at most {'-0.028' if proven else '0.000'}"),
    ]
    rows = dict(side_by_side.rows([side_by_side.ComparedRun(Path("a"), run, summary(answers, 0.0))]))
    assert rows["critical Kh, finite elements"] == ["below 0 (fails without shaking)"]
    assert rows["factor of safety at Kh = 0"] == ["0.86"]
