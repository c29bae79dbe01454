"""Defines distributions of one number, each given by its quantile function."""

import math
from collections.abc import Mapping
from statistics import NormalDist
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from meshes.section.model import Model
from meshes.section.quantity import COMMON_UNITS, NUMBER_AND_UNIT, unit_registry

Number = float | str  # plain, or with a unit
STANDARD = NormalDist()
KINDS = ("normal", "lognormal", "uniform", "triangular", "list")


class Distribution(Model):
    """Holds the distribution of one number. The parameters carry the unit, such as ["35 deg", "2 deg"]."""

    normal: tuple[Number, Number] | None = Field(default=None, description="[mean, standard deviation]")
    lognormal: tuple[Number, Number] | None = Field(
        default=None, description="[mean, standard deviation] of the number itself, not of its logarithm"
    )
    uniform: tuple[Number, Number] | None = Field(default=None, description="[least, greatest]")
    triangular: tuple[Number, Number, Number] | None = Field(default=None, description="[least, most likely, greatest]")
    list: tuple[Any, ...] | None = Field(
        default=None, min_length=1, description="values or words, of equal probability"
    )
    probabilities: tuple[float, ...] | None = Field(default=None, description="probabilities of the values of a list")
    truncation: tuple[Number, Number] | None = Field(
        default=None, description="[least, greatest] to which a normal or lognormal distribution is truncated"
    )
    applied_as: Literal["value", "shift", "factor"] = Field(
        default="value",
        description='meaning of a sampled number: the "value" itself, a "shift" added to the value of the '
        'file, or a "factor" on the value of the file',
    )

    @property
    def kind(self) -> str:
        """Return the name of the kind of distribution."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    @property
    def unit(self) -> str:
        """Return the unit of drawn values: the unit of the first parameter; empty for plain numbers and words."""
        first = getattr(self, self.kind)[0]
        return "" if self.kind == "list" else measured(first)[1]

    @property
    def is_words(self) -> bool:
        """Return whether drawn values have no order: a list with an entry that is no number."""
        return self.list is not None and not all(_is_number(value) for value in self.list)

    @model_validator(mode="before")
    @classmethod
    def _is_table(cls, data: Any) -> Any:
        if not isinstance(data, Mapping | cls):
            raise ValueError('expected a distribution, such as { normal = ["10 kPa", "2 kPa"] }')
        return data

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        kinds = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(kinds) != 1:
            raise ValueError(f"expected exactly one of {', '.join(KINDS)}; {len(kinds)} are given")
        if problem := self._problem():
            raise ValueError(problem)
        return self

    def _problem(self) -> str:
        """Return the problem of the parameters; empty if they are valid."""
        if self.kind == "list":
            if self.probabilities is None:
                return ""
            weights = self.probabilities
            right = len(weights) == len(self.list or ()) and min(weights) >= 0.0 and sum(weights) > 0.0
            return "" if right else "probabilities: expected one of 0 or more for each value of the list"
        if self.probabilities is not None:
            return "probabilities: expected with a list only"
        if self.truncation is not None and self.kind not in ("normal", "lognormal"):
            return "truncation: expected with normal and lognormal only"
        try:
            parameters, bounds = self._parameters(), self._bounds()
        except ValueError as error:
            return str(error)
        if self.applied_as == "factor" and self.unit:
            return f"a factor has no unit, this has {self.unit}"
        if self.kind in ("normal", "lognormal") and not parameters[1] > 0.0:
            return f"{self.kind}: expected a standard deviation above 0"
        if self.kind == "lognormal" and not parameters[0] > 0.0:
            return "lognormal: expected a mean above 0"
        if self.kind in ("uniform", "triangular") and (
            [*parameters] != sorted(parameters) or parameters[0] == parameters[-1]
        ):
            return f"{self.kind}: expected rising numbers"
        return "" if bounds[0] < bounds[1] else "truncation: expected rising numbers"

    def _parameters(self) -> tuple[float, ...]:
        return tuple(in_unit(value, self.unit) for value in getattr(self, self.kind))

    def _bounds(self) -> tuple[float, float]:
        if self.truncation is None:
            return (-math.inf, math.inf)
        return in_unit(self.truncation[0], self.unit), in_unit(self.truncation[1], self.unit)

    def at(self, probability: float) -> Any:
        """Return the quantile of a probability (0 to 1): a number in `unit`, or an entry of the list."""
        if self.list is not None:
            weights = self.probabilities or (1.0,) * len(self.list)
            reached = 0.0
            for value, weight in zip(self.list, weights, strict=True):
                reached += weight / sum(weights)
                if probability < reached:
                    return value
            return self.list[-1]
        p = self._parameters()
        if self.kind == "uniform":
            return p[0] + probability * (p[1] - p[0])
        if self.kind == "triangular":
            turn = (p[1] - p[0]) / (p[2] - p[0])
            if probability <= turn:
                return p[0] + math.sqrt(probability * (p[2] - p[0]) * (p[1] - p[0]))
            return p[2] - math.sqrt((1.0 - probability) * (p[2] - p[0]) * (p[2] - p[1]))
        return self._normal_at(probability, *p)

    def _normal_at(self, probability: float, mean: float, deviation: float) -> float:
        """Return the quantile of the normal or lognormal distribution, cut off at its bounds."""
        logarithmic = self.kind == "lognormal"
        if logarithmic:
            variance = math.log1p((deviation / mean) ** 2)
            mean, deviation = math.log(mean) - 0.5 * variance, math.sqrt(variance)

        def standard(value: float) -> float:
            if logarithmic:
                value = math.log(value) if value > 0.0 else -math.inf
            return (value - mean) / deviation

        low, high = (STANDARD.cdf(standard(value)) for value in self._bounds())
        drawn = mean + deviation * STANDARD.inv_cdf(low + probability * (high - low))
        return math.exp(drawn) if logarithmic else drawn

    def written(self, value: Any) -> Any:
        """Return a sampled value in the form of a section file, with its unit."""
        return f"{value!r} {self.unit}" if self.unit else value


def _is_number(value: Any) -> bool:
    try:
        measured(value)
    except ValueError:
        return False
    return not isinstance(value, bool)


def measured(value: Any) -> tuple[float, str]:
    """Return the number and unit of a written value; raise ValueError."""
    if isinstance(value, int | float):
        return float(value), ""
    parts = NUMBER_AND_UNIT.fullmatch(value) if isinstance(value, str) else None
    if parts is None:
        raise ValueError(f'"{value}": expected a number, such as 0.3, or one with its unit, such as "35 deg"')
    return float(parts[1]), parts[2]


def in_unit(value: Any, unit: str) -> float:
    """Return a value of a section file as a number in a unit; without a unit in SI. Raises ValueError if it is no
    number."""
    number, unit_of_value = measured(value)
    if unit_of_value == unit:
        return number
    if not unit_of_value or not unit:
        factor = _si(unit_of_value) / _si(unit)
        return number * factor
    try:
        return float(unit_registry().Quantity(number, unit_of_value).to(unit).magnitude)
    except Exception as error:  # pint raises what its tokenizer raises
        raise ValueError(f'"{value}": expected a number in {unit}') from error


def _si(unit: str) -> float:
    """Return the factor from a unit to the SI unit; 1 without a unit."""
    if not unit:
        return 1.0
    if unit in COMMON_UNITS:
        return COMMON_UNITS[unit][1]
    try:
        return float(unit_registry().Quantity(1.0, unit).to_base_units().magnitude)
    except Exception as error:
        raise ValueError(f'"{unit}": not understood as a unit') from error
