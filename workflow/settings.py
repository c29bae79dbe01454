"""The whole input of a run: a section, and how to mesh it and compute with it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import Field, model_validator

from fem.settings import BoundsSettings, FemSettings
from meshes.quadrilaterals import MeshSettings
from meshes.section import Section, read_toml

# Options of the command line that take the place of other settings in the file.
REPLACES = {("mesh", "size"): ("columns", "rows"), ("mesh", "method"): ("columns", "rows")}


class Input(Section):
    """A section with the settings of the stages, one TOML table each."""

    mesh: MeshSettings = Field(default=MeshSettings(), description="a table [mesh] that says how to mesh")
    fem: FemSettings = Field(default=FemSettings(), description="a table [fem] of the finite element analysis")
    bounds: BoundsSettings = Field(default=BoundsSettings(), description="a table [bounds] of the limit analysis")

    @model_validator(mode="after")
    def _settings_fit(self) -> Self:
        problems = self.mesh.problems(self)
        if problems:
            raise ValueError("\n".join(problems))
        return self

    @classmethod
    def load(cls, path: Path | str, overrides: Mapping[str, Mapping[str, Any]] | None = None) -> Self:
        """The input in a TOML file, with settings of the command line put over those of the file.

        Raises InputError with every problem found.
        """
        data = read_toml(path)
        for table, values in (overrides or {}).items():
            given = {key: value for key, value in values.items() if value is not None}
            if given and isinstance(data.get(table, {}), dict):
                replaced = {other for key in given for other in REPLACES.get((table, key), ())}
                kept = {key: value for key, value in data.get(table, {}).items() if key not in replaced}
                data[table] = {**kept, **given}
        return cls.parse(data, str(path))
