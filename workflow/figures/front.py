"""Draws the picture of the first page of the report: the section, its slip surface, and the surface after the largest
slide.
"""

from collections.abc import Iterator

import numpy as np

from workflow.figures.canvas import CRITICAL, DISCS, Sheet
from workflow.figures.ground import Boring, Overlay, section_sheet
from workflow.figures.slides import seen_from_above
from workflow.results.cases import CaseAnswer, equal_cases, smoothed
from workflow.results.governing import faces_with_bounds, governing_kh, slides_by_weight, value_of_face
from workflow.results.lengths import metres
from workflow.results.results import Results

FRONT = "figures/front.png"
SAME_KH_RATIO = 1.02  # times the critical Kh of the section: a face up to here fails with it


def front(results: Results) -> Sheet | None:
    """Draw the section with slip surface, largest slide, borings and the seismic force; return None without any of
    them."""
    lines: list[Overlay] = []
    governing = governing_kh(results)
    if governing is not None and len(results.slip_surface):
        label = f"slip surface at Kh {governing.sign} {governing.value:.3f}"
        lines.append(Overlay(results.slip_surface, CRITICAL, (0, ()), label))
    if results.failure is not None and results.failure.slip_surface:
        label = f"slip surface, F_s = {results.failure.factor:.2f} at Kh = 0"
        lines.append(Overlay(np.array(results.failure.slip_surface), CRITICAL, (0, ()), label))
    lines += _of_structure(results, 0.0 if governing is None else governing.value)
    slides = slides_by_weight(results)
    number, case = slides[0].of_largest if slides else (0, None)
    if case is not None:
        numbers = next(group for group in equal_cases(slides[0].cases) if number in group)
        called = f"case{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"
        after, by = case.surfaces[1], "material points"
        if isinstance(case, CaseAnswer) and results.dem is not None:
            after, by = smoothed(after, 2.0 * results.dem.model.radius_m), "discs"
        elif results.mpm is not None:
            after = seen_from_above(after, results.mpm.cell_m)
        label = f"surface after the slide by {by}, {called}: {metres(case.slide_max_m)}"
        lines.append(Overlay(after, DISCS, (0, ()), label))
    if not lines and results.fem is None:
        return None
    subject = "failure" if case is None else "failure and slide"
    borings = list(_tested_borings(results))
    force = None if results.fem is None else results.fem.towards
    return section_sheet(results.config.section, subject, lines, borings, force)


def _of_structure(results: Results, kh: float) -> Iterator[Overlay]:
    """Yield the slip surface of the face that slides first with a crest, unless it is also the slip surface of the
    section at ``kh``. A face without a value by finite elements has its slip circle."""
    bounded = faces_with_bounds(results)
    if bounded is None:
        return
    circles = {(part.structure, part.towards): part.critical
               for part in (results.slices.faces if results.slices is not None else ())}  # fmt: skip
    elements = {(face.structure, face.towards): face.critical for face in bounded.faces}
    values = []
    for key in dict.fromkeys((*circles, *elements)):
        circle, value = circles.get(key), elements.get(key)
        kc, by_elements = value_of_face(value, None if circle is None else circle.bishop)
        surface = (
            value.slip_surface if by_elements and value is not None else () if circle is None else circle.surface_m
        )
        if kc is not None:
            values.append((kc, key, "slip surface" if by_elements else "slip circle", surface))
    if not values:
        return
    least, (structure, towards), kind, surface = min(values, key=lambda item: item[0])
    if len(surface) and least > SAME_KH_RATIO * kh:
        label = f"{structure}, towards the {towards}: {kind} at Kh = {least:.3f}"
        yield Overlay(np.array(surface), CRITICAL, (0, (4, 2)), label)


def _tested_borings(results: Results) -> Iterator[Boring]:
    """Yield the name, x (m) and deepest test (m) of every boring by which liquefaction was judged."""
    for boring in results.triggering.borings if results.triggering is not None else ():
        tests = [test for test in results.triggering.tests if test.boring == boring.name] if results.triggering else []
        yield boring.name, tests[0].x_m, max(test.depth_m for test in tests)
