"""What is changed to see critical Kh with other assumptions."""

from typing import cast

import pytest
from mpi4py import MPI

from fem.search.assessment import assess
from meshes.gmsh_model import generate
from meshes.quad_mesh import QuadMesh
from tests.support.answers import fem, variant
from tests.support.sections import slope
from workflow.config import Config
from workflow.report.console import fem_sentences
from workflow.report.warnings import tension_warning
from workflow.results import stored_mesh
from workflow.results.continuum import MeshCount, MeshStep
from workflow.run.progress import silent
from workflow.run.store import Store
from workflow.stages import variants
from workflow.stages.fem import without_tensile_strength
from workflow.stages.variants import (
    PATH_CELLS,
    Change,
    by_one_element,
    changed,
    like_with_like,
    on_a_mesh,
    with_its_element,
)
from workflow.stages.variants import variant as variant_of


@pytest.mark.parametrize(
    ("settings", "name", "words"),
    [
        ({}, "mesh", "cells of half the size"),
        ({}, "element", "the bilinear element instead of the quadratic element"),
        ({"fem": {"element": "quadratic"}}, "step", "first step of Kh 0.04 instead of 0.02"),
        ({"fem": {"flow": "non-associated"}}, "step", "first step of Kh 0.04 instead of 0.02"),
        ({}, "sides", "sides fixed instead of free-field"),
        ({"fem": {"sides": "fixed"}}, "sides", "sides free-field instead of fixed"),
        ({}, "dilation", "the flow rule of the given ψ (equilibrium path) instead of ψ = φ"),
        (
            {"fem": {"flow": "davis"}},
            "dilation",
            "the flow rule of the given ψ (equilibrium path) instead of Davis's estimate",
        ),
        (
            {"fem": {"flow": "non-associated"}},
            "dilation",
            "Davis's estimate instead of the flow rule of the given ψ (equilibrium path)",
        ),
    ],
)
def test_one_thing_is_changed(settings: dict[str, object], name: str, words: str) -> None:
    run = Config.parse({**slope(), **settings})
    layer_springss = changed(run, name, "quadratic")
    assert layer_springss is not None
    assert layer_springss[:2] == (name, words)
    tables = [table for table in ("mesh", "fem") if getattr(layer_springss[2], table) != getattr(run, table)]
    assert tables == ["mesh" if name == "mesh" else "fem"]
    before, after = (getattr(item, tables[0]).model_dump() for item in (run, layer_springss[2]))
    assert len([key for key in before if before[key] != after[key]]) == 1


def test_what_would_change_nothing_is_left_out() -> None:
    periodic = Config.parse(
        {**slope(), "surface": [[0.0, 20.0], [100.0, 20.0]], "fem": {"sides": "periodic", "first_step": 0.1}}
    )
    assert changed(periodic, "sides", "quadratic") is None
    assert changed(periodic, "step", "quadratic") is None
    limit_load = Config.parse(slope())  # ψ = φ and its element: there is no path, and so no step
    assert changed(limit_load, "step", "reduced") is None
    data = slope()
    for stratum in data["strata"]:
        stratum["dilation_angle"] = stratum["friction_angle"]
    assert changed(Config.parse(data), "dilation", "reduced") is None


@pytest.mark.parametrize(("cells", "first"), [(PATH_CELLS, None), (PATH_CELLS + 1, 0.25)])
def test_a_path_is_followed_on_the_first_mesh_where_the_last_has_many_cells(
    cells: int, first: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = Config.parse(slope())
    monkeypatch.setattr(stored_mesh, "stored_mesh", lambda *_: "the first mesh")
    answer = fem(run).model_copy(
        update={
            "mesh": MeshCount(quadrilaterals=cells, nodes=1, method="free"),
            "meshes": (MeshStep(cells=600, kc=0.25), MeshStep(cells=cells, kc=0.24)),
        }
    )

    def of(name: str, element: str = "reduced") -> tuple[object, float | None]:
        change = changed(run, name, element)
        assert change is not None
        result = on_a_mesh(change, run, Store("nowhere"), answer, cast(QuadMesh, "the last mesh"))
        assert result.description.endswith("the first mesh of 600 cells") == (result.kc_without is not None)
        return result.mesh, result.kc_without

    expected = ("the last mesh" if first is None else "the first mesh", first)
    assert of("element") == of("dilation") == expected
    assert of("sides") == ("the last mesh", None)  # a limit load at once, whatever the number of cells


def test_changes_of_a_path_are_compared_with_a_path_on_the_same_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bilinear cells have 0.31 on the first mesh where the limit load of the reduced element is 0.25."""
    run = Config.parse(slope()).with_settings("fem", element="bilinear")
    mesh = cast(QuadMesh, "the first mesh")
    unchanged = variant("first", "no change", 0.31)
    monkeypatch.setattr(variants, "variant", lambda *_: unchanged)
    changes = [
        Change("mesh", "cells of half the size", run, mesh, True, 0.25),
        Change("step", "step", run, mesh, False),
    ]
    assert [change.kc_without for change in like_with_like(changes, run, silent)] == [0.31, None]
    assert [change.kc_without for change in like_with_like(changes, Config.parse(slope()), silent)] == [0.25, None]
    unchanged = variant("first", "no change", None)
    assert [change.name for change in like_with_like(changes, run, silent)] == ["step"]


@pytest.mark.parametrize("which", [("element", "dilation"), ("dilation",)])
def test_less_dilation_is_compared_with_the_element_of_its_path(which: tuple[str, ...]) -> None:
    """0.13 by the quadratic element is less than its 0.14 with ψ = φ, though more than the 0.10 of the answer."""
    run, mesh = Config.parse(slope()), cast(QuadMesh, "the mesh")
    requested = [change for name in which if (change := changed(run, name, "reduced"))]
    changes = with_its_element([Change(*change, mesh, False, 0.10) for change in requested], run, "reduced")
    values = {"non-associated": 0.13, "auto": 0.14}
    computed = [
        variant(each.name, each.description, values[each.config.fem.flow]).model_copy(update={"kc_without": 0.10})
        for each in changes
    ]
    result = by_one_element(computed, changes)
    assert [each.name for each in result] == list(which)
    assert result[-1].kc_without == 0.14
    assert result[-1].of(0.10) == pytest.approx(0.10 * 0.13 / 0.14)
    assert result[-1].change.endswith("instead of ψ = φ, both with the quadratic element")
    assert len(changes) == 2
    without = [each if each.kc == 0.13 else each.model_copy(update={"kc": None, "reason": "why"}) for each in computed]
    assert by_one_element(without, changes)[-1].kc is None


def test_a_change_on_another_mesh_counts_by_its_ratio() -> None:
    here = variant("element", "quadratic element", 0.30)
    assert here.of(0.24) == 0.30
    assert here.model_copy(update={"kc_without": 0.25}).of(0.24) == pytest.approx(0.24 * 0.30 / 0.25)
    assert variant("element", "quadratic element", None).of(0.24) is None


def test_ground_without_tensile_strength_has_no_more_than_with_it() -> None:
    """A vertical cut of clay stands up to γH/c = 3.78, without tensile strength up to 2 (Drucker & Prager 1952)."""
    height, gamma = 5.0, 18e3
    soil = {
        "name": "Clay", "youngs_modulus": "20 MPa", "poissons_ratio": 0.45, "density": "1.835 t/m^3",
        "friction_angle": 0,
    }  # fmt: skip
    for ratio, stands in ((1.9, True), (2.9, False)):
        cut = {
            "name": "cut", "surface": [[0.0, height], [8.0, height], [8.0, 0.0], [16.0, 0.0]],
            "base": {"elevation": -4.0}, "strata": [{**soil, "cohesion": f"{gamma * height / ratio / 1e3:.4f} kPa"}],
            "mesh": {"size": 0.5}, "unusual": True,
        }  # fmt: skip
        run = Config.parse(cut)
        change = changed(run, "tension", "reduced")
        assert change is not None
        mesh = generate(run.section, run.mesh)
        whole, cracked = (
            variant_of(Change("tension", "", config, mesh, False), lambda _: None).kc for config in (run, change[2])
        )
        assert whole is not None
        assert whole > 0.0
        assert cracked is not None
        assert (0.0 < cracked < whole) if stands else cracked == 0.0


def test_ground_that_resists_no_tension_has_no_variant_without_it() -> None:
    data = slope()
    for stratum in data["strata"]:
        stratum["tension"] = "0 kPa"
    assert changed(Config.parse(data), "tension", "reduced") is None
    for stratum in data["strata"]:
        stratum["cohesion"] = 0.0
        del stratum["tension"]
    assert changed(Config.parse(data), "tension", "reduced") is None


@pytest.mark.parametrize(("kc", "reported"), [(0.92, False), (0.85, True), (0.0, True), (None, False)])
def test_a_critical_kh_that_needs_tension_is_reported(kc: float | None, reported: bool) -> None:
    answer = fem(Config.parse(slope()))
    cracked = None if kc is None else kc * answer.kc
    variants = [variant("tension", "no tensile strength", cracked)]
    texts = [text for _, text in tension_warning(answer, variants, Config.parse(slope()).section)]
    assert bool(texts) == reported
    change = f"{100.0 * (1.0 - kc):.0f} % smaller" if kc else "fails under its own weight"  # was "0.000, 100 % smaller"
    assert all(change in text for text in texts)
    # slices of no thickness topple from a quay at any Kh, which says nothing of it unless it fails by its weight
    quay = Config.parse({**slope(), "surface": [[0, 20], [50, 20], [50, 12], [100, 12]]}).section
    assert bool([*tension_warning(answer, variants, quay)]) == (kc == 0.0)


def test_ground_with_cracks_that_needs_tension_is_advised_to_crack_deeper() -> None:
    """Rock with cracks of 12 m was advised to give a [tension_crack]."""
    answer = fem(Config.parse(slope()))
    for crack, advice in ((None, ": give a [tension_crack]"), (2.0, ": give deeper cracks in [tension_crack]")):
        data = slope() if crack is None else {**slope(), "tension_crack": {"bottom": {"depth": crack}}}
        section = Config.parse(data).section
        ((_, text),) = tension_warning(answer, [variant("tension", "no tensile strength", 0.0)], section)
        assert f"{advice}, or tension =" in text


def test_the_finite_elements_alone_report_a_critical_kh_that_needs_tension() -> None:
    answer, section = fem(Config.parse(slope())), Config.parse(slope()).section
    for share, reported in ((0.92, False), (0.85, True)):
        cracked = variant("tension", "no tensile strength", share * 0.3).model_copy(update={"kc_without": 0.3})
        alone = answer.model_copy(update={"without_tension": cracked})
        assert bool([*tension_warning(alone, (), section)]) == reported
        assert any("without tensile strength" in text for text in fem_sentences(alone, section)) == reported


def test_the_finite_elements_compute_the_critical_kh_without_tensile_strength() -> None:
    run = Config.parse(slope()).with_settings("fem", direction="downhill", accuracy=0.1, safety_factor_at=())
    mesh = generate(run.section, run.mesh)
    result = assess(run.section, run.mesh, mesh, run.fem, MPI.COMM_SELF, lambda what, path: None)
    cracked = without_tensile_strength(run, result, silent)
    assert cracked is not None
    assert cracked.kc is not None
    assert cracked.kc_without is not None
    assert 0.0 <= cracked.kc < cracked.kc_without == pytest.approx(result.critical.kc, rel=0.1)
    data = slope()
    for stratum in data["strata"]:
        stratum["tension"] = "0 kPa"
    assert (
        without_tensile_strength(run.model_copy(update={"section": Config.parse(data).section}), result, silent) is None
    )
