"""Finds faces of cohesionless ground that fail under their own weight."""

from collections.abc import Iterator

import numpy as np

from fem.continuum.shallow_failure import ShallowFailure, faces_at, merged_faces
from fem.settings import FemSettings
from meshes.section.cutting import BELOW_WATER
from meshes.section.section import Section


def falling_faces(section: Section, settings: FemSettings) -> Iterator[str]:
    """Yield a sentence on every cohesionless face that slides by its weight and its water alone, in closed form
    (infinite slope, see `fem.continuum.shallow_failure`), and on every vertical wall without cohesion, at whose edge
    no stress balances the weight. ``settings``: settings of the finite elements.
    """
    yield from _walls(section)
    for face in merged_faces(faces_at(section, settings, 0.0)):
        if face.kh < 0.0:
            yield _sentence(section, face)


def _sentence(section: Section, face: ShallowFailure) -> str:
    soil = next(stratum for stratum in section.strata if stratum.name == face.stratum)
    friction, slope = np.degrees(soil.friction_angle), np.degrees(face.angle)
    cause = "" if slope > friction else ", and water that flows out of it"
    return (
        f'the bare face of "{face.stratum.removesuffix(BELOW_WATER)}" from x = {face.start:.4g} to {face.end:.4g} m '
        f"cannot stand by itself: its slope is {slope:.0f}°{cause}, its friction angle {friction:.0f}°, its cohesion "
        "0; all results are for failures below it: give it the cohesion that holds it, or a flatter slope"
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
                    f'the bare wall of "{soil.name.removesuffix(BELOW_WATER)}" at x = {x:.4g} m, from elevation '
                    f"{lowest:.4g} to {top:.4g} m, cannot stand by itself: it is vertical, and its cohesion is 0: give "
                    "it the cohesion or the support that holds it, or a slope"
                )
