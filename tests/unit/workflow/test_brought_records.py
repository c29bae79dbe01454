"""Records as practitioners bring them come back as the plain table does; what cannot be read is called by its name."""

import numpy as np
import pytest

from tests.support.records import CM, GRAVITY, motion, read_text, refused

COUNT, STEP = 400, 0.01
VALUES = motion(3, COUNT, STEP)
TIME = STEP * np.arange(COUNT)


def rows(form: str, *columns: np.ndarray) -> str:
    return "\n".join(form % row for row in zip(*columns, strict=True)) + "\n"


def smc(values: np.ndarray, first: str) -> str:
    """An SMC file: 11 lines of text, 48 integers, 50 reals, a comment, values of 10 characters that may touch."""
    integers = np.zeros(48, dtype=int)
    integers[[15, 16]] = 1, len(values)
    reals = np.full(50, 1.7e38)
    reals[1] = 1.0 / STEP
    text = "\n".join([first, *("*" for _ in range(10))]) + "\n"
    for numbers, form, width in ((integers, "%10d", 8), (reals, "%15.7E", 5)):
        lines = ["".join(form % n for n in numbers[k : k + width]) for k in range(0, len(numbers), width)]
        text += "\n".join(lines) + "\n"
    cells = [f"{value:10.3f}" for value in values]
    return text + "| a comment\n" + "\n".join("".join(cells[k : k + 8]) for k in range(0, len(cells), 8)) + "\n"


GAL = CM * VALUES
TEXTS = {
    "decimal commas between blanks": "Zeit (s) Beschl. (m/s²)\n" + rows("%.2f  %.6f", TIME, VALUES).replace(".", ","),
    "units in words": "Time in seconds, Acceleration in m/s2\n" + rows("%.2f,%.6f", TIME, VALUES),
    "units behind a comma": "Time, s; Acc, m/s2\n" + rows("%.2f;%.6f", TIME, VALUES),
    "units in a row of their own": "Time\tAcc\n[s]\t[m/s²]\n" + rows("%.2f\t%.6f", TIME, VALUES),
    "a column that counts": "No,time (s),acc (m/s2)\n" + rows("%d,%.2f,%.6f", np.arange(COUNT), TIME, VALUES),
    "time behind": "acc (m/s2),time (s)\n" + rows("%.6f,%.2f", VALUES, TIME),
    "quotation marks": '"time (s)","acc (m/s2)"\n' + rows('"%.2f","%.6f"', TIME, VALUES),
    "eight in a row": "dt = 0.01 s\nacceleration (m/s2)\n" + "\n".join(
        "".join(f"{value:9.6f}" for value in VALUES[k : k + 8]) for k in range(0, COUNT, 8)
    ),
    "a unit in the words before one column": "dt = 0.01 s, acceleration in m/s2\n" + rows("%.6f", VALUES),
    "SMC": smc(GAL, "2 CORRECTED ACCELEROGRAM"),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_a_record_comes_back(name: str) -> None:
    text = read_text(TEXTS[name])
    assert text.remarks == ()
    np.testing.assert_allclose(text.time, TIME, atol=1e-9)
    np.testing.assert_allclose(text.acceleration, VALUES, atol=1e-5)


def test_clock_times_are_counted_from_the_first_one() -> None:
    text = "Timestamp,acc (m/s2)\n" + rows("2011-03-11 14:46:%05.2f,%.6f", TIME, VALUES)
    result = read_text(text)
    np.testing.assert_allclose(result.time, TIME, atol=1e-6)
    assert result.remarks == ("the times of the record begin at 53160 s, and are counted from there",)


def test_number_and_step_of_deepsoil_are_no_sample() -> None:
    text = f"{COUNT} {STEP}\n" + rows("%.2f %.7f", TIME, VALUES / GRAVITY)
    np.testing.assert_allclose(read_text(text, unit="g").acceleration, VALUES, atol=1e-5)


def test_the_components_have_the_names_above_their_units() -> None:
    text = "Time\tNS\tEW\n[s]\t[m/s²]\t[m/s²]\n" + rows("%.2f\t%.6f\t%.6f", TIME, VALUES, 0.5 * VALUES)
    assert 'holds 2 components, "NS", "EW"' in refused(text)
    np.testing.assert_allclose(read_text(text, component="EW").acceleration, 0.5 * VALUES, atol=1e-5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("No,acc (gal)\n" + rows("%d,%.4f", np.arange(COUNT), VALUES), 'the first column, "No", is no time'),
        ("time (s),acc (g)\n" + rows("%.1f,%.6f", TIME, VALUES), "times are equal to the time before, such as 0"),
        ("time (s),acc (g)\n" + rows("%.2f,%.1f", TIME, 0.0 * VALUES), "holds only zeros"),
        ("time (s),acc (g)\n0.00,0.1\n0.01,NaN\n", "line 3: '0.01,NaN': a value is missing or not finite"),
        ("400 0.01 (8F9.6)\n" + "0.1 0.2 0.1 0.3 0.4 0.1 0.2 0.2\n-0.1 0.2 0.1 0.3 0.4 0.1 0.2 0.2\n",
         "holds rows of 8 numbers whose first column is no time; expected a time step"),
        ("\0\0\x01binary", "is a binary file"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_has_its_reason(text: str, message: str) -> None:
    assert message in refused(text)
