"""Finds faces of cohesionless ground that fail under their own weight."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from fem.continuum.shallow_failure import ShallowFailure, faces_at, merged_faces
from fem.settings import FemSettings
from meshes.section.cutting import BELOW_WATER, whole_soil
from meshes.section.section import Section
from meshes.section.sentences import coordinate


def falling_faces(section: Section, settings: FemSettings) -> Iterator[str]:
    """Yield a sentence on every cohesionless face that slides by its weight and its water alone, in closed form
    (infinite slope, see `fem.continuum.shallow_failure`), and on every vertical wall without cohesion, at whose edge
    no stress balances the weight. ``settings``: settings of the finite elements.
    """
    yield from _walls(section)
    faces = merged_faces(faces_at(section, settings, 0.0))
    yield from (_sentence(section, face) for face in joined_slopes(faces))


def joined_slopes(faces: Iterable[ShallowFailure]) -> list[ShallowFailure]:
    """Return the faces that fail by their weight, from left to right. Neighbouring parts of one slope of a stratum,
    above and below the water or from which water flows at different gradients, are one face."""
    joined: list[ShallowFailure] = []
    for face in faces:
        last = joined[-1] if joined else None
        if face.kh >= 0.0:
            continue
        goes_on = last is not None and last.end == face.start and math.isclose(last.angle, face.angle)
        if last is not None and goes_on and whole_soil(last.stratum) == whole_soil(face.stratum):
            joined[-1] = replace(last, end=face.end)
        else:
            joined.append(face)
    return joined


def _sentence(section: Section, face: ShallowFailure) -> str:
    soil = next(stratum for stratum in section.strata if stratum.name == face.stratum)
    friction, slope = np.degrees(soil.friction_angle), np.degrees(face.angle)
    cause = "" if slope > friction else ", and water that flows out of it"
    return (
        f'the bare face of "{whole_soil(face.stratum)}" from x = {coordinate(face.start)} to '
        f"{coordinate(face.end)} m cannot stand by itself: its slope is {slope:.0f}°{cause}, its friction angle "
        f"{friction:.0f}°, its cohesion 0; all results are for failures below it: give it the cohesion that holds it, "
        "or a flatter slope"
    )


def _walls(section: Section) -> Iterator[str]:
    """Yield a sentence on the part of every cohesionless stratum in a vertical step of the ground surface."""
    layers = section.layering
    for x, left, right in zip(layers.x[1:-1], layers.right[:-1], layers.left[1:], strict=True):
        behind, low = (left, right[0]) if left[0] > right[0] else (right, left[0])
        for soil, top, bottom in zip(section.strata, behind[:-1], behind[1:], strict=True):
            lowest = max(float(bottom), float(low))
            if float(top) - lowest > layers.tolerance and not soil.has_cohesion:
                yield (
                    f'the bare wall of "{soil.name.removesuffix(BELOW_WATER)}" at x = {coordinate(x)} m, from '
                    f"elevation {coordinate(lowest)} to {coordinate(top)} m, cannot stand by itself: it is vertical, "
                    "and its cohesion is 0: give it the cohesion or the support that holds it, or a slope"
                )
