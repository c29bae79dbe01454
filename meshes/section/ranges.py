"""What numbers of soils, water, loads and tests can be, and what is told of one that cannot."""

from typing import NamedTuple


class Range(NamedTuple):
    """What a quantity can be, in its unit, of which one has ``si`` in SI units; ``slips`` are wrong factors.

    With ``or_none`` it can be 0, too, below its range.
    """

    low: float
    high: float
    unit: str
    si: float
    slips: tuple[tuple[float, str], ...]
    or_none: bool = False


def within(value: float, limits: Range) -> bool:
    """Whether a number in SI units lies in the range, to rounding."""
    none = limits.or_none and value == 0.0
    return none or limits.low * (1.0 - 1e-9) <= value / limits.si <= limits.high * (1.0 + 1e-9)


UNUSUAL = ", or unusual = true at the head of the file if it is meant"


def sentence(key: str, value: float, limits: Range, remedy: str = UNUSUAL) -> str:
    """What is told of a number that does not: the key, what was written, what was meant, what was expected.

    The ``remedy`` says what to do where it is meant.
    """
    written = getattr(value, "written", value)
    shown = f'"{written}"' if isinstance(written, str) else f"{written:g}"
    unit = f" {limits.unit}" if limits.unit else ""
    number = str(written).split()[0]
    meant = next((unit for factor, unit in limits.slips if within(factor * value, limits)), None)
    hint = f' (did you mean "{number} {meant}"?)' if meant and f"{number} {meant}" != written else ""
    expected = f"{'0, or ' if limits.or_none else ''}{limits.low:g} to {limits.high:g}{unit}"
    return f"{key} = {shown}: {value / limits.si:.6g}{unit} is beyond what there is{hint}; expected {expected}{remedy}"
