"""Finds the strength of some strata with which the ground just stands under its weight."""

from collections.abc import Collection

from fem.search.strength_reduction import safety_factor
from fem.settings import FemSettings
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section

# Largest difference of the factor of safety from 1, largest number of factors of safety computed, and the largest
# multiple of the strength that is tried.
FACTOR_TOLERANCE, MOST_TRIALS, LARGEST_MULTIPLE = 0.005, 6, 100.0


def required_multiple(
    section: Section, numbers: Collection[int], mesh: QuadMesh, settings: FemSettings, factor: float
) -> float:
    """Return the multiple of the cohesion of some strata with which the factor of safety is 1 at Kh = 0.

    The factor of safety F is a concave function of the multiple m, since every mechanism has a factor linear in m and
    F is the least of them. Two factors below 1 therefore give a multiple that is not too large: by the line through
    them F would be 1, or is less. This holds for cohesion without friction, and for associated flow.

    Parameters
    ----------
    section : section whose factor of safety is below 1
    numbers : numbers of the strata whose cohesion is multiplied
    mesh : mesh of the section
    settings : settings of the finite elements, with associated flow
    factor : factor of safety of ``section`` on this mesh (-), below 1

    Returns
    -------
    The multiple (-), above 1.

    Raises
    ------
    NoAnswerError
        If no multiple up to 100 makes the ground stand, since it fails elsewhere, or if the finite elements have no
        answer.
    """
    before, at = (1.0, factor), 1.0 / factor  # all strengths over F: just enough, and more than these strata alone need
    for _ in range(MOST_TRIALS):
        safety = safety_factor(with_multiple(section, numbers, at), mesh, settings, 0.0)
        if safety.verdict == "undecided":
            break
        reduced = safety.factor
        if abs(reduced - 1.0) <= FACTOR_TOLERANCE:
            return at
        rise = (reduced - before[1]) / (at - before[0])
        if rise <= 0.0:
            break
        before, at = (at, reduced), at + (1.0 - reduced) / rise
        if at > LARGEST_MULTIPLE:
            break
    raise NoAnswerError("no strength of these strata alone makes the ground stand, or the search did not converge")


def with_multiple(section: Section, numbers: Collection[int], multiple: float) -> Section:
    """Return the section with a multiple of the cohesion of some strata.

    Parameters
    ----------
    section : the ground
    numbers : numbers of the strata
    multiple : factor on their cohesion at every place (-)

    Returns
    -------
    The section.
    """
    strata = list(section.strata)
    for k in numbers:
        strata[k] = strata[k].with_multiple_of_cohesion(multiple)
    return section.with_strata(strata)
