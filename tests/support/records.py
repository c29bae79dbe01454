"""Makes random records, and files of every format in the style of the networks."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from meshes.errors import InputError
from workflow.earthquake.accelerogram import Accelerogram, read

GRAVITY = 9.80665


def read_text(text: str, name: str = "record.txt", **how: str) -> Accelerogram:
    """Return the record in a file of this text."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_text(text, encoding="utf-8")
        return read(path, **how)


def refused(text: str, **how: str) -> str:
    """Return the reason why a file of this text is no record."""
    with pytest.raises(InputError) as caught:
        read_text(text, **how)
    return "\n".join(caught.value.problems)


def motion(seed: int, count: int, step: float) -> np.ndarray:
    """Return a record (n,) in m/s² that grows and decays, of up to a few m/s², with a mean of 0."""
    generator = np.random.default_rng(seed)
    time = step * np.arange(count)
    rates = generator.uniform(0.3, min(8.0, 0.15 / step), 12)
    sines = np.sin(2.0 * np.pi * rates * time[:, None] + generator.uniform(0.0, 6.28, 12)) @ generator.normal(size=12)
    values = sines * np.exp(-(((time - 0.4 * time[-1]) / (0.25 * time[-1])) ** 2))
    values *= generator.uniform(0.3, 5.0) / np.abs(values).max()
    values[[0, -1]] = 0.0
    values[1:-1] -= values[1:-1].mean()
    return values


def peer(values: np.ndarray, step: float, unit: str, quantity: str = "ACCELERATION") -> str:
    rows = ["".join(f"{v:15.7E}" for v in values[k : k + 5]) for k in range(0, len(values), 5)]
    heading = "PEER NGA STRONG MOTION DATABASE RECORD\nSomewhere, 1/1/1999, Station, 090\n"
    return (
        f"{heading}{quantity} TIME SERIES IN UNITS OF {unit}\nNPTS={len(values):7d}, DT= {step:.5f} SEC,\n"
        + "\n".join(rows)
        + "\n"
    )


def peer_old(values: np.ndarray, step: float, unit: str) -> str:
    rows = ["".join(f"{v:15.7E}" for v in values[k : k + 5]) for k in range(0, len(values), 5)]
    heading = "PACIFIC ENGINEERING AND ANALYSIS STRONG-MOTION DATA\nSOMEWHERE 01/01/79\n"
    heading += f"ACCELERATION TIME HISTORY IN UNITS OF {unit}."
    return (
        f"{heading} FILTER POINTS: HP=0.1 Hz LP=40.0 Hz\n{len(values):6d} {step:.5f} NPTS, DT\n"
        + "\n".join(rows)
        + "\n"
    )


def knet(gal: np.ndarray, step: float, apart: str = "") -> str:
    """Return counts with an offset, 8 in a row; with ``apart`` = "," as saved by a spreadsheet."""
    counts = np.round(gal * 6182761.0 / 3920.0).astype(int) + 14000
    peak = np.abs(counts - counts.mean()).max() * 3920.0 / 6182761.0
    keys = {
        "Origin Time": "2011/03/11 14:46:00", "Lat.": "38.103", "Long.": "142.860", "Depth. (km)": "24", "Mag.": "9.0",
        "Station Code": "MYG004", "Station Lat.": "38.7292", "Station Long.": "141.0217", "Station Height(m)": "40",
        "Record Time": "2011/03/11 14:46:30", "Sampling Freq(Hz)": f"{1.0 / step:.0f}Hz",
        "Duration Time(s)": f"{len(gal) * step:.0f}",
        "Dir.": "E-W", "Scale Factor": "3920(gal)/6182761", "Max. Acc. (gal)": f"{peak:.3f}",
        "Last Correction": "2011/03/11 14:46:30", "Memo.": "",
    }  # fmt: skip
    heading = [f"{key}{apart}{value}" if apart else f"{key:<18}{value}" for key, value in keys.items()]
    rows = [(apart or " ").join(f"{c:8d}" for c in counts[k : k + 8]) for k in range(0, len(counts), 8)]
    return "\n".join([*heading, *rows]) + "\n"


def cosmos(values: np.ndarray, step: float, unit: str, more: str = "", channel: str = "340 deg") -> str:
    """Return one block of V1 or V2 in columns of ten, in which numbers may touch; ``more`` is a second block."""
    reals = np.full(100, -999.0)
    reals[33], reals[63] = step, float(values[np.argmax(np.abs(values))])
    integers = ["".join(f"{-999:8d}" for _ in range(10)) for _ in range(10)]
    texts = [
        "Corrected acceleration    (Format v01.20 with 13 text lines) Src: test",
        "Somewhere in California",
        "Hypocenter: 34.0580  -117.0110  H= 12km(SCSN) ML=4.9", "Origin: 06/16/2005, 20:53:26.1 UTC",
        "Statn No: 01-23075",
        "Coords: 34.0460 -117.0350", "Recorder: SSA-2  s/n 1238 ( 1 Chns of  3  at Sta)", "Rcrd start time:06/16/2005",
        f"Sta Chan  1: {channel} (Rcrdr Chan  1) Location: ground", "Raw record length", "Processed: 06/17/2005",
        "Record filtered below 0.30  Hz", "Values used when parameter or data value is unknown/unspecified:   -999",
    ]  # fmt: skip
    rows = ["".join(f"{v:13.6f}" for v in reals[k : k + 6]) for k in range(0, 100, 6)]
    data = ["".join(f"{v:10.5f}" for v in values[k : k + 8]) for k in range(0, len(values), 8)]
    return "\n".join([
        *texts, " 100 Integer-header values follow on  10 lines, Format= (10I8)", *integers,
        " 100 Real-header values follow on  17 lines, Format= (6F13.6)", *rows,
        '  1 Comment line(s) follow, each starting with a "|":', " | 17 of these lines are no data",
        f"{len(values):8d}  acceleration pts, approx 70 secs, units={unit}(04),Format=(8F10.5)",
        *data, "End-of-data for Chan  1 acceleration", more,
    ]) + "\n"  # fmt: skip


def csmip_v2(values: np.ndarray, step: float, unit: str) -> str:
    """Return acceleration, then velocity and displacement (here zeros), in the form of CSMIP's Volume 2."""

    def block(of: np.ndarray, word: str, scale: str) -> list[str]:
        rows = ["".join(f"{v:10.5f}" for v in of[k : k + 8]) for k in range(0, len(of), 8)]
        return [
            f"{len(of):6d} points of {word} data equally spaced at  {step:.4f} sec, in {scale}. (8f10.5)    ",
            *rows,
        ]

    heading = ["Corrected accelerogram   89146-L2500       Chan  1: 360 Deg     from   ", "Willow Creek"]
    zeros = np.zeros_like(values)
    numbers = ["    1  100    1    3    3  200    1    3"]
    return "\n".join([*heading, *numbers, *block(values, "accel", unit), *block(zeros, "veloc", "cm/sec"),
                      *block(zeros, "displ", "cm"), "/&  ----  end of data for channel  1  ----"])  # fmt: skip


def csmip_v1(values: np.ndarray, step: float, unit: str) -> str:
    rows = ["".join(f"{v:9.6f}" for v in values[k : k + 8]) for k in range(0, len(values), 8)]
    first = (
        f"{len(values):6d} Accelerogram points at {1.0 / step:.0f} pts/sec in units of {unit} .      Format: (8f9.6)  "
    )
    return "\n".join(["Uncorrected Accelerogram Data   CGS", "Chan  1: 360 Deg", first, *rows]) + "\n"


def esm(values: np.ndarray, step: float, unit: str, quantity: str = "ACCELERATION") -> str:
    peak = values[np.argmax(np.abs(values))]
    keys = {
        "EVENT_NAME": "GREECE", "EVENT_TIME_HHMMSS": "160908", "MAGNITUDE_W": "", "STATION_CODE": "DLFA",
        "VS30_M/S": "",
        "SAMPLING_INTERVAL_S": f"{step:.6f}", "NDATA": str(len(values)), "STREAM": "HNE", "UNITS": unit,
        f"PG{quantity[0]}_CM/S^2": f"{peak:.6f}", "LATE/NORMAL_TRIGGERED": "NT", "DATABASE_VERSION": "DYNA 1.0",
        "HEADER_FORMAT": "DYNA 1.2", "DATA_TYPE": quantity, "USER5": "",
    }  # fmt: skip
    return "\n".join([*(f"{key}: {text}" for key, text in keys.items()), *(f"{v:.6f}" for v in values)]) + "\n"


def jma(gal: dict[str, np.ndarray], step: float) -> str:
    """Return the CSV files of the Japan Meteorological Agency: components without times."""
    heading = ["SITE CODE= ABC,37.5,137.2,16,7.6", " LAT.= 37.0", " LON.= 137.0", f" SAMPLING RATE= {1.0 / step:.0f}Hz",
               " UNIT  = gal(cm/s/s)", "INITIAL TIME = 2024 01 01 16 10 00", ",".join(gal)]  # fmt: skip
    rows = [",".join(f"{v:.5f}" for v in row) + "," for row in zip(*gal.values(), strict=True)]
    return "\r\n".join([*(f"{line},,," for line in heading[:-1]), heading[-1], *rows]) + "\r\n"


def columns(time: np.ndarray, values: np.ndarray, heading: str, apart: str = ",", decimal: str = ".") -> str:
    rows = [f"{t:.6f}{apart}{v:.8f}".replace(".", decimal) for t, v in zip(time, values, strict=True)]
    return "\n".join([heading, *rows]) + "\n"


Writer = Callable[[np.ndarray, float], str]
CM = 100.0  # gal in m/s²


# Of a record in m/s²; what the columns of each format leave of it is a hundred-thousandth of a gal, or of its peak.
def geonet(components: dict[str, np.ndarray], step: float, raw: bool = False) -> str:
    """Return values in mm/s²; in corrected records velocity and displacement follow, which are not read."""
    blocks = []
    for name, values in components.items():
        count, peak = len(values), float(max(values[values < 9e5], key=abs))
        others = 0 if raw else count
        text = [f"{'Unc' if raw else 'C'}orrected accelerogram 20161113_110256_WTMC_20 GNS Science"]
        text += ["Site WTMC      42 37 10S  173 03 13E", *["Somewhere"] * 10, f"Component {name}  Longitudinal Axis"]
        text += [f"Acceleration:  peak {peak:.1f} mm/s/s", "Velocity:", "Displacement:"]
        heading = [[0.0] * 10 for _ in range(10)]
        heading[3][3:6] = [count, others, others]
        heading[4][:2], heading[4][7] = [200.0, 0.7], 1.0
        heading[6][4:6], heading[6][9] = [0.005, step], 9806.6
        heading[7][0] = peak if raw else 1.13 * peak
        heading[7][5] = 0.0 if raw else peak
        rows = ["".join(f"{v:8.0f}" for v in row) for row in heading[:4]]
        rows += ["".join(f"{v:8.5g}" if k == 6 else f"{v:8.1f}" for v in row) for k, row in enumerate(heading[4:], 4)]
        data = [values, *([] if raw else [0.1 * values, 0.01 * values])]
        rows += ["".join(f"{v:8.1f}" for v in item[k : k + 10]) for item in data for k in range(0, count, 10)]
        blocks += text + rows
    return "\n".join(blocks) + "\n"


def bhrc(components: dict[str, np.ndarray], step: float) -> str:
    """Return values in g."""
    blocks = []
    for name, values in components.items():
        blocks += ["* VOL1DS FILE:  5523/01", "Inst Type = SSA-2", "Origin Time : 2012/08/11   12:23:16", "", name, " "]
        blocks += [
            f"COMP {name}1",
            "Amand   Station   38.231 N 46.156 E   Altitude 1495m   Azimuth L 177   T 267",
            "",
            "",
        ]
        blocks += [f"NO. OF POINTS = {len(values):6d}      DURATION = {len(values) * step:8.4f}"]
        blocks += ["UNITS ARE SECONDS AND G/10", " ", *["    0" * 14] * 7, *["  .000000E+00" * 5] * 7]
        blocks += ["".join(f"{10.0 * v:13.6E}" for v in values[k : k + 10]) for k in range(0, len(values), 10)]
        blocks += ["/&"]
    return "\n".join(blocks) + "\n"


WRITERS: dict[str, Writer] = {
    "PEER in g": lambda a, dt: peer(a / GRAVITY, dt, "G"),
    "PEER in CM/SEC/SEC": lambda a, dt: peer(CM * a, dt, "CM/SEC/SEC"),
    "PEER in m/s2": lambda a, dt: peer(a, dt, "M/S2"),
    "PEER of old": lambda a, dt: peer_old(a / GRAVITY, dt, "G"),
    "K-NET": lambda a, dt: knet(CM * a, dt),
    "K-NET as CSV": lambda a, dt: knet(CM * a, dt, ","),
    "COSMOS in cm/sec2": lambda a, dt: cosmos(CM * a, dt, "cm/sec2"),
    "COSMOS in g": lambda a, dt: cosmos(a / GRAVITY, dt, "g"),
    "CSMIP V1": lambda a, dt: csmip_v1(a / GRAVITY, dt, "g"),
    "CSMIP V2": lambda a, dt: csmip_v2(CM * a, dt, "cm/sec2"),
    "ESM": lambda a, dt: esm(CM * a, dt, "cm/s^2"),
    "GeoNet V1": lambda a, dt: geonet({"N28W": 1e3 * a}, dt, raw=True),
    "GeoNet V2": lambda a, dt: geonet({"N28W": 1e3 * a}, dt),
    "BHRC": lambda a, dt: bhrc({"L": a / GRAVITY}, dt),
    "JMA": lambda a, dt: jma({"NS": CM * a}, dt),
    "semicolons": lambda a, dt: columns(dt * np.arange(len(a)), a, "t [s];a [m/s²]", ";"),
    "decimal commas": lambda a, dt: columns(dt * np.arange(len(a)), a, "t [s];a [m/s²]", ";", ","),
    "tabs, milliseconds": lambda a, dt: columns(1e3 * dt * np.arange(len(a)), a / GRAVITY, "time (ms)\tacc (g)", "\t"),
    "blanks": lambda a, dt: columns(dt * np.arange(len(a)), CM * a, "Time(s) Acc(cm/s^2)", " "),
    "units below names": lambda a, dt: columns(dt * np.arange(len(a)), CM * a, "t,a\ns,gal"),
    "one column": lambda a, dt: f"# dt = {dt:.5f} s, units: g\n" + "\n".join(f"{v:.9f}" for v in a / GRAVITY),
}  # fmt: skip


def three(seed: int, count: int, step: float) -> dict[str, Any]:
    return {name: motion(seed + k, count, step) for k, name in enumerate(("NS", "EW", "UD"))}
