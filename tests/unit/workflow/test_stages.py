"""What the stages say of themselves."""

import pkgutil
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import workflow.stages
from tests.support.sections import slope
from workflow.cli.options import stages_of_slides
from workflow.config import Config
from workflow.run.fingerprint import inputs
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages.declared import STAGES


def test_every_declared_stage_is_in_the_list_after_what_it_needs() -> None:
    modules = [import_module(f"workflow.stages.{each.name}") for each in pkgutil.iter_modules(workflow.stages.__path__)]
    assert {module.STAGE for module in modules if hasattr(module, "STAGE")} == set(STAGES)
    names = [stage.name for stage in STAGES]
    assert len(set(names)) == len(names)
    for number, stage in enumerate(STAGES):
        assert set(stage.needs) <= set(names[:number])


def test_stages_name_tables_and_settings_that_there_are() -> None:
    config = Config.parse(slope())
    for stage in STAGES:
        for name in (*stage.reads, *stage.ignores(config)):
            table, _, key = name.partition(".")
            assert table in Config.tables()
            assert not key or key in type(Config.model_fields[table].default).model_fields


@pytest.mark.parametrize(
    ("key", "value", "stale"),
    [
        ("slide.mpm_sides", "fixed", {"mpm", "slide"}),
        ("slide.mpm_cells", 3001, {"mpm"}),
        ("slide.seeds", (), {"slide"}),
        ("slide.step", 1e-3, {"slide"}),
        ("slide.frames", 31, {"mpm", "slide"}),
        ("slide.methods", ("mpm",), set()),
        ("fem.kh", (0.1,), {"fem", "calibrate", "slide"}),
        ("fem.safety_factor_at", (0.1,), {"fem", "slices"}),
        ("fem.threads", 2, set()),
        ("fem.rigid_box", False, {"calibrate", "slide"}),
        ("bounds.gap", 0.02, {"bounds", "faces"}),
        ("faces.bounds", False, {"faces"}),
        ("faces.run", False, {"liquefied"}),
        ("bounds.run", False, {"faces"}),
        ("dem.elements", 1500, {"calibrate", "slide"}),
        ("dem.kh", (0.1,), {"calibrate"}),
        ("dem.out_of_reach", "go on", {"calibrate"}),
        ("variants.which", ("mesh",), {"variants"}),
        ("site_response.base_velocity", 500.0, {"response"}),
        ("sliding_block.kh", 0.2, set()),
        ("study.samples", 8, set()),
        ("figures.report_width", 900, set()),
        ("report.author", "A. Engineer", set()),
    ],
)
def test_a_setting_makes_those_stages_stale_that_read_it_and_no_others(
    key: str, value: Any, stale: set[str], tmp_path: Path
) -> None:
    """The report is of all stages, and is written anew whatever changes."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    settings_in = Config.parse(data)
    table, _, name = key.partition(".")
    before, after = (
        {stage.name: inputs(stage, Job(config, Store(tmp_path), STAGES)) for stage in STAGES}
        for config in (settings_in, settings_in.with_settings(table, **{name: value}))
    )
    assert {name for name in before if before[name] != after[name]} - {"report"} == stale


@pytest.mark.parametrize(
    ("methods", "wanted"),
    [(["mpm"], {"mpm"}), (["discs"], {"calibrate", "slide"}), (None, {"mpm", "calibrate", "slide"})],
)
def test_slides_are_computed_by_the_methods_of_the_settings_alone(methods: list[str] | None, wanted: set[str]) -> None:
    """`slide.methods = ["mpm"]` calibrated discs all the same, and let them slide, most of the time of a run."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1]
    config = Config.parse(data | ({} if methods is None else {"slide": {"methods": methods}}))
    of_slides = {"mpm", "calibrate", "slide"}
    assert {stage.name for stage in STAGES if stage.name in of_slides and not stage.unwanted(config)} == wanted


@pytest.mark.parametrize(
    ("methods", "model", "names"),
    [
        (("discs", "mpm"), None, ["slide", "mpm"]), (("mpm",), None, ["mpm"]), (("discs",), None, ["slide"]),
        (("discs", "mpm"), "mpm", ["mpm"]), (("mpm",), "discs", ["slide", "calibrate"]),
        (("discs", "mpm"), "discs", ["slide"]),
    ],
)  # fmt: skip
def test_the_command_of_slides_runs_the_stages_of_its_methods(
    methods: tuple[str, ...], model: str | None, names: list[str]
) -> None:
    assert stages_of_slides(methods, model) == names
