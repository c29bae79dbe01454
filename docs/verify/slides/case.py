"""Reads a known slide: measured values and the problem to be computed, one TOML file each."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError

from dem.case import Case
from docs.verify.case import case_files
from meshes.errors import InputError
from meshes.section.quantity import Angle, Length
from meshes.section.section import Model
from meshes.section.toml_file import read_toml
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering

# Folder of the cases in a checkout.
FOLDER = Path("tests/verification/slides")

Group = Literal["theory", "experiment", "field"]


class Measured(Model):
    """Holds a measured or derived value: one number, or a range."""

    author: str
    value: float | tuple[float, float] = Field(description="a number, or the lower and the upper one")
    how: str = Field(default="", description="how it was measured, and how well")
    counts: bool = Field(default=True, description="false if it is a comparison alone")

    @property
    def ends(self) -> tuple[float, float]:
        """Return the lower and the upper number."""
        return self.value if isinstance(self.value, tuple) else (self.value, self.value)


class Column(Model):
    """Describes a column behind a gate that is removed. Its result is the run-out over its width (sand) or its height
    (clay)."""

    kind: Literal["column"]
    width: Length
    height: Length
    radius: Length
    density: float = Field(default=1800.0, gt=0.0, description="kg/m3")
    friction_angle: Angle = 0.0
    weight_over_strength: float = Field(default=0.0, ge=0.0, description="gamma H / s_u of clay; 0 for sand")
    rigidity: float = Field(default=300.0, gt=0.0, description="E / s_u of clay")
    slowly: bool = Field(
        default=False, description="whether gravity grows slowly from a share at which the column stands"
    )
    reach: float = Field(default=8.0, gt=1.0, description="length of the floor over the width")


class UniformSlope(Model):
    """Describes an infinite slope with a liquefying layer below a crust. Its result is the slide of the crust under Kh
    or on a shaken base.

    Kh is constant for ``seconds``, alternates in ``cycles`` of a ``period``, or is the peak of a ``record``.
    """

    kind: Literal["uniform slope"]
    angle: Angle
    thickness: tuple[Length, Length] = Field(description="thickness of the layer that liquefies, and of the crust")
    radius: Length
    density: float = Field(default=1800.0, gt=0.0, description="kg/m3")
    friction_angle: Angle
    length: Length
    kh: float = Field(ge=0.0)
    seconds: float | None = Field(default=None, gt=0.0)
    cycles: float | None = Field(default=None, gt=0.0)
    period: float = Field(default=1.0, gt=0.0, description="of these cycles (s)")
    record: str = Field(default="", description="a file beside the case")
    water: Length | None = Field(default=None, description="depth of the water table below the surface")
    left: Case = Field(description="what the layer keeps")


class Ground(Model):
    """Describes a section file with a table [known]. Its result is the slide at a place of its surface."""

    kind: Literal["section"]
    section: str = Field(default="", description="its file, relative to that of the case; by default the same file")
    case: str = Field(description="name or number of the case of the slide")
    at: float | Literal["front", "largest", "crest"] = Field(
        description='x of a surface point (m), "largest" slide, run-out of the "front", or sinking of the "crest"'
    )
    flow: bool = Field(default=False, description="whether the ground flowed instead of spreading laterally")


Problem = Annotated[Column | UniformSlope | Ground, Field(discriminator="kind")]


class Known(Model):
    """Holds the table [known] of a case."""

    group: Group
    source: str
    quantity: str = Field(description="what was measured, such as run-out over width")
    unit: str = Field(default="", description='"m", or nothing for a ratio')
    assumed: str = Field(default="", description="what had to be assumed")
    seeds: int = Field(default=3, ge=1, le=50, description="number of packings")
    zero: float = Field(default=0.0, ge=0.0, description="largest value that counts as no movement")
    values: tuple[Measured, ...] = Field(min_length=1)
    problem: Problem


@dataclass(frozen=True)
class SlideCase:
    """Holds a known slide, with its config if it has a section."""

    name: str
    title: str
    known: Known
    config: Config | None = None
    folder: Path = FOLDER

    @property
    def measured(self) -> tuple[float, float]:
        """Return the smallest and the largest of the numbers that count."""
        ends = [end for value in self.known.values if value.counts for end in value.ends]
        return min(ends), max(ends)


def read_case(path: Path) -> SlideCase:
    """Read the case in a file; raises InputError with all problems."""
    data: dict[str, Any] = read_toml(path)
    try:
        known = TypeAdapter(Known).validate_python(data.pop("known", {}))
    except ValidationError as error:
        problems = [f"known, {', '.join(map(str, entry['loc']))}: {entry['msg']}" for entry in error.errors()]
        raise InputError(str(path), problems) from error
    name, title = str(data.get("name", "")), str(data.get("title", ""))
    if name != path.stem:
        raise InputError(str(path), [f'name = "{name}": expected that of the file, "{path.stem}"'])
    if not isinstance(known.problem, Ground):
        if unknown := sorted(set(data) - {"name", "title"}):
            raise InputError(str(path), [f"{', '.join(unknown)}: not used by a problem of this kind"])
        return SlideCase(name, title, known, None, path.parent)
    if known.problem.section:
        return SlideCase(name, title, known, config_after_triggering(Config.load(path.parent / known.problem.section)))
    return SlideCase(name, title, known, config_after_triggering(Config.parse(data, str(path)), str(path)))


def read_cases(folder: Path, names: Sequence[str] = ()) -> list[SlideCase]:
    """Read the cases in a folder, selected as in `case_files`."""
    return [read_case(path) for path in case_files(folder, names)]
