"""Slip circles without a seismic force, after shaking and after liquefaction, of the section and of its crests."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from fem.continuum.liquefied_ground import liquefied_section
from meshes.section.liquefies import RemainingStrength
from tests.support.answers import results
from tests.support.sections import SOIL, analysed
from workflow.config import Config
from workflow.report.faces import face_lines, note_sentences
from workflow.report.post_liquefaction import sentences
from workflow.report.slices import slices_sentences
from workflow.report.stability import stability_rows
from workflow.results.answer import SectionLabel
from workflow.results.faces import StrongZonePart
from workflow.results.slices import CirclesAtRest, SlicesAnswer
from workflow.results.stability import LiquefiedAnswer, LiquefiedCase
from workflow.run.store import Store
from workflow.stages.face_values import faces_at_rest
from workflow.stages.slices import circles_at_rest, work
from workflow.texts.report_texts import Texts

BANK = [[0.0, 4.0], [20.0, 4.0], [32.0, 10.0], [40.0, 10.0], [52.0, 4.0], [72.0, 4.0]]


def bank(**soil: object) -> Config:
    """Return the config of an embankment of one soil."""
    strata = [{"name": "Silt", **SOIL, **soil}]
    return analysed({"name": "bank", "surface": BANK, "base": {"elevation": 0.0}, "strata": strata})


def test_circles_after_liquefaction_have_the_strength_that_remains() -> None:
    """Without friction the factor of safety is proportional to the strength, on every circle."""
    clay = bank(cohesion="30 kPa", friction_angle="0 deg")
    before = circles_at_rest(clay.section, clay)
    soft = liquefied_section(clay.section, {0: RemainingStrength(0.4, 0.0, 0.0)})
    after = circles_at_rest(soft, clay)
    assert len(before.circles) == len(after.circles) == 2
    for circle, other in zip(before.circles, after.circles, strict=True):
        assert other.bishop == pytest.approx(0.4 * circle.bishop, rel=1e-3)
    # c / (γ H N) by Taylor (1937), chart for 1:2, H = 6 m and firm ground 4 m below the toe: N = 0.165 to 0.18
    unit_weight = 9.81 * clay.section.strata[0].density_ordinary
    assert 30e3 / (unit_weight * 6.0 * 0.18) < before.circles[0].bishop < 30e3 / (unit_weight * 6.0 * 0.165)
    assert {face.towards for face in after.faces} == {"left", "right"}
    assert len({(face.start_m, face.end_m) for face in after.faces}) == 1


def test_circles_after_shaking_have_its_excess_pore_pressure(tmp_path: Path) -> None:
    """The factor of safety before shaking stood there alone."""
    run = bank(cohesion="5 kPa", friction_angle="32 deg", excess_pore_pressure_ratio=0.3)
    store = Store(tmp_path)
    work(cast(Any, SimpleNamespace(config=run, store=store, progress=lambda *what: None)))
    answer = SlicesAnswer.read(store)
    circles_after = answer.after_shaking
    assert circles_after is not None
    before = next(group for group in answer.factors if group.kh == 0.0).circles[0].bishop
    # with less effective stress by 30 %: between 70 % and all of the strength
    assert 0.7 * before < circles_after.circles[0].bishop < 0.95 * before
    text = " ".join(slices_sentences(answer, rises_by_shaking=True))
    assert "after shaking, with its excess pore pressure, by slip circles: to the" in text
    rows = [row for row in stability_rows(results(run, slices=answer), Texts()) if "after shaking" in row.quantity]
    assert [row.value for row in rows] == [f"{circle.bishop:.2f}" for circle in circles_after.circles]
    of_faces = [face.circle.bishop for face in circles_after.faces]
    table = [line.after for line in face_lines(results(run, slices=answer)) if line.of_structure]
    assert table == [(("after shaking", "", f"{value:.2f}"),) for value in of_faces]


def test_the_circles_of_liquefied_ground_are_reported() -> None:
    clay = bank(cohesion="12 kPa", friction_angle="0 deg")
    circles = circles_at_rest(clay.section, clay)
    case = LiquefiedCase(
        verdict="flows", reason="it fails", kc=None, kc_lower=None, kc_upper=None, factor=0.9, factor_lower=None,
        factor_upper=None, notes=(), cases=(1, 2), names=(), strata=(), circles=circles,
    )  # fmt: skip
    answer = LiquefiedAnswer(section=SectionLabel.of(clay.section), sides="smooth", cases=(case,))
    least = circles.circles[0]
    text = "\n".join(sentences(answer))
    assert f"By slip circles it is to the {least.towards}" in text
    assert f"{least.bishop:.2f} by Bishop's method" in text
    assert "Warning" not in text
    bounded = case.model_copy(update={"factor_upper": 0.9 * least.bishop})
    text = "\n".join(sentences(answer.model_copy(update={"cases": (bounded,)})))
    assert f"Slip circles are above the strict upper bound of {0.9 * least.bishop:.2f}, which counts" in text
    lower = case.model_copy(update={"factor_lower": 1.05 * least.bishop})  # 1.03 stood beside 1.07 to 1.13
    text = "\n".join(sentences(answer.model_copy(update={"cases": (lower,)})))
    assert f"Slip circles are below the strict lower bound of {1.05 * least.bishop:.2f}:" in text
    close = case.model_copy(update={"factor_lower": 1.01 * least.bishop})
    assert "Slip circles are below" not in "\n".join(sentences(answer.model_copy(update={"cases": (close,)})))


def test_the_table_of_faces_has_the_factors_after_liquefaction_by_elements_and_circles(tmp_path: Path) -> None:
    """Elements had no factor of the faces after shaking or liquefaction, although slip circles had. With 40 % of the
    strength of clay both have 40 % of the factor of safety; elements are within 5 % of the circles."""
    clay = bank(cohesion="12 kPa", friction_angle="0 deg").with_settings("mesh", size=1.5)
    circles = circles_at_rest(clay.section, clay)
    faces = faces_at_rest(clay.section, clay, circles)
    assert [face.towards for face in faces] == ["left", "right"]
    for face, circle in zip(faces, circles.faces, strict=True):
        assert face.safety is not None
        assert face.safety.reaches_crest
        assert face.safety.value == pytest.approx(circle.circle.bishop, rel=0.05)
    case = LiquefiedCase(
        verdict="flows", reason="it fails", kc=None, kc_lower=None, kc_upper=None, factor=0.9, factor_lower=None,
        factor_upper=None, notes=(), cases=(1, 2), names=(), strata=(), circles=circles, faces=faces,
    )  # fmt: skip
    answer = LiquefiedAnswer(section=SectionLabel.of(clay.section), sides="smooth", cases=(case,))
    store = Store(tmp_path)
    work(cast(Any, SimpleNamespace(config=clay, store=store, progress=lambda *what: None)))
    lines = face_lines(results(clay, slices=SlicesAnswer.read(store), liquefied=answer))
    shown = {line.side.rpartition(" ")[2]: line.after for line in lines if line.of_structure}
    assert shown == {
        face.towards: (("cases 1, 2", f"{face.safety.value:.2f}", f"{circle.circle.bishop:.2f}"),)
        for face, circle in zip(faces, circles.faces, strict=True)
        if face.safety is not None
    }
    assert faces_at_rest(clay.section, clay.with_settings("faces", run=False), circles) == ()
    assert faces[0].safety is not None
    zones = (StrongZonePart(start=40.0, end=72.0, depth=1e6),)
    strong = faces[0].model_copy(update={"safety": faces[0].safety.model_copy(update={"strong_zones": zones})})
    [note] = [
        text
        for text in note_sentences(
            results(
                clay, liquefied=answer.model_copy(update={"cases": (case.model_copy(update={"faces": (strong,)}),)})
            )
        )
        if "too strong to fail" in text
    ]
    assert note.startswith(
        "Factor of safety of embankment at x = 36 m, towards the left, after shaking or liquefaction"
    )


def test_ground_without_excess_pressure_has_no_circles_after_shaking(tmp_path: Path) -> None:
    run = bank()
    work(cast(Any, SimpleNamespace(config=run, store=Store(tmp_path), progress=lambda *what: None)))
    assert SlicesAnswer.read(Store(tmp_path)).after_shaking is None
    assert CirclesAtRest(circles=()).faces == ()
