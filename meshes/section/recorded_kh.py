"""Writes seismic coefficients, at which a computation stores its state, in names of files and pictures."""

from typing import Annotated

from pydantic import AfterValidator, Field

DECIMALS = 3  # of a seismic coefficient in the name of a file


def in_name(kh: float) -> str:
    """Return a seismic coefficient in the form used in file names.

    Parameters
    ----------
    kh : seismic coefficient (-)

    Returns
    -------
    Text of two or three decimals: 0.20, 0.255.
    """
    return f"{kh:.{DECIMALS}f}".removesuffix("0")


def _each_once(values: tuple[float, ...]) -> tuple[float, ...]:
    if len({in_name(value) for value in values}) < len(values):
        raise ValueError(
            f"{list(values)}: expected every seismic coefficient once; two that are equal to {DECIMALS} decimals "
            "would have the same picture"
        )
    return values


LARGEST_KH = 5.0  # seismic coefficient; a larger number is a percentage or an acceleration
RecordedKh = Annotated[tuple[Annotated[float, Field(ge=0.0, le=LARGEST_KH)], ...], AfterValidator(_each_once)]
