"""Random records written in every format come back; what a file does not say is asked for, what is odd is told."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.section.motion_units import motion_unit, time_unit
from tests.support import records
from tests.support.records import CM, GRAVITY, WRITERS, bhrc, columns, geonet, motion, read_text, refused
from workflow.earthquake.settings import ACCELERATION

STEPS = st.sampled_from([0.005, 0.01, 0.02])


@pytest.mark.parametrize("name", WRITERS)
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), count=st.integers(60, 400), step=STEPS)
def test_a_record_comes_back_from_every_format(name: str, seed: int, count: int, step: float) -> None:
    values = motion(seed, count, step)
    text = read_text(WRITERS[name](values, step))
    assert text.remarks == ()
    np.testing.assert_allclose(text.time, step * np.arange(count), rtol=1e-9, atol=1e-9)
    # K-NET's counts are 0.0006 gal, COSMOS's and CSMIP's columns 1e-5 cm/s² or g
    np.testing.assert_allclose(text.acceleration, values, atol=1.2e-4)


@pytest.mark.parametrize(("write", "names"), [(geonet, ["N28W", "S62W", "Up"]), (bhrc, ["L", "T", "V"])])
def test_one_of_the_components_of_a_national_network(write: Any, names: list[str]) -> None:
    """The three stand one behind the other; of GeoNet's with velocity and displacement between them."""
    values = dict(zip(names, records.three(5, 407, 0.02).values(), strict=True))
    scale = 1e3 if write is geonet else 1.0 / GRAVITY
    text = write({name: scale * entry for name, entry in values.items()}, 0.02)
    assert "holds 3 components" in refused(text)
    for name, item in values.items():
        np.testing.assert_allclose(read_text(text, component=name).acceleration, item, atol=1.2e-4)


def film(values: np.ndarray, step: float, channel: str) -> str:
    """A channel of volume 1 of CSMIP from film: 100 integers, 50 reals, then pairs of time and tenths of g."""
    rows = [
        *["%5d" * 16 % ((0,) * 16)] * 6,
        "%5d" * 4 % ((0,) * 4),
        *["%10.3f" * 8 % ((0.0,) * 8)] * 6,
        "%10.3f" * 2 % (0.0, 0.0),
    ]
    pairs = [f"{step * k:7.3f}{10.0 * value / GRAVITY:7.3f}" for k, value in enumerate(values)]
    rows += ["".join(pairs[k : k + 5]) for k in range(0, len(pairs), 5)]
    heading = ["UNCORRECTED ACCELEROGRAM DATA", "0911131", f"CHAN  1: {channel}     (STA CHN:  1)",
               f"NO. OF POINTS = {len(values):6d}  RECORD LENGTH = 28.260 SEC",
               "UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  =  0.132 G, AT  11.895 SEC",
               "RMS ACCEL OF COMPLETE RECORD = 0.021 G"]  # fmt: skip
    return "\n".join([*heading, *rows, ""])


def test_digitised_film_has_a_time_beside_each_acceleration() -> None:
    values = motion(7, 203, 0.005)
    text = film(values, 0.005, "L") + film(0.5 * values, 0.005, "T")
    assert '"1: L", "1: T"' in refused(text)
    result = read_text(text, component="T")
    np.testing.assert_allclose(result.time, 0.005 * np.arange(203), atol=1e-9)
    np.testing.assert_allclose(result.acceleration, 0.5 * values, atol=1e-3 * GRAVITY)


def test_a_heading_of_words_and_numbers_is_no_table() -> None:
    heading = "ANOTHER NETWORK\n0911131\n" + "its words\n" * 8 + "1 2 3\n1.7 1.7 1.7 1.7\n"
    assert "is of an unknown format" in refused(heading)


def test_samples_that_were_not_recorded_are_left_out() -> None:
    values = 1e3 * motion(3, 200, 0.01)
    text = read_text(geonet({"Up": np.r_[[999999.9] * 3, values, 999999.9]}, 0.01))
    assert len(text.time) == 200
    values[100] = 999999.9
    assert "samples are missing within the record" in refused(geonet({"Up": values}, 0.01))


def test_spectra_are_no_record() -> None:
    text = "Response and Fourier amplitude spectra (86 periods,  .04 - 10.0 sec)   for\nCorrected accelerogram\n"
    assert "holds spectra" in refused(text + "  .267E-03  .219E-01\n  .134E-01  .349E-01\n")


@pytest.mark.parametrize(
    "rows",
    ["1 2 3 4 5\n6 7 8 9 10\n11 12", "0.1 0.2 0.3\n0.2 0.1 0.3\n0.1 0.1 0.1", "1 2 3 4 5\nEND OF DATA"],
    ids=["shorter last row", "no times", "words at the end"],
)
def test_a_format_that_is_not_known_is_told_with_those_that_are_read(rows: str) -> None:
    none = refused("\n".join(f"Heading of a network nobody knows, line {k}" for k in range(12)) + "\n" + rows)
    assert "GeoNet V1 and V2, BHRC V1, COSMOS V1 and V2" in none
    assert len(none.splitlines()) == 1


@pytest.mark.parametrize("name", ["K-NET", "PEER in g", "COSMOS in cm/sec2", "ESM"])
def test_formats_are_named(name: str) -> None:
    assert read_text(WRITERS[name](motion(1, 200, 0.01), 0.01)).kind in name


UNITS = {
    "g": GRAVITY, "G": GRAVITY, "%g": GRAVITY / 100, "% g": GRAVITY / 100, "mg": GRAVITY / 1000, "gal": 0.01,
    "Gal": 0.01,
    "cm/s²": 0.01, "cm/s^2": 0.01, "cm/s2": 0.01, "cm/s/s": 0.01, "cm/sec^2": 0.01, "CM/SEC/SEC": 0.01, "cm/sec2": 0.01,
    "cm/s**2": 0.01, "cm s-2": 0.01, "cms^-2": 0.01, "gal(cm/s/s)": 0.01, "m/s²": 1.0, "m/s/s": 1.0, "m/(s^2)": 1.0,
    "mm/s^2": 0.001, "in/s^2": 0.0254, "ft/sec2": 0.3048,
}  # fmt: skip


@given(
    unit=st.sampled_from(sorted(UNITS)), apart=st.sampled_from([",", ";", "\t"]), seed=st.integers(0, 10**6), step=STEPS
)
@settings(deadline=None)
def test_every_spelling_of_a_unit(unit: str, apart: str, seed: int, step: float) -> None:
    values = motion(seed, 100, step)
    time = step * np.arange(100)
    text = columns(time, values / UNITS[unit], f"time (s){apart}acc [{unit}]", apart)
    np.testing.assert_allclose(read_text(text).acceleration, values, atol=1e-6)
    bare = columns(time, values / UNITS[unit], f"time (s){apart}acc", apart)
    np.testing.assert_allclose(read_text(bare, unit=unit).acceleration, values, atol=1e-6)
    assert ACCELERATION.read(f"{0.2 / UNITS[unit]:.9f} {unit}") == pytest.approx(0.2, rel=1e-5)


def test_units_of_other_quantities_are_known_as_such() -> None:
    assert {motion_unit(word).motion for word in ("cm/s", "m/sec", "kine", "cm s-1")} == {"velocity"}  # type: ignore[union-attr]
    assert {motion_unit(word).motion for word in ("cm", "mm", "in", "m")} == {"displacement"}  # type: ignore[union-attr]
    assert [motion_unit(word) for word in ("counts", "V", "ms", "gal(m/s/s)", "")] == [None] * 5
    assert [time_unit(word) for word in ("s", "SEC", "ms", "msec", "h")] == [1.0, 1.0, 1e-3, 1e-3, None]
    for written, item in (
        ("25 cm/s", "unit of velocity"), ("25 parsec", "not understood as a unit"), ("25", "has no unit"),
        ("60 m/s^2", "out of range"), ("a lot", "not understood as a number"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=item):
            ACCELERATION.read(written)


@pytest.mark.parametrize("step", [0.005, 0.01])
def test_velocity_and_displacement_are_differentiated_and_told(step: float) -> None:
    """A pulse of 2 Hz with its velocity and displacement in closed form, as .VT2, .DT2, ESM and columns have them."""
    time = step * np.arange(int(8.0 / step))
    omega, s = 4.0 * np.pi, time - 4.0
    bell = np.exp(-(s**2))
    shift = 0.02 * bell * np.sin(omega * s)  # m
    speed = 0.02 * bell * (omega * np.cos(omega * s) - 2.0 * s * np.sin(omega * s))
    felt = 0.02 * bell * ((4.0 * s**2 - 2.0 - omega**2) * np.sin(omega * s) - 4.0 * omega * s * np.cos(omega * s))
    for text, word in (
        (records.peer(CM * speed, step, "CM/S", "VELOCITY"), "velocity"),
        (records.peer(CM * shift, step, "CM", "DISPLACEMENT"), "displacement"),
        (records.esm(CM * speed, step, "cm/s", "VELOCITY"), "velocity"),
        (columns(time, CM * speed, "time (s),v (cm/s)"), "velocity"),
    ):
        result = read_text(text)
        assert f"holds {word}" in result.remarks[0]
        np.testing.assert_allclose(result.acceleration, felt, atol=0.01 * np.abs(felt).max())


def test_a_velocity_file_is_no_acceleration() -> None:
    """20.7 cm/s taken for g was 20,670 gal."""
    time = 0.01 * np.arange(2000)
    speed = 20.67 * np.exp(-(((time - 8.0) / 3.0) ** 2)) * np.sin(2.0 * np.pi * time)
    assert 1.0 < read_text(records.peer(speed, 0.01, "CM/S", "VELOCITY")).peak < 1.5
    none = refused(records.peer(speed, 0.01, "G", "VELOCITY"))
    assert "says that the values are velocity, but their unit, G, is one of acceleration" in none
    assert 'g with the unit "G"; no recorded ground motion' in refused(records.peer(speed, 0.01, "G"))
    assert "are velocity, but their unit, g, is one of acceleration" in refused(
        columns(time, speed, "time (s),velocity (g)")
    )


def test_exponents_as_fortran_writes_them() -> None:
    values = motion(3, 100, 0.01)
    rows = "\n".join(f"{0.01 * k:.8E}  {v:.8E}" for k, v in enumerate(values)).replace("E", "D")
    np.testing.assert_allclose(read_text(f"time (s)  a (m/s^2)\n{rows}\n").acceleration, values, atol=1e-7)


def test_acceleration_is_taken_before_what_follows_from_it() -> None:
    values = motion(3, 300, 0.01)
    time = 0.01 * np.arange(300)
    rows = "\n".join(f"{t:.3f},{v:.6f},{0.1 * v:.6f}" for t, v in zip(time, values, strict=True))
    text = read_text(f"time (s),velocity (cm/s),acc (g)\n{rows}\n")
    np.testing.assert_allclose(text.acceleration, GRAVITY * 0.1 * values, atol=1e-5)


def test_one_of_several_components_is_asked_for() -> None:
    three = records.three(5, 200, 0.01)
    text = records.jma({name: CM * values for name, values in three.items()}, 0.01)
    assert 'holds 3 components, "NS", "EW", "UD": expected component = one of them' in refused(text)
    for number, name in enumerate(three, start=1):
        for way in (name, name.lower(), str(number)):
            np.testing.assert_allclose(read_text(text, component=way).acceleration, three[name], atol=1e-6)
    assert 'component = "Z": the file holds the components "NS", "EW", "UD"' in refused(text, component="Z")
    timed = "\n".join(
        f"{0.01 * k:.2f};{a:.6f};{b:.6f}" for k, (a, b) in enumerate(zip(three["NS"], three["EW"], strict=True))
    )
    read_text(f"Zeit [s];N-S [m/s²];E-W [m/s²]\n{timed}\n", component="EW")
    channels = records.cosmos(
        CM * three["NS"], 0.01, "cm/sec2", records.cosmos(CM * three["EW"], 0.01, "cm/sec2", "", "70 deg")
    )
    np.testing.assert_allclose(read_text(channels, component="70 deg").acceleration, three["EW"], atol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,a\n0.00,0.1\n0.01,0.2\n0.02,-0.3\n", "the heading of the file names no unit"),
        ("t (s),a (counts)\n0.00,0.1\n0.01,0.2\n", "the heading of the file names no unit"),
        ("units: furlongs\nt (s),a\n0.00,0.1\n0.01,0.2\n", 'gives the unit "furlongs", which is not understood'),
        ("acc (g)\n0.1\n0.2\n-0.3\n", "expected a column of time before it"),
        (records.peer(np.ones(8), 0.01, "G").replace("SEC,", "DAYS,"), '"DAYS" is no unit of time'),
        (records.peer(np.ones(8), -0.01, "G"), "the time step is -0.01 s"),
        (records.peer(np.ones(8), 0.01, "VOLT"), 'the unit "VOLT", which is not understood'),
        (records.peer(np.ones(8), 0.01, "G").replace("IN UNITS OF G", ""), "names no unit"),
        (records.esm(np.ones(8), 0.01, "cm/s^2").replace("NDATA: 8", "NDATA: 9"), "its NDATA announces 9 values"),
        (records.esm(np.ones(8), 0.01, "").replace("UNITS: ", "UNITS:"), "has no UNITS"),
        (records.cosmos(np.ones(8), 0.01, "counts"), 'the unit "counts", which is not understood'),
        (records.cosmos(np.ones(8), -999.0, "g"), "real value 34 of its heading"),
        (records.cosmos(np.ones(8), 0.01, "g").replace("       8  acc", "       9  acc"), "the heading says 9"),
        (records.knet(np.ones(8), 0.01).replace("Scale Factor      3920", "Scale Factor "), "has no \"Scale Factor\""),
    ],
)  # fmt: skip
def test_what_is_missing_is_asked_for(text: str, message: str) -> None:
    assert message in refused(text)


def test_the_unit_given_must_be_that_of_the_heading() -> None:
    text = WRITERS["PEER in g"](motion(2, 100, 0.01), 0.01)
    assert read_text(text, unit="g").peak == read_text(text).peak
    assert 'unit = "gal": the heading of the file says "G"' in refused(text, unit="gal")


def test_milliseconds_are_read_and_asked_for() -> None:
    """10 ms taken for 10 s: under a heading they are milliseconds, without one the file is refused."""
    values = motion(7, 200, 0.01)
    time = 10.0 * np.arange(200)
    assert np.diff(read_text(columns(time, values, "time (ms),acc (m/s^2)")).time) == pytest.approx(0.01)
    assert "are 10 s apart" in refused(columns(time, values, "time,acc (m/s^2)"))
    assert "the heading gives the time" not in refused(columns(time, values, "t (h),acc (m/s^2)"))
    [remark] = read_text(columns(0.25 * np.arange(200), values, "time (s),acc (m/s^2)")).remarks
    assert remark == "the time steps of the record are up to 0.25 s long; expected up to 0.1 s; check their unit"


@given(seed=st.integers(0, 10**6), offset=st.floats(0.011, 0.2), sign=st.sampled_from([-1.0, 1.0]))
@settings(deadline=None)
def test_an_offset_is_taken_off_and_told(seed: int, offset: float, sign: float) -> None:
    """A record with quiet ends that is shifted by a share of its peak."""
    values = np.concatenate([np.zeros(150), motion(seed, 300, 0.01), np.zeros(150)])
    shifted = values + sign * offset * np.abs(values).max()
    text = read_text(WRITERS["PEER in g"](shifted, 0.01))
    if abs(shifted.mean()) > 0.0105 * np.abs(shifted).max():
        assert len(text.remarks) == 1
        assert "the mean of the record" in text.remarks[0]
    if "subtracted as an offset" in "".join(text.remarks):
        assert np.abs(text.acceleration - values).max() < 0.01 * np.abs(values).max()


def test_a_pulse_keeps_its_mean_and_says_so() -> None:
    """Half a sine at 5 s of 40 s: the ground does not end at rest, but the record is not shifted."""
    time = 0.01 * np.arange(4000)
    pulse = np.where((time > 5.0) & (time < 7.0), np.sin(0.5 * np.pi * (time - 5.0)), 0.0)
    text = read_text(columns(time, pulse, "time (s),a (m/s^2)"))
    np.testing.assert_allclose(text.acceleration, pulse, atol=1e-7)
    assert "is not at rest at the end; the record is not corrected" in text.remarks[0]


@pytest.mark.parametrize(("written", "point"), [("0,25 g", "0.25 g"), ("245,2 gal", "245.2 gal")])
def test_an_acceleration_with_a_decimal_comma_is_told(written: str, point: str) -> None:
    with pytest.raises(ValueError, match=f'has a decimal comma; write "{point}"'):
        ACCELERATION.read(written)


def test_peaks_are_doubted() -> None:
    values = motion(4, 300, 0.01)
    values /= np.abs(values).max()
    time = 0.01 * np.arange(300)
    strong = read_text(columns(time, 3.5 * values, "time (s),a (g)"))
    assert strong.remarks == ("the peak of the record is 3.5 g, above 3 g; check its unit",)
    assert "the peak of the record is 40 g" in refused(columns(time, 40.0 * values, "time (s),a (g)"))
    faint = read_text(columns(time, 0.3 * values, "time (s),a (gal)"))
    assert "the peak of the record is 0.3 gal, below 0.98 gal" in faint.remarks[0]
    assert (
        "multiplied by 20, the peak of the record is 4 g"
        in read_text(columns(time, 0.2 * values, "t (s),a (g)")).scaled(20.0).remarks[0]
    )
    wrong = records.knet(100.0 * values, 0.01).replace("Max. Acc. (gal)   ", "Max. Acc. (gal)   9")
    assert "where its heading says 9" in read_text(wrong).remarks[0]
