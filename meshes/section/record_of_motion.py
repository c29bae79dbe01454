"""How a file with a record of the ground's acceleration is read: the words of every table that asks for one."""

from typing import Annotated

from pydantic import AfterValidator, Field

from meshes.section.motion_units import checked

RecordUnit = Annotated[
    str,
    AfterValidator(checked),
    Field(description='the unit of the record where its heading names none: "g", "m/s^2", "gal", "cm/sec^2", "%g"'),
]
RecordComponent = Annotated[
    str,
    Field(description='which component of a file with several, as its heading names it, such as "EW", or its number'),
]
RecordScale = Annotated[float, Field(gt=0.0, le=100.0, description="a number that multiplies the record, above 0")]
