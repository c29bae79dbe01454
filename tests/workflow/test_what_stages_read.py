"""A stage depends on the settings that it reads, and on no others: seen by what its work reads while it runs."""

import tomllib
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes.errors import NoAnswerError
from tests.support import small_run
from tests.support.borings import bored
from tests.support.command_line import unpainted
from tests.support.sections import analysed
from tests.support.settings_reads import KEYS, altered, stale, traced, with_needed
from tests.support.toy_stages import Heard
from tests.workflow.test_soil_discs import SECTION
from workflow.config import Config
from workflow.run import pipeline
from workflow.run.fingerprint import title
from workflow.run.plan import Choice
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages.declared import STAGES

Reads = dict[str, set[str]]

ELSEWHERE = "mesh.least_thickness"  # is read by the process of gmsh, which nobody looks into

# What stages take of these tables is worked out when the input is read: F_L, cases, and what liquefies in them.
# Of a criterion, slip circles take the Kh alone: another limit changes no circle.
TAKEN = ("earthquake", "triggering", "slide.cases", "criteria.factor_of_safety")


def read_by(inputs: Config, folder: Path) -> Reads:
    """The settings that the work of every stage reads, all stages run in this process."""
    values: Reads = {}
    stages = traced(STAGES, values)
    # discs that are only roughly at rest may be out of reach
    with suppress(NoAnswerError), pytest.MonkeyPatch.context() as patch:
        unpainted(patch)
        pipeline.execute(Job(inputs, Store(folder), stages), Choice.of(stages), Heard(), "test")
    return values


def papers(folder: Path) -> Config:
    """A few of the paper's discs for a moment in one case, and all that stands beside them."""
    slide = {**small_run.SHORT_SLIDE, "cases": [{"stiffness": 0.1}]}
    data = tomllib.loads(small_run.written(folder, slide=slide).read_text())
    data["sliding_block"] = {"accelerogram": str(folder / "quake.csv")}
    data["slide"] |= {"judges": ["discs", "mpm"], "mpm_cells": 100}
    # a packing that so few discs have at once: at the porosity of more of them seven are tried in vain, nine times
    dem = {**small_run.FEW_DISCS, "model": "paper", "porosity": 0.27, "workers": 1}
    return analysed({**data, "dem": dem})


def soil(folder: Path) -> Config:
    """Soil discs, calibrated on two packings, and a moment of material points, on an adapted mesh; clay that loses its
    peak strength, below tension cracks."""
    few = {"elements": 150, "resolution": 0.1, "workers": 1}
    slide = {**SECTION["slide"], "judges": ["discs", "mpm"], "duration": 1.0, "mpm_cells": 300}
    slide |= {"kh_seconds": None, "kh_cycles": 1.0, "kh_period": 0.5}
    crust, loose, clay = SECTION["strata"]
    strata = [crust, loose, {**clay, "residual_cohesion": "25 kPa", "residual_friction_angle": "0 deg"}]
    adapted = {"mesh": {"max_cells": 200}, "fem": {**SECTION["fem"], "accuracy": 0.2, "max_cells": 400}}
    adapted["tension_crack"] = {"bottom": {"depth": 0.5}, "water": 0.2}
    return analysed({**SECTION, **adapted, "strata": strata, "dem": {**SECTION["dem"], **few}, "slide": slide})


def shaking(folder: Path) -> Config:
    """The paper's discs beside a path with ψ as given, borings, a record that makes strata liquefy by their F_L, and
    ground that loses its peak strength."""
    data = tomllib.loads(small_run.written(folder).read_text())
    tests = [{"depth": 1.0 + k, "N": 4} for k in range(8)]
    del data["strata"][0]["liquefies_in"]
    data["strata"][1] |= {"liquefies_in": "triggered", "cohesion": "60 kPa"}
    data["strata"][1] |= {"residual_cohesion": "30 kPa", "residual_friction_angle": "10 deg"}
    quake = str(folder / "quake.csv")
    cases = [{"stiffness": 0.1, "residual_strength": "60 kPa"}]
    data |= {
        "mesh": {"method": "free", "size": 3.0},
        "site_response": {"record": quake, "scale": 0.1, "slip_depth": 4.0},
        "water_table": {"depth": 0.5},
        "fem": {**data["fem"], "flow": "non-associated"},
        "bounds": {**data["bounds"], "safety_factor": True},
        "earthquake": {"magnitude": 7.5, "peak_acceleration": "300 gal"},
        "triggering": {"borings": [{"name": "B-1", "x": 50.0, "spt": tests}]},
        "dem": {**small_run.FEW_DISCS, "model": "paper", "workers": 1},
        "slide": {**small_run.SHORT_SLIDE, "judges": ["discs", "mpm"], "cases": cases, "accelerogram": quake},
        "sliding_block": {},
    }
    return analysed(data)


def embankment(folder: Path) -> Config:
    """An embankment with a crest, whose faces are analysed, without slides."""
    data = tomllib.loads(small_run.written(folder).read_text())
    data["surface"] = [[0.0, 10.0], [20.0, 10.0], [26.0, 16.0], [36.0, 16.0], [54.0, 10.0], [70.0, 10.0]]
    data["structures"] = [{"name": "Embankment", "from": 26.0, "to": 36.0, "kind": "levee"}]
    data["bounds"] |= {"safety_factor": True}
    del data["strata"][0]["liquefies_in"]
    del data["slide"], data["sliding_block"]
    return analysed(data)


@pytest.fixture(scope="module")
def of_the_papers(tmp_path_factory: pytest.TempPathFactory) -> tuple[Config, Reads]:
    folder = tmp_path_factory.mktemp("papers")
    config = papers(folder)
    return config, read_by(config, folder / "out")


def unheard(inputs: Config, reads: Reads) -> set[tuple[str, str]]:
    """Stages, and settings that their work reads, whose change would not make them run again."""
    ignored = {stage.name: set(stage.ignores(inputs)) for stage in STAGES}
    return {
        (name, key)
        for key in KEYS
        if not key.startswith(TAKEN)
        for name in reads.keys() - stale(inputs, altered(inputs, key))
        if key in reads[name] and key not in ignored[name] and key.partition(".")[0] not in ignored[name]
    }


def test_what_a_stage_reads_makes_it_run_again(of_the_papers: tuple[Config, Reads]) -> None:
    config, reads = of_the_papers
    assert set(reads) == {
        "mesh", "fem", "variants", "bounds", "slices", "liquefied", "mpm", "calibrate", "slide", "report",
    }  # fmt: skip
    assert all(reads.values())
    assert unheard(config, reads) == set()


@pytest.mark.slow
def test_what_no_stage_reads_makes_none_run_again(of_the_papers: tuple[Config, Reads], tmp_path: Path) -> None:
    """Over inputs that take other ways through the program: whatever makes a stage run again is read by it, or by one
    that it needs, in one of them."""
    seen = [of_the_papers]
    for kind in (soil, shaking, embankment):
        (folder := tmp_path / kind.__name__).mkdir()
        item = kind(folder)
        seen.append((item, read_by(item, folder / "out")))
    read = {stage.name: set().union(*(reads.get(stage.name, set()) for _, reads in seen)) for stage in STAGES}
    for item, reads in seen:
        assert unheard(item, reads) == set()
        needless = {
            (name, key)
            for key in KEYS
            if not key.startswith(TAKEN)
            for name in stale(item, altered(item, key)) - {"report"}  # it lists all that is not the default
            if key != ELSEWHERE and not any(key in read[other] for other in with_needed(name))
        }
        assert needless == set()


@pytest.mark.parametrize(
    ("key", "again"),
    [
        ("slide.seeds", {"slide"}),
        ("slide.duration", {"mpm", "slide"}),
        ("slide.component", {"mpm", "slide"}),
        ("dem.elements", {"calibrate", "slide"}),
        ("dem.kh", {"calibrate"}),
        ("dem.workers", set()),
        ("dem.resolution", set()),  # of the paper's discs, which are not asked for
        ("fem.threads", set()),
        ("fem.safety_factor_at", {"fem", "slices"}),
        ("fem.rigid_box", {"calibrate", "slide"}),
        ("bounds.gap", {"bounds", "faces"}),
        ("earthquake.magnitude", {"triggering"}),
        ("site_response.base_velocity", {"response"}),
        ("free_face.at", set()),
        ("figures.report_width", set()),
    ],
)
def test_which_stages_run_again(key: str, again: set[str]) -> None:
    config = analysed(SECTION)
    assert stale(config, altered(config, key)) == {*again, "report"}


@pytest.mark.parametrize(("kh", "again"), [(0.0, set()), (0.1, {"slices"})])
def test_a_criterion_changes_slip_circles_by_its_kh_alone(kh: float, again: set[str]) -> None:
    """Every change of a limit or of its source made the circles run again, and left them out of a report alone."""
    plain = analysed(SECTION)
    limits = [analysed({**SECTION, "criteria": {"factor_of_safety": {"limit": x, "kh": kh}}}) for x in (1.1, 1.2)]
    assert stale(plain, limits[0]) == {*again, "report"}
    assert stale(*limits) == {"report"}


def test_what_a_section_is_called_changes_no_result() -> None:
    before = analysed(SECTION)
    for changes in ({"name": "another", "title": "Another"}, {"report": {"project": "Another", "number": "2"}}):
        assert stale(before, analysed({**SECTION, **changes})) == {"report"}
    named = analysed({**SECTION, "structures": [{"name": "bank", "from": 10.0, "to": 30.0}]})
    assert stale(before, named) == {"slices", "faces", "liquefied", "report"}  # circles of its faces
    renamed = analysed({**SECTION, "structures": [{"name": "quay", "kind": "quay", "from": 10.0, "to": 30.0}]})
    assert stale(named, renamed) == {"slices", "faces", "report"}
    assert title(before) == title(named)  # pictures are not drawn again


def test_blow_counts_make_what_follows_run_again_only_where_they_change_what_liquefies() -> None:
    def bored_with(**changes: Any) -> Config:
        data = bored()
        data["water"] = {"table": data.pop("water_table")}
        for stratum in data["strata"]:
            del stratum["density_ordinary"], stratum["density_seismic"]
            stratum |= {"density": "1.7 t/m^3", "density_saturated": "1.9 t/m^3"}
        data["earthquake"] |= changes
        data["slide"] = {**data.get("slide", {}), "kh": 0.1}  # else it follows from the earthquake, and so do slides
        return analysed(data)

    before, as_before, less = (bored_with(peak_acceleration=f"{a} gal") for a in (250, 251, 20))
    assert [bool(s.liquefies_in) for s in less.section.strata] != [bool(s.liquefies_in) for s in before.section.strata]
    assert stale(before, as_before) == {"triggering", "report"}
    assert stale(before, less) == {"triggering", "liquefied", "mpm", "slide", "report"}


@pytest.mark.slow
def test_what_the_elements_ignore_changes_nothing(tmp_path: Path) -> None:
    """Threads and factors of safety: the critical Kh, its path and the box that discs are held against are the same to
    the last bit."""
    from workflow.results.continuum import FemAnswer

    config = papers(tmp_path)
    fem = config.fem.model_copy(update={"threads": 2, "safety_factor_at": (0.1,)})
    results = []
    for number, item in enumerate((config, config.model_copy(update={"fem": fem}))):
        store, stages = Store(tmp_path / str(number)), tuple(STAGES)
        pipeline.execute(Job(item, store, stages), Choice.of(stages, only=["mesh", "fem"]), Heard(), "test")
        results.append(FemAnswer.read(store))
    first, other = (entry.model_copy(update={"settings": config.fem, "safety_factors": ()}) for entry in results)
    assert first == other
    assert np.isfinite(first.kc)
