"""Records of the three kinds, and what is said of files that are none."""

from pathlib import Path

import numpy as np
import pytest

from meshes.errors import InputError
from meshes.section.quantity import GRAVITY
from workflow.earthquake.accelerogram import read

VALUES = np.array([0.0, 0.012, -0.034, 0.05, -0.001, 0.002, 0.003])

AT2 = """PEER NGA STRONG MOTION DATABASE RECORD
 Somewhere 01/01/00, STATION, 090
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=      7, DT=   .0050 SEC,
   .0000000E+00   .1200000E-01  -.3400000E-01   .5000000E-01  -.1000000E-02
   .2000000E-02   .3000000E-02
"""
AT2_OLD = AT2.replace("NPTS=      7, DT=   .0050 SEC,", "    7     0.0050    NPTS, DT")

KNET = """Origin Time       1983/05/26 12:00:00
Lat.              40.360
Long.             139.078
Depth. (km)       14
Mag.              7.7
Station Code      AKT001
Station Lat.      40.2000
Station Long.     140.0333
Station Height(m) 10
Record Time       1983/05/26 12:00:15
Sampling Freq(Hz) 100Hz
Duration Time(s)  1
Dir.              N-S
Scale Factor      3920(gal)/6182761
Max. Acc. (gal)   0.634
Last Correction   1983/05/26 12:00:00
Memo.
     1000     2000     1000     1000
     1000        0     1000     1000
"""


def written(folder: Path, text: str, name: str = "record.txt") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("text", [AT2, AT2_OLD, AT2.replace("\n", "\r\n")])
def test_peer(text: str, tmp_path: Path) -> None:
    record = read(written(tmp_path, text))
    assert record.kind == "PEER"
    np.testing.assert_allclose(record.time, 0.005 * np.arange(7))
    np.testing.assert_allclose(record.acceleration, VALUES * GRAVITY, rtol=1e-12)
    assert record.peak == pytest.approx(0.05 * GRAVITY)


def test_knet_without_its_offset(tmp_path: Path) -> None:
    """Counts of 1000 but for one of 2000 and one of 0: the mean is the offset, 1000 counts are 0.634 gal."""
    record = read(written(tmp_path, KNET))
    assert record.kind == "K-NET"
    np.testing.assert_allclose(record.time, 0.01 * np.arange(8))
    expected = np.array([0, 1, 0, 0, 0, -1, 0, 0]) * 1000 * 3920 / 6182761 * 0.01
    np.testing.assert_allclose(record.acceleration, expected, atol=1e-15)
    assert record.peak / 0.01 == pytest.approx(0.634, abs=5e-4)  # as the heading says


@pytest.mark.parametrize(
    ("heading", "unit", "factor"),
    [
        ("time (s), acceleration (g)", "", GRAVITY),
        ("time [s];acceleration [m/s^2]", "", 1.0),
        ("t_s,a_m_s2", "", 1.0),
        ("time (s), acc (cm/s2)", "", 0.01),
        ("# made by hand\ntime, acceleration", "gal", 0.01),
        ("", "g", GRAVITY),
    ],
)
def test_two_columns(heading: str, unit: str, factor: float, tmp_path: Path) -> None:
    lines = [f"{0.02 * i:.2f}, {value}" for i, value in enumerate(VALUES)]
    record = read(written(tmp_path, "\n".join([heading, *lines])), unit)
    np.testing.assert_allclose(record.time, 0.02 * np.arange(7))
    np.testing.assert_allclose(record.acceleration, VALUES * factor, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is no accelerogram"),
        ("hello\nworld", "is no accelerogram"),
        ("0.0, 1.0\n0.1, 2.0\n", "the heading of the file names no unit"),
        ("t (s), a (g)\n0.0, 1.0\n0.1, x\n", "line 3: '0.1, x': expected two numbers"),
        ("t (s), a (g)\n0.1, 1.0\n0.0, 1.0\n", "the time falls from 0.1 s to 0 s"),
        ("t (s), a (g)\n0.1, 1.0\n0.2, nan\n", "not finite"),
        (
            AT2.replace("NPTS=      7", "NPTS=      8"),
            "is cut off: line 4 (NPTS) announces 8 values (acceleration in G)",
        ),
        (AT2.replace("NPTS=      7", "NPTS=      6"), "holds 7 values (acceleration in G), where line 4 (NPTS)"),
        (AT2.replace("DT=   .0050", "DT=   5"), "is it in milliseconds?"),
        (KNET.replace("Duration Time(s)  1", "Duration Time(s)  90"), "is cut off: it holds 0.08 s"),
        (AT2.replace(".3000000E-02", "***"), "line 6"),
        (KNET.replace("Sampling Freq(Hz) 100Hz", "Sampling"), "Sampling Freq"),
    ],
)
def test_files_that_are_none(text: str, words: str, tmp_path: Path) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read(path)
    assert words in str(caught.value)
    assert caught.value.source == str(path)


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such accelerogram"):
        read(tmp_path / "none.AT2")
