"""The whole input of a run: a section, and how to mesh it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import Field, model_validator

from meshes.quadrilaterals import MeshSettings
from meshes.section import Section, read_toml


class Input(Section):
    """A section with the settings of the stages, one TOML table each."""

    mesh: MeshSettings = Field(default=MeshSettings(), description="how to mesh, a table [mesh]")

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
                data[table] = {**data.get(table, {}), **given}
        return cls.parse(data, str(path))
