"""The collection of published cases, read once."""

from functools import cache

from tests.support import TOP
from workflow.verify.case import FOLDER, Case, read_cases

PUBLISHED = TOP / FOLDER


@cache
def cases() -> dict[str, Case]:
    """Every case by its name."""
    return {case.name: case for case in read_cases(PUBLISHED)}
