"""Defines the tables [uncertain], distributions of numbers of the input, and [study], their sampling."""

from collections.abc import Callable, Iterator, Mapping, Set
from contextlib import suppress
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from meshes.section.model import Model
from workflow.uncertain.distribution import Distribution

SamplingMethod = Literal["sobol", "latin", "saltelli"]


class Correlation(Model):
    """Holds the correlation of two uncertain numbers."""

    paths: tuple[str, str] = Field(
        description="paths of the two correlated numbers, both of them in the table [uncertain]"
    )
    coefficient: float = Field(
        gt=-1.0,
        lt=1.0,
        description="correlation of the normal variables behind both numbers (Gaussian copula), such as -0.5",
    )


def _nested(path: str, value: Any, known: Set[str]) -> Iterator[str]:
    """Yield the paths to distributions within nested tables."""
    for key, nested in value.items() if isinstance(value, Mapping) and not known & set(value) else ():
        if isinstance(nested, Mapping):
            deeper = not known & set(nested) and any(isinstance(item, Mapping) for item in nested.values())
            yield from _nested(f"{path}.{key}", nested, known) if deeper else (f"{path}.{key}",)


class UncertainSettings(Model):
    """Holds the distributions of numbers of the input, the table [uncertain] of the input file.

    The keys of the table are the paths of the numbers, such as "strata.5 Asd.friction_angle".
    """

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)
    __pydantic_extra__: dict[str, Distribution] = Field(init=False)

    correlated: tuple[Correlation, ...] = Field(
        default=(),
        description="correlated pairs, { paths = [path, path], coefficient = 0.5 }; other pairs are independent",
    )

    @property
    def numbers(self) -> dict[str, Distribution]:
        """Return every uncertain number by its path, in the order of the file."""
        return dict(self.__pydantic_extra__ or {})

    def correlation(self) -> np.ndarray:
        """Return the matrix (n, n) of correlations of the normal variables, in the order of `numbers`."""
        places = {path: place for place, path in enumerate(self.numbers)}
        matrix = np.eye(len(places))
        for pair in self.correlated:
            i, j = (places[path] for path in pair.paths)
            matrix[i, j] = matrix[j, i] = pair.coefficient
        return matrix

    @model_validator(mode="before")
    @classmethod
    def _paths_are_quoted(cls, data: Any) -> Any:
        """Refuse paths without quotation marks, which TOML reads as nested tables. Raises ValueError with the
        correct form.
        """
        if isinstance(data, Mapping):
            known = set(Distribution.model_fields)
            nested = [path for key, value in data.items() for path in _nested(str(key), value, known)]
            if nested:
                like = 'such as "strata.Sand.friction_angle"'
                problems = [
                    f'{path}: expected a path in quotation marks, "{path}" = {{ ... }}, {like}' for path in nested
                ]
                raise ValueError("\n".join(problems))
        return data

    @model_validator(mode="after")
    def _fits(self) -> Self:
        problems = []
        for number, pair in enumerate(self.correlated, start=1):
            unknown = [path for path in pair.paths if path not in self.numbers]
            problems += [f'correlated {number}, paths = "{path}": expected a path of this table' for path in unknown]
            if pair.paths[0] == pair.paths[1]:
                problems.append(f"correlated {number}, paths: expected two different paths")
        if not problems and self.correlated and np.linalg.eigvalsh(self.correlation()).min() <= 0.0:
            problems.append(
                "correlated: no numbers can have these correlations together; expected smaller coefficients"
            )
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def problems(self, check: Callable[[Mapping[str, Any]], object]) -> list[str]:
        """Return problems of the uncertain numbers, one sentence each; ``check`` takes medians by their paths, and
        raises ValueError.
        """
        medians = {path: distribution.at(0.5) for path, distribution in self.numbers.items()}
        problems: list[str] = []
        with suppress(ValueError):  # all at once where nothing is wrong, which is quick
            if medians:
                check(medians)
            return problems
        for path, median in medians.items():
            try:
                check({path: median})
            except ValueError as error:
                messages = getattr(error, "problems", None) or str(error).splitlines()
                problems += [f'uncertain, "{path}": {text}' for text in messages]
        return problems or ["uncertain: each number is valid at its median, but all medians together are not"]


Length = Annotated[float, Field(gt=0.0)]


class StudySettings(Model):
    """Holds the number and method of the samples of a study, and the slides whose probability is wanted."""

    samples: int = Field(
        default=64,
        ge=2,
        le=1_000_000,
        description="number of samples; a power of two fills the space of the numbers most evenly",
    )
    method: SamplingMethod = Field(
        default="sobol",
        description='"sobol" (scrambled sequence; more samples continue fewer), "latin" (Latin hypercube), or '
        '"saltelli" (Sobol\' indices, which takes 2 more sets of samples and one for each uncertain number)',
    )
    seed: int = Field(default=0, ge=0, description="seed of the samples")
    exceeds: tuple[Length, ...] = Field(
        default=(0.1, 0.5, 1.0), min_length=1, description="slides (m) whose probability of exceedance is computed"
    )

    @model_validator(mode="after")
    def _power_of_two(self) -> Self:
        if self.method == "saltelli" and self.samples & (self.samples - 1):
            raise ValueError(f"samples = {self.samples}: expected a power of two, which Sobol' indices require")
        return self
