"""The collection of published cases, read once."""

from functools import cache

from docs.verify.case import FOLDER, Case, read_cases
from tests.support import TOP

PUBLISHED = TOP / FOLDER


@cache
def cases() -> dict[str, Case]:
    """Every case by its name."""
    return {case.name: case for case in read_cases(PUBLISHED)}
