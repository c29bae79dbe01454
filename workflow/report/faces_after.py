"""Gives the factors of safety of the faces of structures after shaking and after liquefaction, by every method."""

from collections.abc import Iterator
from typing import NamedTuple

from workflow.report.numbers import case_numbers
from workflow.report.structures import FaceRow
from workflow.results.faces import FaceAtRest
from workflow.results.governing import value_of_face
from workflow.results.results import Results
from workflow.results.slices import CirclesAtRest


class AfterLine(NamedTuple):
    """Holds the factor of safety of a face after shaking or liquefaction: when, by finite elements, by slip circles."""

    when: str
    elements: str
    circles: str


def factors_after(results: Results, row: FaceRow) -> Iterator[AfterLine]:
    """Yield the factors of safety of a face after shaking, and after liquefaction in each case."""
    slices, faces, face = results.slices, results.faces, row.face
    states: list[tuple[str, CirclesAtRest | None, tuple[FaceAtRest, ...]]] = []
    if slices is not None and slices.after_shaking is not None:
        states.append(("after shaking", slices.after_shaking, faces.after_shaking if faces is not None else ()))
    for case in results.liquefied.cases if results.liquefied is not None else ():
        states.append(
            (f"case{'s' if len(case.cases) > 1 else ''} {case_numbers(case.cases)}", case.circles, case.faces)
        )
    for when, circles, values in states:
        circle = next(
            (
                item.circle.bishop
                for item in (circles.faces if circles is not None else ())
                if (item.start_m, item.end_m, item.towards) == (face.start_m, face.end_m, face.towards)
            ),
            None,
        )
        value = next(
            (item.safety for item in values if (item.structure, item.towards) == (face.structure, face.towards)), None
        )
        elements, by_elements = value_of_face(value, None)
        texts = ["" if number is None else f"{number:.2f}" for number in (elements if by_elements else None, circle)]
        if any(texts):
            yield AfterLine(when, *texts)


def strong_elsewhere(results: Results) -> Iterator[str]:
    """Yield a sentence on the strong zones with which faces were computed after shaking or liquefaction."""
    cases = results.liquefied.cases if results.liquefied is not None else ()
    faces = [face for case in cases for face in case.faces]
    faces += results.faces.after_shaking if results.faces is not None else ()
    names = dict.fromkeys(
        f"{face.structure}, towards the {face.towards}"
        for face in faces if face.safety is not None and face.safety.strong_zones
    )  # fmt: skip
    for name in names:
        yield (
            f"Factor of safety of {name}, after shaking or liquefaction, by finite elements: other ground is taken as "
            "too strong to fail, because failures there come first."
        )
