"""Reads the collections of published slopes and of known slides once."""

from functools import cache

from docs.verify.case import FOLDER, Case, read_cases
from docs.verify.slides import case as slides_case
from tests.support import TOP

PUBLISHED = TOP / FOLDER


@cache
def cases() -> dict[str, Case]:
    """Return every case by its name."""
    return {case.name: case for case in read_cases(PUBLISHED)}


@cache
def slides() -> dict[str, slides_case.SlideCase]:
    """Return every known slide by its name."""
    return {case.name: case for case in slides_case.read_cases(TOP / slides_case.FOLDER)}
