"""Terminals and pipes that are not UTF-8: what their encoding does not have is spelled out."""

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from tests.support import TOP
from tests.support.borings import bored
from workflow.run.spelling import SPELLED_OUT, legible, spelled

PLAIN = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}
PLACES: list[Any] = [{"PYTHONIOENCODING": "cp932"}, PLAIN]  # the latter has nothing but ASCII
PLACES += [
    pytest.param({"PYTHONIOENCODING": name}, marks=pytest.mark.slow, id=name)
    for name in ("ascii", "latin-1", "cp1252", "shift_jis")
]


@pytest.mark.parametrize(
    ("text", "ascii_words"),
    [
        ("ψ = φ, Φ and σ'v", "psi = phi, Phi and sigma'v"),
        ("1.2 m², 19 kN/m³, 31°, 5–10 kPa", "1.2 m^2, 19 kN/m^3, 31 deg, 5-10 kPa"),
        ("Krabbenhøft, Perić, Gutiérrez", "Krabbenhoft, Peric, Gutierrez"),
        ("Löß über Mørke Ærø", "Loss uber Morke AEro"),
        ("砂", "\\u7802"),
        ("of a name that is no text: \udce9", "of a name that is no text: \\udce9"),
    ],
)
def test_how_it_is_spelled(text: str, ascii_words: str) -> None:
    assert text.encode("ascii", SPELLED_OUT).decode("ascii") == ascii_words


@given(text=st.text(), encoding=st.sampled_from(["ascii", "latin-1", "cp932", "utf-8"]))
def test_any_text_can_be_written_in_any_encoding(text: str, encoding: str) -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    shown = legible(text, stream)
    assert shown.encode(encoding).decode(encoding) == shown
    assert legible(shown, stream) == shown
    assert legible("Kh = 0.2", stream) == "Kh = 0.2"


@given(character=st.characters())
def test_what_is_spelled_is_ascii_and_something(character: str) -> None:
    assert spelled(character).isascii()
    assert spelled(character)


# One process for several commands, since each would take seconds to import its modules: after each, its exit code.
COMMANDS = """
import sys
from itertools import groupby
from workflow.cli import main
for is_end, arguments in groupby(sys.argv[1:], lambda word: word == "then"):
    if is_end:
        continue
    try:
        main(list(arguments))
        code = 0
    except SystemExit as stop:
        code = stop.code or 0
    sys.stdout.flush()
    sys.stderr.flush()
    print(f"{chr(10)}ended with {code}", flush=True)
"""


def messages_of(requests: list[list[str]], environment: dict[str, str]) -> list[tuple[int, bytes]]:
    """Return exit code and output of each command in a process with this environment."""
    plain = {key: value for key, value in os.environ.items() if key not in ("PYTHONIOENCODING", "LC_ALL", "LANG")}
    words = [word for request in requests for word in (*request, "then")]
    done = subprocess.run(
        [sys.executable, "-c", COMMANDS, *words], cwd=TOP, timeout=120, check=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**plain, "PYTHONPATH": str(TOP), **environment},
    )  # fmt: skip
    parts = re.split(rb"\nended with (\d+)\r?\n", done.stdout)
    return [(int(code), text) for text, code in zip(parts[:-1:2], parts[1::2], strict=True)]


@pytest.fixture(scope="module")
def section(tmp_path_factory: pytest.TempPathFactory) -> Path:
    data = bored()
    data["title"] = "Böschung é, 堤防"
    data["strata"][1]["name"] = "密な砂"
    path = tmp_path_factory.mktemp("spelled") / "bored.toml"
    path.write_text(tomli_w.dumps(data), encoding="utf-8")
    return path


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.get("PYTHONIOENCODING", "plain C"))
def test_commands_answer_wherever_they_are_asked(place: dict[str, str], section: Path, tmp_path: Path) -> None:
    encoding = place.get("PYTHONIOENCODING", "ascii")
    requested = [["check", str(section), "--json"], ["check" if encoding == "ascii" else "liquefaction", str(section)]]
    requested = [[*arguments, "--out", str(tmp_path)] for arguments in requested]
    *answered, missing = messages_of([*requested, ["check", str(section.parent / "ψ.toml")]], place)
    for arguments, (code, messages) in zip(requested, answered, strict=True):
        assert code == 0, messages.decode(encoding, "replace")
        assert b"Traceback" not in messages
        if "--json" in arguments:
            assert json.loads(messages.decode(encoding))["section"]["title"] == "Böschung é, 堤防"
    assert (missing[0], b"there is no such file" in missing[1]) == (2, True)
