"""How a file with a record of the ground's acceleration is read: the words of every table that asks for one."""

from typing import Annotated, Literal

from pydantic import Field

RecordUnit = Annotated[
    Literal["", "g", "m/s^2", "gal"],
    Field(description='the unit of a .csv file, "g", "m/s^2" or "gal", where its heading does not say'),
]
RecordScale = Annotated[float, Field(gt=0.0, le=100.0, description="a number that multiplies the record, above 0")]
