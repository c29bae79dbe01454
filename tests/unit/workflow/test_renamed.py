"""Old words of settings: read, told in one line, and rewritten in a file whose comments stay."""

import importlib
import pkgutil
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

import workflow.results
from meshes.errors import InputError
from tests.support import SECTIONS
from tests.support.command_line import run
from workflow.cli.invocation import Invocation
from workflow.config import Config, renamed
from workflow.config.renamed import ANSWER_KEYS, Renamed, current, current_answer, notices, rewritten
from workflow.results.answer import Part
from workflow.study.result_cache import Outcome
from workflow.study.task import Numbers
from workflow.uncertain.settings import UncertainSettings

OLD = """# sides = "roller" is an old word
name = "roller"
[fem]   # elements
sides = 'roller'  # as before
[uncertain]
"fem.sides" = { list = [
    "roller",  # one
    "tied",
] }
"""


def test_old_values_are_replaced_where_the_setting_stands_and_nowhere_else() -> None:
    text, changes = rewritten(OLD, "old.toml")
    expected = OLD.replace("sides = 'roller'", "sides = 'free-field'")
    expected = expected.replace('    "roller"', '    "free-field"').replace('"tied"', '"periodic"')
    assert text == expected
    assert changes == [
        "line 4: 'roller' -> 'free-field'",
        'line 7: "roller" -> "free-field"',
        'line 8: "tied" -> "periodic"',
    ]
    assert tomllib.loads(text) == current(tomllib.loads(OLD))
    assert rewritten(text, "new.toml") == (text, [])
    assert notices(tomllib.loads(text)) == []


def test_each_old_word_is_told_once() -> None:
    messages = notices(tomllib.loads(OLD))
    assert [line.split(";")[0] for line in messages] == [
        'fem.sides = "roller" is now fem.sides = "free-field"',
        'fem.sides = "tied" is now fem.sides = "periodic"',
    ]


@pytest.mark.parametrize("text", ["fem.sides = 'tied'", "fem = { sides = 'tied' }", "[fem]\r\n'sides'='tied'\r\n"])
def test_every_way_to_write_a_setting_is_rewritten(text: str) -> None:
    assert rewritten(text, "old.toml")[0] == text.replace("tied", "periodic")


def test_the_flow_rule_of_a_path_has_the_name_of_the_field() -> None:
    """The old word is that of a section, too, which stays."""
    old = 'name = "section"\n[fem]\nflow = "section"\n'
    text, changes = rewritten(old, "old.toml")
    assert text == 'name = "section"\n[fem]\nflow = "non-associated"\n'
    assert changes == ['line 3: "section" -> "non-associated"']
    assert [line.split(";")[0] for line in notices(tomllib.loads(old))] == [
        'fem.flow = "section" is now fem.flow = "non-associated"'
    ]
    assert current_answer({"flow": "section", "section": {"flow": True}}) == {
        "flow": "non-associated", "section": {"flow": True},
    }  # fmt: skip


def test_a_word_that_is_spelt_out_by_escapes_is_told() -> None:
    with pytest.raises(InputError, match=r'change by hand: fem.sides = "tied" is now fem.sides = "periodic"'):
        rewritten('[fem]\nsides = "t\\u0069ed"', "old.toml")


def test_old_keys_of_distributions_and_correlated_pairs_are_read_and_rewritten() -> None:
    """The words are those of comments and of names, too, which stay."""
    old = """name = "of what it does"  # between
[uncertain]
"strata.does.friction_angle" = { normal = [33, 2], between = [28, 38] }  # does
"strata.*.cohesion" = { lognormal = [1.0, 0.3], does = "factor" }
"fem.sides" = { list = ["tied", "does"], chances = [1, 2] }
correlated = [{ of = ["strata.does.friction_angle", "strata.*.cohesion"], coefficient = 0.5 }]
"""
    new = old.replace(" between =", " truncation =").replace(" does =", " applied_as =").replace('"tied"', '"periodic"')
    new = new.replace("chances =", "probabilities =").replace("{ of =", "{ paths =")
    assert rewritten(old, "old.toml")[0] == new
    assert current(tomllib.loads(old)) == tomllib.loads(new)
    assert [line.split(";")[0] for line in notices(tomllib.loads(old))] == [
        'fem.sides = "tied" is now fem.sides = "periodic"',
        'The key "between" of a distribution in [uncertain] is now "truncation"',
        'The key "does" of a distribution in [uncertain] is now "applied_as"',
        'The key "chances" of a distribution in [uncertain] is now "probabilities"',
        'The key "of" of a correlated pair in [uncertain] is now "paths"',
    ]
    assert notices(tomllib.loads(new)) == []
    UncertainSettings.model_validate(current(tomllib.loads(old))["uncertain"])


@pytest.fixture
def a_key_of_tomorrow(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A renaming of a key, which is one entry more."""
    monkeypatch.setattr(renamed, "RENAMED", (*renamed.RENAMED, Renamed("fem", "least_depth", new_key="minimum_depth")))
    return


@pytest.mark.usefixtures("a_key_of_tomorrow")
def test_a_later_renaming_is_one_entry() -> None:
    old = '[fem]\nleast_depth = "1 m"  # least_depth\nsides = "tied"\n[uncertain]\n"fem.least_depth" = { list = [1] }\n'
    text, changes = rewritten(old, "old.toml")
    new = old.replace('least_depth = "1', 'minimum_depth = "1').replace("fem.least", "fem.minimum")
    assert text == new.replace("tied", "periodic")
    assert len(changes) == 3
    assert notices(tomllib.loads(old))[1].startswith("fem.least_depth is now fem.minimum_depth; ")


def test_answers_of_old_folders_are_read() -> None:
    old = {"settings": {"sides": "roller", "kh": [0.1]}, "name": "tied", "skins": [], "cases": [{"sides": "tied"}]}
    assert current_answer(old) == {
        "settings": {"sides": "free-field", "kh": [0.1]}, "name": "tied", "shallow_failures": [],
        "cases": [{"sides": "periodic"}],
    }  # fmt: skip


@pytest.mark.parametrize(("old", "new", "sibling"), ANSWER_KEYS)
def test_an_old_key_is_renamed_only_in_the_table_that_has_it(old: str, new: str, sibling: str) -> None:
    assert new in current_answer({old: 1, sibling: 2} if sibling else {old: 1})
    assert current_answer({old: 1, "Silt": 2}) == ({old: 1, "Silt": 2} if sibling else {new: 1, "Silt": 2})
    for module in pkgutil.iter_modules(workflow.results.__path__):
        importlib.import_module(f"workflow.results.{module.name}")
    parts = [part.model_fields for part in (*parts_of(Part), Outcome, Numbers)]
    assert any(new in fields and (not sibling or sibling in fields) for fields in parts) or new == "warning"
    assert not any(old in fields and sibling in fields for fields in parts)


def parts_of(part: type[Part]) -> list[type[Part]]:
    return [each for child in part.__subclasses__() for each in (child, *parts_of(child))]


def test_old_words_in_file_and_on_the_command_line_are_read_with_a_notice(tmp_path: Path) -> None:
    text = (SECTIONS / "slope_2to1.toml").read_text(encoding="utf-8") + '\n[fem]\nsides = "roller"\n'
    path = tmp_path / "slope.toml"
    path.write_text(text, encoding="utf-8")
    invocation = Invocation.of(path, tmp_path, {}, None)
    assert invocation.config.fem.sides == "free-field"
    assert len(invocation.notices) == 1
    assert '"free-field"' in invocation.config.to_toml()
    values = Invocation.of(SECTIONS / "slope_2to1.toml", tmp_path, {"fem": {"sides": "roller"}}, None)
    assert values.config.fem.sides == "free-field"
    assert len(values.notices) == 1
    assert Invocation.of(SECTIONS / "slope_2to1.toml", tmp_path, {}, ["fem.sides=smooth"]).notices == []
    assert Config.load(path).fem.sides == "free-field"


def test_migrate_writes_only_where_it_is_told_to(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = tmp_path / "old.toml", tmp_path / "new.toml"
    old.write_text(OLD, encoding="utf-8")
    assert run("migrate", old) == 0
    assert "line 4: 'roller' -> 'free-field'" in capsys.readouterr().out
    assert old.read_text(encoding="utf-8") == OLD
    assert run("migrate", old, "-o", new) == 0
    assert run("migrate", old, "-o", new) == 2
    assert "exists already" in capsys.readouterr().err
    assert run("migrate", old, "--write") == 0
    assert old.read_text(encoding="utf-8") == new.read_text(encoding="utf-8") == rewritten(OLD, "old.toml")[0]


def test_old_words_in_the_folder_of_a_run_are_read_with_a_notice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "run"
    assert run("mesh", SECTIONS / "slope_2to1.toml", "--out", folder, "--set", "fem.sides=free-field", "-q") == 0
    text = (folder / "section.toml").read_text(encoding="utf-8")
    assert 'sides = "free-field"' in text
    (folder / "section.toml").write_text(text.replace('sides = "free-field"', 'sides = "roller"'), encoding="utf-8")
    capsys.readouterr()
    assert run("report", folder) == 0
    assert 'fem.sides = "roller" is now fem.sides = "free-field"' in capsys.readouterr().out
