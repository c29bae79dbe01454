"""Cone penetration tests in GEF: quantities by their numbers, in any order and unit; what is none is refused."""

from pathlib import Path

import pytest

from meshes.borings.gef_file import read_gef
from meshes.errors import InputError
from tests.support import command_line

HEAD = """#GEFID = 1, 1, 0
#REPORTCODE = GEF-CPT-Report, 1, 1, 2, -
#TESTID = S04
#XYID = 31000, 136079.00, 456137.00, 0.01, 0.01
#ZID = 31000, 3.056, 0.01
#MEASUREMENTVAR = 3, 0.75, -, net area ratio
"""


def written(folder: Path, columns: str, data: str, head: str = HEAD) -> Path:
    path = folder / "s04.gef"
    path.write_text(f"{head}{columns}#EOH=\n{data}", encoding="cp1252")
    return path


def test_quantities_are_known_by_their_numbers(tmp_path: Path) -> None:
    """qt = qc + (1 - a) u2; depth is the corrected one; friction of the ratio where it is not measured; voids are left
    out, and so is what lies above the ground of the push."""
    columns = """#COLUMNSEPARATOR = ;
#RECORDSEPARATOR = !
#COLUMNINFO = 1, MPa, Waterspanning u2, 6
#COLUMNINFO = 2, m, Sondeerlengte, 1
#COLUMNINFO = 3, kPa, Conusweerstand, 2
#COLUMNINFO = 4, %, Wrijvingsgetal, 4
#COLUMNINFO = 5, cm, Gecorrigeerde diepte, 11
#COLUMNVOID = 3, -9999
#COLUMNVOID = 1, -9999
"""
    data = "-9999;0.00;-9999;0;0.0;!\n0.2;1.00;4000;2.5;99.0;!\n-9999;2.00;8000;0.5;198.0;!\n0.1;3.0;-9999;1;297;!\n"
    (log,) = read_gef(written(tmp_path, columns, data)).logs
    assert (log.name, log.location, log.ground_level, log.layers) == ("S04", (136079.0, 456137.0), 3.056, ())
    assert [cone.depth for cone in log.cones] == pytest.approx([0.99, 1.98])
    assert [cone.qc for cone in log.cones] == pytest.approx([4.0e6 + 0.25 * 0.2e6, 8.0e6])
    assert [cone.fs for cone in log.cones] == pytest.approx([100e3, 40e3])


def test_a_corrected_resistance_counts_and_lengths_may_fall(tmp_path: Path) -> None:
    columns = "".join(
        f"#COLUMNINFO = {k}, {unit}, -, {number}\n"
        for k, (unit, number) in enumerate([("m", 1), ("MPa", 2), ("MPa", 13), ("MPa", 3)], start=1)
    )
    (log,) = read_gef(written(tmp_path, columns, " -5.0e-01 2.0 2.1 2.0e-02\n -1.0 3.0 3.2 -0.001\n")).logs
    assert [(cone.depth, cone.qc, cone.fs) for cone in log.cones] == [(0.5, 2.1e6, 20e3), (1.0, 3.2e6, 0.0)]


def test_units_of_the_national_registry_have_their_names_behind_them(tmp_path: Path) -> None:
    columns = "#COLUMNINFO= 1, m (meter), diepte, 11\n#COLUMNINFO= 2, kPa (kiloPascal), conusweerstand, 2\n"
    columns += "#COLUMNINFO= 3, % (procent; MPa/MPa), wrijvingsgetal, 4\n#COLUMNSEPARATOR= ;\n"
    (log,) = read_gef(written(tmp_path, columns, "1.5;4000;2.0\n")).logs
    assert [(cone.depth, cone.qc, cone.fs) for cone in log.cones] == [(1.5, 4.0e6, 80e3)]


PLAIN = "#COLUMNINFO = 1, m, l, 1\n#COLUMNINFO = 2, MPa, qc, 2\n#COLUMNINFO = 3, MPa, fs, 3\n"


@pytest.mark.parametrize(
    ("columns", "data", "head", "message"),
    [
        (PLAIN, "1 2 0.1\n", HEAD.replace("CPT", "BORE"), "expected a cone penetration test in GEF.*, not GEF-BORE"),
        (PLAIN.replace("fs, 3", "fs, 8"), "1 2 0.1\n", HEAD, r"expected columns of depth .* and sleeve friction \(3\)"),
        (PLAIN, "1 2 0.1\n2 much 0.1\n", HEAD, "reading 2 is '2 much 0.1': expected numbers"),
        (PLAIN, "1 2\n", HEAD, "reading 1 has 2 numbers; expected 3"),
        (PLAIN.replace("MPa, qc", "kN, qc"), "1 2 0.1\n", HEAD, "the header of the file cannot be read: .*kN"),
        (PLAIN, "", HEAD, "has no reading"),
        (PLAIN.replace("MPa, qc", "kPa, qc"), "1 2 0.1\n2 9 0.1\n", HEAD, "sounding S04, largest qc"),
    ],
)
def test_what_is_no_sounding_is_refused_with_a_sentence(
    columns: str, data: str, head: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        read_gef(written(tmp_path, columns, data, head))


def test_a_sounding_between_borings_has_a_place_in_their_section(tmp_path: Path) -> None:
    rows = [f"B{k},{136000 + 100 * k},456137,{3.1 - k},{top},{bottom},{name}" for k in (0, 1, 2)
            for top, bottom, name in ((0, 4, "Klei"), (4, 12, "Zand"))]  # fmt: skip
    borings = tmp_path / "b.csv"
    borings.write_text("boring,easting,northing,ground_level,top,bottom,layer\n" + "\n".join(rows) + "\n")
    data = "".join(f"{0.5 * k} {1.0 + 0.1 * k} 0.02\n" for k in range(1, 20))
    out = tmp_path / "s.toml"
    assert command_line.run("section", borings, written(tmp_path, PLAIN, data), "--out", out) == 0
    text = out.read_text()
    assert 'name = "S04"' in text
    assert "x = 79" in text
