"""Reads cone penetration tests of the national registry of the Netherlands (BRO), an XML document for each sounding.

Every reading has 25 numbers in the order of the catalogue (Catalogus geotechnisch sondeeronderzoek 1.1): length and
depth in m, resistance, friction and pore pressures in MPa, friction ratio in %; -999999 where nothing was measured.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from meshes.borings.gef_file import (
    CORRECTED,
    DEPTH,
    FRICTION,
    LENGTH,
    PORE_PRESSURE,
    RATIO,
    RESISTANCE,
    cones_of,
    sounding_file,
)
from meshes.borings.log import BoringFile, Log
from meshes.errors import InputError

EXPECTED = "expected a cone penetration test of the Dutch registry (BRO), a document with CPT_O"
# The place of a quantity in a reading, and what its unit is in m or Pa.
PLACES = {LENGTH: (0, 1.0), DEPTH: (1, 1.0), RESISTANCE: (3, 1e6), CORRECTED: (4, 1e6), FRICTION: (18, 1e6),
          PORE_PRESSURE: (22, 1e6), RATIO: (24, 0.01)}  # fmt: skip
NUMBERS, NONE = 25, -999999.0


def read_bro(path: Path, columns: Mapping[str, str] | None = None) -> BoringFile:
    """Read the sounding of a document, without layers.

    Parameters
    ----------
    path : path of the file
    columns : must be empty, since the file has no columns

    Returns
    -------
    The sounding; its coordinates are those of the Dutch grid (m).

    Raises
    ------
    InputError
        If the file is no such document, or if the readings are impossible for soil.
    """
    text = path.read_bytes()
    if b"<!ENTITY" in text:
        raise InputError(str(path), [f"{EXPECTED}; the file defines XML entities, which the registry does not use"])
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InputError(str(path), [f"{EXPECTED}; it cannot be read: {error}"]) from error
    test = next(_elements_named(root, "CPT_O"), None)
    if test is None:
        raise InputError(str(path), [f"{EXPECTED}, not {_name(root)}"])
    try:
        place = [float(number) for number in _text(next(_elements_named(test, "deliveredLocation")), "pos").split()]
        log = Log(
            _text(test, "broId"), (place[0], place[1]), float(_text(test, "offset")), (),
            cones=cones_of(path, _readings(test), float(_text(test, "coneSurfaceQuotient", "1"))),
        )  # fmt: skip
    except InputError:
        raise
    except (IndexError, StopIteration, ValueError) as error:
        raise InputError(str(path), [f"{EXPECTED}; required parts are missing, or have another form"]) from error
    return sounding_file(path, log, [])


def _name(node: Element) -> str:
    """Return the name of an element without its namespace."""
    return node.tag.rpartition("}")[2]


def _elements_named(node: Element, name: str) -> Iterator[Element]:
    return (child for child in node.iter() if _name(child) == name)


def _text(node: Element, name: str, default: str | None = None) -> str:
    """Return the text of the first element with a name; raise StopIteration without one and without a default."""
    text = next(((child.text or "").strip() for child in _elements_named(node, name)), default)
    if text is None:
        raise StopIteration
    return text


def _readings(test: Element) -> Iterator[dict[int, float]]:
    """Yield the quantities of every reading. Raises ValueError if a reading has another number of values."""
    for row in filter(None, map(str.strip, _text(next(_elements_named(test, "cptResult")), "values").split(";"))):
        numbers = [float(cell) for cell in row.split(",")]
        if len(numbers) != NUMBERS:
            raise ValueError(f"{len(numbers)} numbers")
        yield {key: unit * numbers[place] for key, (place, unit) in PLACES.items() if numbers[place] != NONE}
