"""Borings of AGS3 files."""

from pathlib import Path

import pytest

from meshes.borings.ags4_file import read_ags4

FOOT = 0.3048
AGS3 = """"**PROJ"
"*PROJ_ID","*PROJ_AGS"
"1","3.1"

"**DICT"
"*DICT_TYPE","*DICT_GRP","*?DICT_PGRP"
"GROUP","BKFL","HOLE"

"**ABBR"
"*ABBR_HDNG","*ABBR_CODE","*ABBR_DESC"
"GEOL_LEG","102","MADE GROUND"

"**HOLE"
"*HOLE_ID","*HOLE_NATE","*HOLE_NATN",
"*HOLE_GL"
"<UNITS>","m","m","ft"
"B1","100","200","40"
"B2","130","200","30"
"B3","160","200","Null"

"**GEOL"
"*HOLE_ID","*GEOL_TOP","*GEOL_BASE","*GEOL_DESC","*GEOL_LEG","*GEOL_GEOL"
"<UNITS>","m","m","","",""
"B1","0","4","Soft to ","102","-"
"<CONT>","","","firm","",""
"B1","4","10","","201","SAND"
"B2","0","7","","201","SAND"
"B3","0","7","","201","SAND"

"**ISPT"
"*HOLE_ID","*ISPT_TOP","*ISPT_NVAL","*ISPT_REP"
"<UNITS>","m","",""
"B1","4.5","","50/75mm (25,50)"

"**WSTK"
"*HOLE_ID","*WSTK_DEP","*WSTK_POST"
"<UNITS>","m","m"
"B1","3.5","2.5"
"""


def test_ags3_with_a_boring_without_its_level(tmp_path: Path) -> None:
    """Groups in DICT make no AGS4 of it; a code has the name that ABBR gives, a dash is no name; B3 is left out."""
    path = tmp_path / "old.ags"
    path.write_text(AGS3, encoding="utf-8")
    read = read_ags4(path)
    item, two = read.logs
    assert (item.ground_level, two.ground_level) == (pytest.approx(40 * FOOT), pytest.approx(30 * FOOT))
    assert [(layer.name, layer.bottom, layer.description) for layer in item.layers] == [
        ("MADE GROUND", 4, "Soft to firm"), ("SAND", 10, "")
    ]  # fmt: skip
    assert item.water_level == pytest.approx(40 * FOOT - 2.5)
    assert [(sample.depth, sample.N) for sample in item.samples] == [(4.8, 50)]
    assert "old.ags is AGS3, and is read as AGS4: HOLE as LOCA, WSTK as WSTG, STCN as SCPT" in read.notices
    assert any(text.startswith("a boring is left out: boring B3, LOCA_GL is missing") for text in read.notices)
