"""A file with several faults is refused once, with a sentence on each fault."""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from meshes.errors import InputError
from tests.support.sections import slope
from workflow.cli.invocation import Invocation

Data = dict[str, Any]


def table(name: str, **values: Any) -> Callable[[Data], None]:
    """Return a change of a table of settings."""
    return lambda data: data.setdefault(name, {}).update(values)


def stratum(number: int, **values: Any) -> Callable[[Data], None]:
    """Return a change of a stratum."""
    return lambda data: data["strata"][number].update(values)


# A change of the file, and a part of the sentence on its fault.
FAULTS: dict[str, tuple[Callable[[Data], None], str]] = {
    "key of the section": (lambda data: data.update(watertabel=3), "watertabel: unknown key"),
    "unit": (stratum(0, cohesion="25 kg"), "cohesion = '25 kg': has the wrong dimension"),
    "geometry": (stratum(0, bottom={"elevation": 30.0}), "geometry: "),
    "case of a stratum": (stratum(1, liquefies_in=[9]), "liquefies_in = [9]: expected cases from 1 to 3"),
    "key of a table": (table("fem", elment="auto"), "fem, elment: unknown key"),
    "half of the cycles": (table("slide", kh=0.1, kh_cycles=10.0), "slide, kh_cycles and kh_period: expected both"),
    "missing record": (table("sliding_block", accelerogram="none.EW"), "none.EW: there is no such file"),
    "unreadable record": (table("site_response", record="words.csv"), "words.csv: is no accelerogram"),
    "unknown stratum": (table("mesh", sizes={"Gravel": "1 m"}), 'mesh, sizes: there is no "Gravel"'),
    "earthquake": (table("earthquake", magnitude="big"), "earthquake, magnitude = 'big'"),
}


def refusal(faults: list[str], folder: Path) -> str:
    """Return the message on a file with these faults."""
    data = copy.deepcopy(slope())
    for fault in faults:
        FAULTS[fault][0](data)
    (folder / "words.csv").write_text("no record\nat all\n", encoding="utf-8")
    path = folder / "slope.toml"
    path.write_text(tomli_w.dumps(data), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        Invocation.of(path, folder / "run", {}, None)
    return str(caught.value)


@pytest.mark.parametrize("first", FAULTS)
@pytest.mark.parametrize("second", FAULTS)
def test_two_faults_are_told_at_once(first: str, second: str, tmp_path: Path) -> None:
    """A missing file, half of the cycles or an unknown case were told only once the section was in order."""
    message = refusal([first, second], tmp_path)
    for fault in (first, second):
        assert FAULTS[fault][1] in message


def test_all_faults_are_told_at_once(tmp_path: Path) -> None:
    message = refusal([*FAULTS], tmp_path)
    assert all(sentence in message for _, sentence in FAULTS.values()), message
    assert f"{len(FAULTS)} problems" in message
