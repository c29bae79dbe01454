"""The faces of structures in one table, and their strong zones."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fem.continuum.fields import sliding_sides
from fem.continuum.loads import sign_of
from fem.limit_load.limit_load import critical_limit_load
from fem.search.face_limits import FaceLimit
from fem.search.slip_surface import moving_ground
from fem.search.strength_reduction import limit_load_safety_factor
from fem.search.strong_zones import UNLIMITED_DEPTH, StrongZone
from fem.settings import FemSettings
from meshes.executor import OneThread
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.answers import bounds, fem, results
from tests.support.sections import layer
from tests.unit.workflow.test_verdicts import by_slices, levee, sunk
from workflow.config import Config
from workflow.estimates.crest import Crest
from workflow.estimates.face_zones import is_of_face, zones_against
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import CrestedStructure, structures_of
from workflow.figures.front import _of_structure
from workflow.report.faces import face_lines, faces_sentences, note_sentences, side_words
from workflow.report.first_page import headlines
from workflow.results.answer import SectionLabel
from workflow.results.cases import CasesAnswer
from workflow.results.continuum import FactorOfSafety
from workflow.results.faces import FacesAnswer, FaceStrength, FaceValue, StrongZonePart
from workflow.results.slices import FactorCircles
from workflow.stages import face_values, faces
from workflow.texts.report_texts import Texts

BANK = ((40.0, 6.0), (43.0, 6.5), (46.0, 9.0))
WHOLE = ((35.6, 6.0), (53.0, 5.0), (71.4, 15.0))
LANDWARD = ((69.0, 15.0), (79.0, 9.0), (88.0, 10.0))


def test_a_failure_is_of_the_face_whose_crest_slides_to_its_side() -> None:
    (structure,) = structures_of(levee().section)
    assert is_of_face(structure, LEFT, WHOLE)
    assert not is_of_face(structure, RIGHT, WHOLE)
    assert is_of_face(structure, RIGHT, LANDWARD)
    assert not is_of_face(structure, LEFT, BANK)
    assert not is_of_face(structure, LEFT, ())


def test_a_column_that_overlaps_the_crest_counts_as_a_part_of_it() -> None:
    """The slip surface of a heap of gravel began at x = 36.05, in a column from 35.7 to 36.4 m, 0.6 m below the crest,
    which ends at 36 m: "no crest is part of this failure", and its factor of safety was 1.38, in place of 1.19."""
    heap = CrestedStructure("heap", "embankment", Crest(start=20.0, end=51.0, left=35.0, right=36.0, elevation=10.0))
    points = [(36.05 + 0.7 * k, 9.36 - 0.45 * k) for k in range(22)]
    assert heap.slides_with(points)
    assert heap.slides_with([(71.0 - x, z) for x, z in points[::-1]])
    assert not heap.slides_with(points[1:])
    assert not heap.slides_with([points[0], points[-1]])  # both ends of ground that moves


def test_a_failure_that_carries_the_whole_embankment_away_slides_to_the_side_of_its_displacement() -> None:
    """Both of its ends are level with each other, and the lower one by a millimetre gave the side: a strong zone was
    put behind the crest, nothing else failed there, and the face had neither Kh nor factor of safety."""
    section = levee().section
    (structure,) = structures_of(section)
    surface = ((40.0, 6.001), (70.0, 2.0), (95.0, 6.0))
    assert is_of_face(structure, LEFT, surface, (LEFT,))
    assert not is_of_face(structure, RIGHT, surface, (LEFT,))
    assert all(is_of_face(structure, side, surface, (LEFT, RIGHT)) for side in (LEFT, RIGHT))
    assert zones_against(section, structure, RIGHT, surface, (), (), 0.5, (LEFT,)) == (
        StrongZone(0.0, 66.0, UNLIMITED_DEPTH),
    )


def test_an_embankment_on_soft_clay_slides_to_both_sides() -> None:
    """Its factor of safety is that of both faces; under a seismic force it slides with the force alone."""
    soft = {"poissons_ratio": 0.4, "cohesion": "26 kPa", "friction_angle": "0 deg"}
    embankment = Section.parse({
        "name": "embankment", "surface": [[0, 0], [30, 0], [39, 6], [45, 6], [54, 0], [84, 0]],
        "base": {"elevation": -10}, "strata": [layer("Fill", bottom={"elevation": 0}), layer("Clay", **soft)],
    })  # fmt: skip
    mesh = generate(embankment, MeshSettings(size=2.5))
    at_rest = limit_load_safety_factor(embankment, mesh, FemSettings(), 0.0).mechanism
    loaded = critical_limit_load(embankment, mesh, FemSettings(direction="downhill")).mechanism
    assert at_rest is not None
    assert loaded is not None
    assert sliding_sides(mesh, at_rest) == (LEFT, RIGHT)
    start, end = moving_ground(mesh, at_rest)
    assert 20.0 < start < 30.0
    assert start + end == pytest.approx(84.0, abs=5.0)
    assert sliding_sides(mesh, loaded) == (sign_of(embankment, "downhill"),)


def test_ground_that_spreads_below_the_crest_is_the_failure_of_both_faces() -> None:
    """It has no slip surface: the factor of safety was the headline, and no face had it."""
    (structure,) = structures_of(levee().section)
    for extent, sides, expected in (((50.0, 95.0), (LEFT, RIGHT), (True, True)), ((20.0, 30.0), (LEFT,), None)):
        spreads = FaceLimit(1.07, 1.06, np.zeros((0, 2)), sides, extent)
        moving = spreads.moving(levee().section)
        assert moving[:, 0].tolist() == list(extent)
        reached = tuple(is_of_face(structure, side, moving, sides) for side in (LEFT, RIGHT))
        assert reached == (expected or (False, False))
        if expected:
            task = face_values.FaceTask(
                levee(bounds={"run": False}), structure, RIGHT, "factor of safety", spreads, WHOLE
            )
            value = face_values.face_value(task, lambda message: None)
            assert isinstance(value, FaceValue)
            assert value.value == 1.07
            assert value.reaches_crest
            assert value.strong_zones == value.slip_surface == ()


def test_a_face_without_a_value_says_why() -> None:
    value = FaceValue(value=0.053, reaches_crest=False)
    face = FaceStrength(structure="Levee", towards="left", critical=value, safety=None,
                        reasons=("factor of safety: no mesh",))  # fmt: skip
    spared = FacesAnswer(section=SectionLabel.of(levee().section), faces=(face,))
    assert list(faces_sentences(spared)) == [
        "Levee, towards the left: no critical Kh: with ψ = φ ground without the crest fails first, at 0.053; "
        "no factor of safety: no mesh."
    ]


@pytest.mark.parametrize("first", [True, False])
def test_a_failure_without_a_slip_surface_is_a_reason(first: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ground that settles to both sides has none; the run of a quay ended in an IndexError."""
    (structure,) = structures_of(levee().section)
    none = FaceLimit(0.57, 0.5, np.zeros((0, 2)))
    monkeypatch.setattr(face_values, "_computed", lambda *arguments: none)
    unchanged = none if first else FaceLimit(0.4, None, np.array(LANDWARD))
    task = face_values.FaceTask(levee(), structure, LEFT, "critical Kh", unchanged, WHOLE)
    reason = face_values.face_value(task, lambda message: None)
    assert isinstance(reason, str)
    assert reason.startswith("the ground that fails at 0.57 in finite elements has no slip surface")


def test_ground_in_front_of_the_levee_moves_as_one_body_where_its_circle_passes_below() -> None:
    """From the foot of the bank at x = 40 m to the crest at 66 m, 9 m higher: the zone is 0.9 m thick."""
    section = levee().section
    (structure,) = structures_of(section)
    assert zones_against(section, structure, LEFT, BANK, WHOLE, (), 0.5) == (
        StrongZone(40.0, 66.0, pytest.approx(0.9)),
    )


def test_ground_in_front_of_the_levee_is_held_where_its_circle_ends_before() -> None:
    section = levee().section
    (structure,) = structures_of(section)
    near = ((52.0, 10.0), (60.0, 9.0), (70.0, 15.0))
    assert zones_against(section, structure, LEFT, BANK, near, (), 0.5) == (StrongZone(0.0, 48.0, UNLIMITED_DEPTH),)


def test_a_failure_to_the_other_side_is_excluded_behind_the_crest() -> None:
    section = levee().section
    (structure,) = structures_of(section)
    zones = zones_against(section, structure, LEFT, LANDWARD, WHOLE, (), 0.5)
    assert zones == (StrongZone(72.0, 140.0, UNLIMITED_DEPTH),)
    assert zones_against(section, structure, LEFT, LANDWARD, WHOLE, zones, 0.5) is None  # the zone exists already
    assert zones_against(section, structure, RIGHT, BANK, LANDWARD, (), 0.5) == (
        StrongZone(0.0, 66.0, UNLIMITED_DEPTH),
    )


def test_the_side_of_the_river_is_that_of_free_water() -> None:
    config = levee()
    assert side_words(config, 56.0, 86.0, "left") == "riverward, left"
    assert side_words(config, 56.0, 86.0, "right") == "landward, right"
    quay = levee(structures=[{"name": "quay", "from": 56.0, "to": 86.0, "kind": "quay"}])  # it was "riverward" at sea
    assert side_words(quay, 56.0, 86.0, "left") == "towards the water, left"
    assert side_words(quay, 56.0, 86.0, "right") == "landward, right"
    dry = levee(water={"table": [[0, 5.0], [140, 5.0]]})
    assert side_words(dry, 56.0, 86.0, "left") == "left"


def test_faces_share_the_searches_in_the_section_without_strong_zones(monkeypatch: pytest.MonkeyPatch) -> None:
    """With Davis reduced strength the elements have no mechanism with ψ = φ: one search for either way, and one for
    the factor of safety, instead of one for each quantity of each face. With ψ = φ the search of the elements serves.
    """
    requested = []

    def computed(config: Config, quantity: str, side: int, zones: tuple[StrongZone, ...]) -> FaceLimit:
        requested.append((quantity, side, zones))
        return FaceLimit(0.1, None, np.array(WHOLE))

    monkeypatch.setattr(face_values, "_computed", computed)
    job = cast(Any, SimpleNamespace(config=levee(), executor=OneThread(), progress=lambda *what: None))
    result = fem(levee(), 0.1)
    for flow, searches in (("davis", 3), ("associated", 2)):
        requested.clear()
        values = faces._unchanged(job, result.model_copy(update={"flow": flow}), [LEFT, RIGHT, LEFT, RIGHT])
        assert len(requested) == searches
        assert len(values) == 4


def answer() -> FacesAnswer:
    zones = (StrongZonePart(start=40.0, end=66.0, depth=0.9),)
    left = FaceStrength(
        structure="embankment at x = 69 m", towards="left",
        critical=FaceValue(value=0.1478, davis=0.1017, lower=0.14, upper=0.149, slip_surface=WHOLE, strong_zones=zones),
        safety=FaceValue(value=1.648, davis=1.548, slip_surface=WHOLE, strong_zones=zones),
    )  # fmt: skip
    right = FaceStrength(
        structure="embankment at x = 69 m", towards="right",
        critical=FaceValue(value=0.253, davis=None, slip_surface=LANDWARD), safety=None,
        reasons=("factor of safety: no",),
    )  # fmt: skip
    section = levee().section
    return FacesAnswer(section=SectionLabel.of(section), faces=(left, right))


def test_every_face_is_a_line_with_all_methods_and_the_bank_is_one_of_its_own() -> None:
    config = levee()
    case = sunk(config, 0.5, far=1.25)
    slides = CasesAnswer(sets={"calibrated": {1: case}}, random=None)
    of_fem = fem(config, 0.078)
    state = of_fem.states[-1].model_copy(update={"slip_surface": BANK, "past_equilibrium": False})
    of_fem = of_fem.model_copy(update={"states": (state,), "towards": "left"})
    answers = results(
        config,
        slices=by_slices(config),
        faces=answer(),
        cases=slides,
        fem=of_fem,
        bounds=bounds(config, 0.0773, 0.0785),
    )
    left, right, bank = face_lines(answers)
    assert (left.side, right.side) == ("riverward, left", "landward, right")
    assert left.critical.pair("elements", 3) == ("0.148", "0.102")
    assert left.critical.pair("circles", 3) == ("0.144", "")
    assert left.critical.interval(3) == "0.140–0.149"
    assert left.counts
    assert not right.counts
    assert left.safety.pair("elements", 2) == ("1.65", "1.55")
    assert left.slides == ("1.2 m discs",)
    assert right.slides == ("0.0 m discs",)  # the ground moves to the left
    assert left.settles == right.settles == ("0.5 m discs",)
    assert bank.name == "x = 40 to 46 m, no crest is part of this failure"
    assert bank.critical.pair("elements", 3)[0] == "0.078"
    assert bank.critical.interval(3) == "0.077–0.079"
    notes = list(note_sentences(answers))
    assert notes[0] == (
        "Critical Kh and factor of safety of embankment at x = 69 m, towards the left, by finite elements and bounds: "
        "the ground from x = 40 to 66 m down to 0.9 m is taken as too strong to fail, because failures there come "
        "first."
    )
    first = headlines(answers, Texts())[0].conclusion
    assert first.endswith(
        "Of the crests, embankment at x = 69 m slides first (riverward, left), at Kh = 0.148 (0.102 with Davis reduced "
        "strength); without shaking its factor of safety is 1.65."
    )
    assert any(text.startswith("Left out for their cost: strict bounds of factors of safety") for text in notes)


def test_a_face_without_a_value_by_elements_has_that_of_its_circle_on_the_first_page() -> None:
    """Elements that only reached ground below the crest left a riverward face out: the first page named the landward
    face, at Kh = 0.253, although a circle through the crest fails riverward at 0.144."""
    config = levee()
    of_fem = fem(config, 0.078)
    state = of_fem.states[-1].model_copy(update={"slip_surface": BANK, "past_equilibrium": False})
    of_fem = of_fem.model_copy(update={"states": (state,), "towards": "left"})
    left, right = answer().faces
    faces = answer().model_copy(update={"faces": (left.model_copy(update={"critical": None}), right)})
    first = headlines(results(config, slices=by_slices(config), faces=faces, fem=of_fem), Texts())[0]
    assert "embankment at x = 69 m slides first (riverward, left), at Kh = 0.144 by slip circles" in first.conclusion
    assert first.interval.endswith("; 0.144 for the first crest to slide")
    [overlay] = _of_structure(results(config, slices=by_slices(config), faces=faces, fem=of_fem), 0.078)
    assert overlay.label == "embankment at x = 69 m, towards the left: slip circle at Kh = 0.144"


def test_the_structure_that_the_file_names_stands_first() -> None:
    """Large print had 0.078 of the bank; the levee's values stood in small print behind it."""
    config = levee(structures=[{"name": "embankment at x = 69 m", "from": 56.0, "to": 86.0, "kind": "levee"}])
    factor = FactorOfSafety.model_construct(
        kh=0.0, factor=1.2, verdict="plateau", remaining_error=0.01, after_shaking=False, slip_surface=BANK,
        shallow_failure=None, davis=None, associated=None,
    )  # fmt: skip
    of_fem = fem(config, 0.078)
    state = of_fem.states[-1].model_copy(update={"slip_surface": BANK, "past_equilibrium": False})
    changes = {"states": (state,), "towards": "left", "safety_factors": (factor,)}
    of_fem = of_fem.model_copy(update=changes)
    strict = bounds(config, 0.0773, 0.0785)
    answers = results(config, slices=by_slices(config), faces=answer(), fem=of_fem, bounds=strict)
    critical, safety, _ = headlines(answers, Texts())
    assert (critical.name, critical.value) == ("critical Kh, embankment at x = 69 m (riverward, left)", "0.148")
    assert critical.interval == (
        "0.140 to 0.149 by strict bounds; 0.078 from x = 40 to 46 m, where no crest is part of the failure"
    )
    assert critical.conclusion.startswith("Of the crests, embankment at x = 69 m slides first (riverward, left)")
    assert critical.conclusion.endswith("no crest is part of this failure (embankment at x = 69 m).")
    assert (safety.name, safety.value) == ("factor of safety, embankment at x = 69 m (riverward, left)", "1.65")
    assert safety.interval == ("by finite elements; 1.20 from x = 40 to 46 m, where no crest is part of the failure")


def test_a_circle_with_the_crest_is_no_circle_of_the_bank() -> None:
    """The line "no crest is part of this failure" had 1.65, the factor of safety of a circle below the crest."""
    config = levee()
    of_fem = fem(config, 0.078)
    state = of_fem.states[-1].model_copy(update={"slip_surface": BANK, "past_equilibrium": False})
    of_fem = of_fem.model_copy(update={"states": (state,), "towards": "left"})
    slices = by_slices(config)
    for surface, drawn in ((WHOLE, ("", "")), (BANK, ("1.65", "0.144"))):
        part = next(face.critical for face in slices.faces if face.critical is not None)
        part = part.model_copy(update={"surface_m": surface, "towards": "left", "bishop": 0.144})
        factor = FactorCircles(kh=0.0, circles=(part.model_copy(update={"bishop": 1.65}),))
        answers = results(
            config, slices=slices.model_copy(update={"factors": (factor,), "critical": (part,)}), fem=of_fem
        )
        bank = face_lines(answers)[-1]
        assert (bank.safety.pair("circles", 2)[0], bank.critical.pair("circles", 3)[0]) == drawn


def test_the_command_prints_every_face() -> None:
    left, right = faces_sentences(answer())
    assert left == (
        "embankment at x = 69 m, towards the left: critical Kh 0.148 with ψ = φ, 0.102 with Davis reduced strength, "
        "strict bounds 0.140 to 0.149; factor of safety 1.65 with ψ = φ, 1.55 with Davis reduced strength."
    )
    assert right.endswith("critical Kh 0.253 with ψ = φ; no factor of safety: no.")


def test_a_face_of_finite_elements_above_their_strict_bound_has_the_value_of_the_bound() -> None:
    """The table of faces had 0.148 beside bounds of 0.140 to 0.144 and called it the answer."""
    left, right = answer().faces
    assert left.critical is not None
    critical = left.critical.model_copy(update={"upper": 0.144})
    above = answer().model_copy(update={"faces": (left.model_copy(update={"critical": critical}), right)})
    config = levee()
    answers = results(config, slices=by_slices(config), faces=above)
    assert face_lines(answers)[0].critical.pair("elements", 3) == ("0.144", "0.102")
    assert (
        "Critical Kh of embankment at x = 69 m, riverward, left: the finite elements give 0.148, above the strict "
        "upper bound, which counts."
    ) in list(note_sentences(answers))
    assert next(faces_sentences(above)).startswith(
        "embankment at x = 69 m, towards the left: critical Kh 0.144 with ψ = φ, 0.102 with Davis reduced strength, "
        "strict bounds 0.140 to 0.144 (the upper bound counts: the finite elements give 0.148); factor"
    )


def test_a_face_of_finite_elements_below_its_strict_bound_has_the_value_of_the_bound() -> None:
    """Only upper bounds were known to the choice of the number: 0.148 would have stood beside 0.150 to 0.152."""
    left, right = answer().faces
    assert left.critical is not None
    critical = left.critical.model_copy(update={"lower": 0.150, "upper": 0.152})
    below = answer().model_copy(update={"faces": (left.model_copy(update={"critical": critical}), right)})
    config = levee()
    answers = results(config, slices=by_slices(config), faces=below)
    assert face_lines(answers)[0].critical.pair("elements", 3) == ("0.150", "0.102")
    assert (
        "Critical Kh of embankment at x = 69 m, riverward, left: the finite elements give 0.148, below the strict "
        "lower bound, which counts."
    ) in list(note_sentences(answers))
    assert "strict bounds 0.150 to 0.152 (the lower bound counts: the finite elements give 0.148)" in next(
        faces_sentences(below)
    )


def test_a_face_that_fails_first_has_the_bounds_of_the_section() -> None:
    """Without strong zones the section is the face's own ground: the command printed no bounds for such a face."""
    config = levee()
    assert answer().faces[1].critical is not None
    assert not answer().faces[1].critical.strong_zones
    of_section = bounds(config, 0.036, 0.038)
    part = of_section.directions[0].model_copy(update={"direction": "uphill", "lower": 0.249, "upper": 0.255})
    of_section = of_section.model_copy(update={"directions": (*of_section.directions, part)})
    left, right = faces_sentences(answer(), results(config, faces=answer(), bounds=of_section))
    assert "strict bounds 0.140 to 0.149" in left
    assert "critical Kh 0.253 with ψ = φ, strict bounds 0.249 to 0.255" in right


def test_bounds_of_a_factor_that_are_not_asked_for_are_not_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A dam was told to compute strict bounds of its factor of safety, which a run leaves out for their cost."""
    messages: list[str] = []
    config = levee()
    assert not config.bounds.safety_factor
    zone = StrongZone(40.0, 66.0, 0.9)
    monkeypatch.setattr(face_values, "_ground", lambda config, zones: config.section)
    structure = structures_of(config.section)[0]
    task = face_values.FaceTask(config, structure, LEFT, "factor of safety", "", ())
    assert face_values._bounded(task, (zone,), messages.append) == (None, None)
    assert messages == []


@pytest.mark.parametrize(("ratio", "count"), [(0.0, 0), (0.3, 1)])
def test_factors_of_faces_are_said_to_be_those_before_shaking(ratio: float, count: int) -> None:
    """They have no excess pore pressure, which the critical Kh in the same row has."""
    config = levee()
    strata = [stratum.model_copy(update={"excess_pore_pressure_ratio": ratio}) for stratum in config.section.strata]
    loose = config.model_copy(update={"section": config.section.with_strata(strata)})
    notes = list(note_sentences(results(loose, faces=answer())))
    assert sum("are those before shaking" in note for note in notes) == count
