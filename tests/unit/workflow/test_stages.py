"""What the stages say of themselves."""

import pkgutil
from importlib import import_module

import workflow.stages
from tests.support.sections import slope
from workflow.config import Config
from workflow.stages import STAGES


def test_every_declared_stage_is_in_the_list_after_what_it_needs() -> None:
    modules = [import_module(f"workflow.stages.{each.name}") for each in pkgutil.iter_modules(workflow.stages.__path__)]
    assert {module.STAGE for module in modules if hasattr(module, "STAGE")} == set(STAGES)
    names = [stage.name for stage in STAGES]
    assert len(set(names)) == len(names)
    for number, stage in enumerate(STAGES):
        assert set(stage.needs) <= set(names[:number])


def test_stages_name_tables_and_settings_that_there_are() -> None:
    given = Config.parse(slope())
    for stage in STAGES:
        for name in (*stage.reads, *stage.ignores(given)):
            table, _, key = name.partition(".")
            assert table in Config.tables()
            assert not key or key in type(Config.model_fields[table].default).model_fields
