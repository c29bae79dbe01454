"""Adds the first face of a structure to slide to the numbers of the first page whose failure does not contain a crest.

The values of a structure that the section file names stand first, with the smaller value of the failure elsewhere
beside them. An embankment that was found in the ground surface is added to the value of the section.
"""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from workflow.report.faces import FaceLine, face_lines
from workflow.report.numbers import coefficient, from_to
from workflow.report.verdicts import spared_structures
from workflow.results.accuracy import METHODS
from workflow.results.results import Results
from workflow.results.verdicts import HeadlinePart
from workflow.texts.report_texts import Texts

Quantity = Literal["critical", "safety"]
NO_VALUE = "–"


def with_crests(
    headline: HeadlinePart,
    results: Results,
    surface: np.ndarray | Sequence[Sequence[float]],
    quantity: Quantity,
    _: Texts,
) -> HeadlinePart:
    """Return a headline with the smallest value of the faces of structures, if no crest moves in its failure.

    ``surface``: slip surface of the failure (m); ``quantity``: critical Kh or factor of safety; ``_``: texts in the
    language of the report; ``results``: all results of the run.
    """
    names = spared_structures(results, surface)
    if not names or headline.value == NO_VALUE:
        return headline
    x = [point[0] for point in surface]
    ends = {"left": f"{min(x):.0f}", "right": f"{max(x):.0f}"}
    phrase = ""
    if quantity == "critical":
        phrase = _(
            "This mechanism reaches from x = {left} to {right} m, and no crest is part of this failure ({structures}).",
            **ends,
            structures=_.listed(names),
        )
    first = _first_line(results, quantity)
    if first is None:
        return headline.model_copy(update={"conclusion": _joined(headline.conclusion, phrase)})
    value, line = first
    sentence = _first_face(results, _) if quantity == "critical" else ""
    if results.config.section.structures:
        elsewhere = _(
            "; {value} from x = {left} to {right} m, where no crest is part of the failure",
            value=headline.value,
            **ends,
        )
        return HeadlinePart(
            name=_("{quantity}, {structure} ({side})",
                   quantity=headline.name, structure=line.name, side=_.sentence(line.side)),
            value=_digits(value, quantity),
            interval=_interval(line, quantity, _) + elsewhere,
            conclusion=_joined(sentence, headline.conclusion, phrase),
        )  # fmt: skip
    crests = _("; {value} for the first crest to slide", value=_digits(value, quantity))
    conclusion = _joined(headline.conclusion, phrase, sentence)
    return headline.model_copy(update={"conclusion": conclusion, "interval": headline.interval + crests})


def _joined(*sentences: str) -> str:
    return " ".join(sentence for sentence in sentences if sentence)


def _digits(value: float, quantity: Quantity) -> str:
    return coefficient(value) if quantity == "critical" else f"{value:.2f}"


def _first_line(results: Results, quantity: Quantity) -> tuple[float, FaceLine] | None:
    """Return the smallest value of the faces of structures, and its line of the table; None without any."""
    values = [
        (value, line)
        for line in face_lines(results)
        if line.of_structure and (value := getattr(line, quantity).of_face) is not None
    ]
    return min(values, key=lambda pair: pair[0], default=None)


def _interval(line: FaceLine, quantity: Quantity, _: Texts) -> str:
    """Return the strict bounds of the value of a face, or the method that it is by."""
    values = getattr(line, quantity)
    if values.governing is None:
        return _("by slip circles")
    if values.lower is None or values.upper is None:
        return _("by finite elements")
    return from_to(_digits(values.lower, quantity), _digits(values.upper, quantity), METHODS[1], _)


def _first_face(results: Results, _: Texts) -> str:
    """Return a sentence on the face of a structure that fails first; empty without any."""
    first = _first_line(results, "critical")
    if first is None:
        return ""
    kc, line = first
    low, factor = line.critical.davis_of_face, line.safety.of_face
    value = _("{kc} by slip circles", kc=coefficient(kc)) if line.critical.governing is None else coefficient(kc)
    values = {"structure": line.name, "side": _.sentence(line.side), "kc": value}
    if low is None or factor is None:
        return _("Of the crests, {structure} slides first ({side}), at Kh = {kc}.", **values)
    return _(
        "Of the crests, {structure} slides first ({side}), at Kh = {kc} ({davis} with Davis reduced strength); without "
        "shaking its factor of safety is {factor}.",
        **values,
        davis=coefficient(low),
        factor=f"{factor:.2f}",
    )
