"""A published case: a section as users write it, and in the table [published] what others found for it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

from pydantic import Field, TypeAdapter, ValidationError

from fem.settings import FemSettings
from meshes.errors import InputError
from meshes.section.section import Model, Section, read_toml
from meshes.settings import MeshSettings
from workflow.config.renamed import current

# Where the cases are in a checkout, seen from its top.
FOLDER = Path("tests/verification/published")

Kind = Literal["equilibrium", "elements", "limit analysis", "closed form", "upper bound", "survey"]


class Value(Model):
    """A published value: one number, or a range."""

    kind: Kind = Field(description="how it was found: limit equilibrium, finite elements, ...")
    author: str
    method: str
    value: float | tuple[float, float] = Field(description="a number, or the lower and the upper one")

    @property
    def ends(self) -> tuple[float, float]:
        """The lower and the upper number."""
        return self.value if isinstance(self.value, tuple) else (self.value, self.value)


class Published(Model):
    """The table [published]."""

    source: str
    expected: Literal["fs", "kc"] = Field(description='"fs", a factor of safety, or "kc", a critical coefficient')
    kh: float = Field(default=0.0, ge=0.0, description="the Kh at which the factor of safety is wanted")
    note: str = Field(default="", description="what is uncertain, or where sources disagree")
    explained: str = Field(default="", description="why what was published differs from what is right")
    values: tuple[Value, ...] = Field(min_length=1)


@dataclass(frozen=True)
class Case:
    """A section with what was published on it, and the settings of elements and mesh in its file."""

    section: Section
    fem: FemSettings
    published: Published
    mesh: MeshSettings = field(default_factory=MeshSettings)

    @property
    def name(self) -> str:
        return self.section.name


def read_case(path: Path) -> Case:
    """The case in a file; raises InputError with every problem found."""
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
    """The `case_files` of a folder as they are read."""
    return [read_case(path) for path in case_files(folder, names)]


def case_files(folder: Path, names: Sequence[str]) -> list[Path]:
    """The cases of a folder in the order of their names; some only, or those whose names begin with one of ``names``.

    Capitals are those of anybody. Raises InputError if the folder has none, or one that is asked for is missing.
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
    """A hint: names similar to the one given, or how to list all."""
    close = get_close_matches(name, stems, n=3)
    return f"; did you mean {' or '.join(close)}?" if close else "; README.md in it names all of them"
