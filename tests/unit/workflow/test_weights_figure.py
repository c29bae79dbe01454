"""The picture of weights and pore pressure: one view without water, two with it; the report's table of strata."""

from pathlib import Path

from PIL import Image

from meshes.section.section import Section
from tests.support import SECTIONS
from tests.support.water import section, soil
from workflow.figures.weights import weights_sheet
from workflow.report.tables import line_rows, written_columns, written_rows


def test_there_is_a_view_of_the_pore_pressure_where_there_is_any(tmp_path: Path) -> None:
    table = [[0, 7], [20, 6], [36, 3.6], [60, 3.6]]
    load = {"from": 2, "to": 12, "pressure": ["10 kPa", "30 kPa"]}
    wet = section(water={"table": table, "after_drawdown": 2.0}, surcharges=[load])
    for name, item in (("wet", wet), ("dry", section()), ("s13", Section.read(SECTIONS / "s13.toml"))):
        weights_sheet(item).save(tmp_path / f"{name}.png")
    heights = {name: Image.open(tmp_path / f"{name}.png").height for name in ("wet", "dry")}
    assert heights["wet"] > 1.5 * heights["dry"]
    assert (tmp_path / "s13.png").stat().st_size > 10_000


def test_the_report_has_the_water_of_the_strata_in_their_table() -> None:
    ground = section(
        soil("Sand", bottom={"elevation": 3.0}, piezometric_level=8.0), soil("Clay", pore_pressure_ratio=0.3)
    )
    symbols = [symbol for _, symbol, _ in written_columns(ground)]
    assert symbols[-2:] == ["saturated density", "pore pressure ratio"]
    rows = {row[0]: row for row in written_rows(ground)}
    assert rows["Clay"][-2] == "0.3"
    assert rows["Sand"][-2] == "–"
    assert "piezometric level of Sand" in [name for name, *_ in line_rows(ground)]
