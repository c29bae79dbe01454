"""Cone penetration tests of the Dutch registry in XML: the quantities of a reading stand in a fixed order."""

from pathlib import Path

import pytest

from meshes.borings.bro_file import read_bro
from meshes.errors import InputError

DOCUMENT = """<r:dispatchDataResponse xmlns:r="urn:r" xmlns:c="urn:c" xmlns:g="urn:g"><r:CPT_O><c:broId>CPT07</c:broId>
<r:standardizedLocation><g:pos>51.9 4.4</g:pos></r:standardizedLocation>
<r:deliveredLocation><g:pos>85920.5 441592.25</g:pos></r:deliveredLocation><c:offset uom="m">-0.85</c:offset>
<c:coneSurfaceQuotient uom="1">0.75</c:coneSurfaceQuotient>
<c:dissipationTest><c:disResult><c:values>1,2;3,4</c:values></c:disResult></c:dissipationTest>
<c:conePenetrationTest><c:cptResult><c:values>{rows}</c:values></c:cptResult></c:conePenetrationTest>
</r:CPT_O></r:dispatchDataResponse>"""


def row(**measured: float) -> str:
    """A reading: length 0, depth 1, resistance 3, friction 18, pore pressure u2 22, friction ratio 24."""
    numbers = [-999999.0] * 25
    for place, number in measured.items():
        numbers[int(place[1:])] = number
    return ",".join(f"{number:g}" for number in numbers)


def written(folder: Path, text: str) -> Path:
    path = folder / "cpt.xml"
    path.write_text(text)
    return path


def test_a_document_is_a_sounding(tmp_path: Path) -> None:
    """qt = qc + (1 - a) u2; what was not measured is left out, friction is that of its ratio where it stands alone."""
    rows = [
        row(_0=2.0, _1=1.98, _3=4.0, _18=0.04, _22=0.2),
        row(_0=1.0, _3=2.0, _24=1.5),
        row(_0=3.0, _1=2.9, _18=0.1),
    ]
    (log,) = read_bro(written(tmp_path, DOCUMENT.format(rows=";".join(rows)))).logs
    assert (log.name, log.location, log.ground_level) == ("CPT07", (85920.5, 441592.25), -0.85)
    assert [(cone.depth, cone.qc, cone.fs) for cone in log.cones] == [
        (1.0, pytest.approx(2.0e6), pytest.approx(30e3)),
        (1.98, pytest.approx(4.05e6), pytest.approx(40e3)),
    ]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("r:CPT_O", "r:BHR_O"), "a document with CPT_O, not dispatchDataResponse"),
        (("</g:pos>", ""), "it cannot be read: mismatched tag"),
        (("<c:broId>CPT07</c:broId>", ""), "required parts are missing"),
        (("{rows}", "1,2,3"), "required parts are missing"),
        (("{rows}", row(_0=1.0, _3=4.0)), "the file has no reading with a depth, a resistance and a sleeve friction"),
        (("<r:dis", '<!DOCTYPE a [<!ENTITY b "c">]><r:dis'), "the file defines XML entities"),
    ],
)
def test_what_is_no_sounding_is_told(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_bro(written(tmp_path, DOCUMENT.replace(*change).replace("{rows}", row(_0=1.0, _3=4.0, _18=0.04))))
