"""Provides the base classes of the answers of all stages, with their reading and writing.

An answer is a pydantic model whose fields are the keys of its JSON file. Units are in the names
(``settlement_uphill_m``, ``E_Pa``) or in the description of a field; a number with neither is dimensionless.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
)

from meshes.section.section import Section
from workflow.config.renamed import current_answer
from workflow.run.store import OtherVersionError, Store

Point = tuple[float, float]
Line = tuple[Point, ...]

# The setting of a direction of the seismic force, and the words of the field for it.
FORCE: Mapping[str, str] = {"downhill": "downslope", "uphill": "upslope"}


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


# A number, or None where it is not known; what is not finite is not known.
Known = Annotated[float | None, BeforeValidator(_finite)]


class Part(BaseModel):
    """Is the base class of the parts of an answer.

    A part is immutable, refuses unknown keys, and can be made from any object with attributes of the same names
    (``model_validate``).

    A field without a default is always in the file, as null if it has no value. A field with the default None is only
    in the file if it has a value.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, from_attributes=True, defer_build=True)

    @model_serializer(mode="wrap")
    def _without_what_is_not_there(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written: dict[str, Any] = serialise(self)
        required = {name for name, field in type(self).model_fields.items() if field.is_required()}
        return {name: value for name, value in written.items() if value is not None or name in required}

    @classmethod
    def taken(cls, source: object, /, **more: Any) -> Self:
        """Make a part from the attributes of an object that have the names of its fields.

        Parameters
        ----------
        source : the result of a library, or another part
        more : fields that ``source`` does not have, or that have another meaning there
        """
        common_fields = {
            name: getattr(source, name) for name in cls.model_fields if name not in more and hasattr(source, name)
        }
        return cls.model_validate({**common_fields, **more})


class Answer(Part):
    """Is the base class of an answer, the content of the JSON file of a stage.

    ``FILE`` is the name of the file within the folder of a run. ``VERSION`` has to be increased when the meaning of a
    key changes but not its name. A new key without a default needs no new version, since a file without this key is
    recognised as an older one.
    """

    FILE: ClassVar[str]
    VERSION: ClassVar[int] = 1

    @classmethod
    def read(cls, store: Store) -> Self:
        """Read the answer in a folder.

        Parameters
        ----------
        store : the folder of the run

        Raises
        ------
        InputError
            If the file is missing or not JSON.
        OtherVersionError
            If another version of the program wrote the file.
        """
        data = current_answer(store.read_json(cls.FILE))
        version = data.pop("version", None) if isinstance(data, dict) else None
        try:
            answer = cls.model_validate(data)
        except ValidationError as error:
            raise OtherVersionError(str(store.folder / cls.FILE), _problems(error)) from None
        if version != cls.VERSION:
            phrase = (
                f"version {version} of this file; expected version {cls.VERSION}; run the stage that writes it again"
            )
            raise OtherVersionError(str(store.folder / cls.FILE), [phrase])
        return answer

    def write(self, store: Store) -> None:
        """Write the answer into a folder; numbers that are not finite become null."""
        store.write_json(self.FILE, {"version": self.VERSION, **self.model_dump(mode="json")})


class SectionLabel(Part):
    """Names the section to which an answer belongs."""

    name: str = Field(description="name of the section")
    sha256: str = Field(description="fingerprint of the section, without its title")
    reconstruction: bool = Field(description="whether the section is a reconstruction of ground that was not surveyed")

    @classmethod
    def of(cls, section: Section) -> Self:
        """Return name, fingerprint and reconstruction flag of a section."""
        return cls(name=section.name, sha256=section.sha256(), reconstruction=section.reconstruction)


def line(points: np.ndarray) -> Line:
    """Return the points of a line in the form of the stored answers.

    Parameters
    ----------
    points (n, 2) : x and elevation (m)

    Returns
    -------
    The n points as pairs of floats.
    """
    return tuple((float(x), float(z)) for x, z in points)


def way_out(sides: Sequence[str]) -> str:
    """Return a clause on the sides of the section that the failing ground reaches.

    Parameters
    ----------
    sides : "left", "right", both, or none

    Returns
    -------
    The clause with the comma before it; empty without any side.
    """
    return f", and the failing ground reaches the {' and the '.join(sides)} side" if sides else ""


def _problems(error: ValidationError) -> list[str]:
    """Return the first three keys that do not fit, each with the expected value."""
    phrases = [f"{'.'.join(map(str, fault['loc'])) or 'the file'}: {fault['msg']}" for fault in error.errors()]
    return [*phrases[:3], "another version of the program wrote the file; run the stage that writes it again"]
