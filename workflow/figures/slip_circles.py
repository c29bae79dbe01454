"""Draws the critical slip circles over the layers."""

import numpy as np

from meshes.section.section import Section
from workflow.figures.canvas import CONTINUUM, CRITICAL, Sheet
from workflow.figures.ground import Overlay, section_sheet
from workflow.results.slices import CirclePart, SlicesAnswer

WHOLE, DASHED = (0, ()), (0, (5, 2))


def circles_sheet(section: Section, answer: SlicesAnswer) -> Sheet:
    """Draw the critical slip circles of the section over its layers.

    Parameters
    ----------
    section : the ground
    answer : slip circles by Bishop's and Spencer's method

    Returns
    -------
    The picture: towards each side the circle with the least factor of safety at Kh = 0, and the
    circle with the least critical Kh.
    """
    lines = [
        _line(circle, CONTINUUM, f"F_s = {_value(circle, 2)} at Kh = {factors.kh:g}")
        for factors in answer.factors[:1]
        for circle in factors.circles
    ]
    lines += [_line(circle, CRITICAL, f"critical Kh = {_value(circle, 3)}") for circle in answer.critical]
    return section_sheet(section, "slip circles by Bishop's method (Spencer's in brackets)", lines)


def _line(circle: CirclePart, colour: str, words: str) -> Overlay:
    dashes = WHOLE if circle.towards == "left" else DASHED
    return Overlay(np.array(circle.surface_m), colour, dashes, f"{words}, to the {circle.towards}")


def _value(circle: CirclePart, digits: int) -> str:
    return f"{circle.bishop:.{digits}f}" + ("" if circle.spencer is None else f" ({circle.spencer:.{digits}f})")
