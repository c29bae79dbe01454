"""Describes the cases in which a stratum liquefies, given by their numbers or by borings and an earthquake, and the
strength that remains in these cases."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Self

from pydantic import PlainSerializer, PlainValidator

TRIGGERED = "triggered"
LIQUEFIES_IN = (
    f'the cases in which the stratum liquefies, such as [1, 2, 3], or "{TRIGGERED}" if the tests in borings and the '
    "earthquake decide whether it liquefies"
)


class Cases(tuple[int, ...]):
    """Holds the numbers of the cases in which a stratum liquefies.

    Parameters
    ----------
    numbers : numbers of cases, from 1
    triggered : whether borings and earthquake determine the cases; then the file contains the word "triggered" instead
        of numbers
    """

    triggered: bool

    def __new__(cls, numbers: Iterable[int] = (), triggered: bool = False) -> Self:
        cases = super().__new__(cls, numbers)
        cases.triggered = triggered
        return cases

    def __reduce__(self) -> tuple[type, tuple[tuple[int, ...], bool]]:
        return type(self), (tuple(self), self.triggered)

    @property
    def written(self) -> str | list[int]:
        """Return the cases as a file has them."""
        return TRIGGERED if self.triggered else list(self)


def read(value: Any) -> Cases:
    """Read the cases as written. Raises ValueError with the expected form."""
    if isinstance(value, Cases):
        return value
    if value == TRIGGERED:
        return Cases(triggered=True)
    if not isinstance(value, list | tuple):
        raise ValueError(f"expected {LIQUEFIES_IN}")
    wrong = [n for n in value if not isinstance(n, int) or isinstance(n, bool) or n < 1]
    if wrong:
        raise ValueError(
            f"{', '.join(map(repr, wrong))} among the cases: expected whole numbers from 1, {LIQUEFIES_IN}"
        )
    return Cases(value)


CaseNumbers = Annotated[Cases, PlainValidator(read), PlainSerializer(lambda cases: cases.written)]


@dataclass(frozen=True)
class RemainingStrength:
    """Holds the strength that a stratum retains once it has liquefied.

    Attributes
    ----------
    cohesion, friction : factors on the cohesion and on tan φ of the stratum
    residual : residual strength over the vertical effective stress to which the ground has consolidated before
    strength : residual strength (Pa)
    strain_potential : shear strain that the stratum undergoes before it regains strength, see
        `meshes.section.strain_potential`
    """

    cohesion: float
    friction: float
    residual: float
    strength: float = 0.0
    strain_potential: float = 0.0
