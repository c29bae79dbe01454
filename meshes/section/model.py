"""What every part of an input has in common."""

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """What every part of an input has in common: no unknown keys, no change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
