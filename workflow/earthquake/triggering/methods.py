"""Lists the methods of triggering by their names in [triggering]."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from itertools import chain, zip_longest
from typing import Any, Literal

from workflow.earthquake.triggering import boulanger_idriss, highway_code, idriss_boulanger
from workflow.earthquake.triggering.blow_count import BlowCount, Resistance, SurfaceMotion
from workflow.earthquake.triggering.settings import TriggeringMethod, TriggeringSettings

NUMBER = re.compile(r"\d+(?:\.\d+)?")


@dataclass(frozen=True)
class Relation:
    """Holds a published method of triggering analysis.

    Attributes
    ----------
    title : common name of the method
    source, validity : publication, and range of validity
    find : function of a BlowCount or a ConeTest that returns the resistance; raises ValueError if input is missing
    why_not : function that returns why the method does not apply to a soil; empty if it does
    magnitudes : smallest and largest magnitude; None if the method needs no magnitude
    kind : kind of the tests that the method uses
    """

    title: str
    source: str
    validity: str
    find: Callable[[Any, SurfaceMotion, TriggeringSettings], Resistance]
    why_not: Callable[[Any], str]
    magnitudes: tuple[float, float] | None
    kind: Literal["spt", "cpt"] = "spt"


def _idriss_boulanger(point: BlowCount, shaking: SurfaceMotion, settings: TriggeringSettings) -> Resistance:
    return idriss_boulanger.assess(point, shaking, point.energy_ratio or settings.energy_ratio, settings.rods_above)


def _highway_later(
    form: Literal["2012", "2017"], point: BlowCount, shaking: SurfaceMotion, settings: TriggeringSettings
) -> Resistance:
    return highway_code.assess_later(point, shaking, form, settings.motion)


def _highway(form: str, find: Callable[[BlowCount, SurfaceMotion, TriggeringSettings], Resistance]) -> Relation:
    title = f"Japanese highway code, form of {form}"
    return Relation(title, f"{highway_code.SOURCE} ({form})", highway_code.VALIDITY, find, highway_code.why_not, None)


RELATIONS: dict[TriggeringMethod, Relation] = {
    "idriss_boulanger_2008": Relation(
        "Idriss & Boulanger (2008)",
        idriss_boulanger.SOURCE,
        idriss_boulanger.VALIDITY,
        _idriss_boulanger,
        idriss_boulanger.why_not,
        idriss_boulanger.MAGNITUDES,
    ),
    "boulanger_idriss_2014": Relation(
        "Boulanger & Idriss (2014)",
        boulanger_idriss.SOURCE,
        boulanger_idriss.VALIDITY,
        lambda point, shaking, _: boulanger_idriss.assess(point, shaking),
        boulanger_idriss.why_not,
        boulanger_idriss.MAGNITUDES,
        "cpt",
    ),
    "highway_1990": _highway("1990", lambda point, shaking, _: highway_code.assess_1990(point, shaking)),
    "highway_2012": _highway("2012", partial(_highway_later, "2012")),
    "highway_2017": _highway("2017", partial(_highway_later, "2017")),
}


def reasons_in_one(reasons: Iterable[str]) -> list[str]:
    """Join reasons of many tests that differ in their numbers alone.

    Parameters
    ----------
    reasons : reasons why a method does not apply

    Returns
    -------
    Every reason once, with the range of each of its numbers, such as "soil behaviour index 2.7 to 3.1 is above 2.6".
    """
    values: dict[tuple[str, ...], list[list[str]]] = {}
    for reason in reasons:
        values.setdefault(tuple(NUMBER.split(reason)), []).append(NUMBER.findall(reason))
    return [
        "".join(chain(*zip_longest(words, map(_range_words, zip(*numbers, strict=True)), fillvalue="")))
        for words, numbers in values.items()
    ]


def _range_words(numbers: tuple[str, ...]) -> str:
    """Return numbers as their range, "3.1 to 3.2", or as the one number that they all are."""
    return " to ".join(dict.fromkeys((min(numbers, key=float), max(numbers, key=float))))
