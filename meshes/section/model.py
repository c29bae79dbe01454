"""Defines the base class of all parts of an input."""

from typing import Any, Self

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """Is the base class of all parts of an input.

    Unknown keys are refused, and values cannot be changed after reading.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)

    def changed(self, **values: Any) -> Self:
        """Return a copy with other values; raise ValidationError for an unknown key, or a value that does not fit."""
        known = {key: value for key, value in vars(self).items() if key in self.model_fields_set}
        return type(self).model_validate({**known, **values})
