"""Reads a published case: a section file with a table [published] of published values."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

from pydantic import Field, TypeAdapter, ValidationError

from fem.settings import FemSettings
from meshes.errors import InputError
from meshes.section.section import Model, Section
from meshes.section.toml_file import read_toml
from meshes.settings import MeshSettings
from workflow.config.renamed import current

# Folder of the cases in a checkout.
FOLDER = Path("tests/verification/published")

Kind = Literal["equilibrium", "elements", "limit analysis", "closed form", "upper bound", "survey"]


class Value(Model):
    """Holds a published value: one number, or a range."""

    kind: Kind = Field(description="method: limit equilibrium, finite elements, ...")
    author: str
    method: str
    value: float | tuple[float, float] = Field(description="a number, or the lower and the upper one")

    @property
    def ends(self) -> tuple[float, float]:
        """Return the lower and the upper number."""
        return self.value if isinstance(self.value, tuple) else (self.value, self.value)


class Published(Model):
    """Holds the table [published] of a case."""

    source: str
    expected: Literal["fs", "kc"] = Field(description='"fs", a factor of safety, or "kc", a critical coefficient')
    kh: float = Field(default=0.0, ge=0.0, description="Kh of the factor of safety")
    note: str = Field(default="", description="what is uncertain, or where sources disagree")
    explained: str = Field(default="", description="why the published values are wrong")
    values: tuple[Value, ...] = Field(min_length=1)


@dataclass(frozen=True)
class Case:
    """Holds a section with the values published on it, and the settings of finite elements and mesh in its file."""

    section: Section
    fem: FemSettings
    published: Published
    mesh: MeshSettings = field(default_factory=MeshSettings)

    @property
    def name(self) -> str:
        return self.section.name


def read_case(path: Path) -> Case:
    """Read the case in a file; raises InputError with all problems."""
    data = current(read_toml(path))
    try:
        published = TypeAdapter(Published).validate_python(data.pop("published", {}))
        fem = FemSettings.model_validate(data.pop("fem", {}))
        mesh = MeshSettings.model_validate(data.pop("mesh", {}))
    except ValidationError as error:
        problems = [f"{', '.join(map(str, entry['loc']))}: {entry['msg']}" for entry in error.errors()]
        raise InputError(str(path), problems) from error
    case = Case(Section.parse(data, str(path)), fem, published, mesh)
    if case.name != path.stem:
        raise InputError(str(path), [f'name = "{case.name}": expected that of the file, "{path.stem}"'])
    return case


def read_cases(folder: Path, names: Sequence[str] = ()) -> list[Case]:
    """Read the cases in a folder, selected as in `case_files`."""
    return [read_case(path) for path in case_files(folder, names)]


def case_files(folder: Path, names: Sequence[str]) -> list[Path]:
    """Return the files of cases in a folder in alphabetical order; with ``names``, only files whose names begin with
    one of them, upper or lower case.

    Raises InputError if the folder has no cases, or if no case has one of the ``names``.
    """
    files = sorted(folder.glob("*.toml"))
    if not files:
        raise InputError(str(folder), ["there are no cases in it; run this in a checkout, or name one with --folder"])
    starts = [name.lower() for name in names]
    stems = [path.stem.lower() for path in files]
    missing = [name for name in starts if not any(stem.startswith(name) for stem in stems)]
    if missing:
        raise InputError(str(folder), [f'there is no case "{name}"{_hint(name, stems)}' for name in missing])
    return [path for path, stem in zip(files, stems, strict=True) if not names or stem.startswith(tuple(starts))]


def _hint(name: str, stems: Sequence[str]) -> str:
    """Return a hint with similar names, or on where all cases are listed."""
    close = get_close_matches(name, stems, n=3)
    return f"; did you mean {' or '.join(close)}?" if close else "; README.md in it names all of them"
