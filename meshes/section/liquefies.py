"""The cases that a stratum liquefies in, given by their numbers or left to blow counts and an earthquake, and what it
keeps of its strength in them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Self

from pydantic import PlainSerializer, PlainValidator

TRIGGERED = "triggered"
LIQUEFIES_IN = f'the cases it liquefies in, such as [1, 2, 3], or "{TRIGGERED}": what the blow counts say'


class Cases(tuple[int, ...]):
    """Numbers of cases. Where ``triggered`` the blow counts find them, and a file says so instead of the numbers."""

    triggered: bool

    def __new__(cls, numbers: Iterable[int] = (), triggered: bool = False) -> Self:
        cases = super().__new__(cls, numbers)
        cases.triggered = triggered
        return cases

    def __reduce__(self) -> tuple[type, tuple[tuple[int, ...], bool]]:
        return type(self), (tuple(self), self.triggered)

    @property
    def written(self) -> str | list[int]:
        """As a file has them."""
        return TRIGGERED if self.triggered else list(self)


def read(value: Any) -> Cases:
    """The cases as they were written; raises ValueError that says what was expected."""
    if isinstance(value, Cases):
        return value
    if value == TRIGGERED:
        return Cases(triggered=True)
    if not isinstance(value, list | tuple):
        raise ValueError(f"expected {LIQUEFIES_IN}")
    wrong = [n for n in value if not isinstance(n, int) or isinstance(n, bool) or n < 1]
    if wrong:
        raise ValueError(f"{wrong[0]!r} in it: expected whole numbers from 1, {LIQUEFIES_IN}")
    return Cases(value)


CaseNumbers = Annotated[Cases, PlainValidator(read), PlainSerializer(lambda cases: cases.written)]


@dataclass(frozen=True)
class Remains:
    """What a stratum keeps once it has liquefied.

    Attributes
    ----------
    cohesion, friction : float
        Factors on its cohesion and on tan φ.
    residual : float
        A strength over the vertical effective stress to which the ground has consolidated before.
    strength : float
        A strength in Pa.
    strain_potential : float
        Shear strain that it goes through before it holds, see `meshes.section.strain_potential`.
    """

    cohesion: float
    friction: float
    residual: float
    strength: float = 0.0
    strain_potential: float = 0.0
