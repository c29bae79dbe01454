"""Represents a cohesion that varies within a stratum by many soils of constant cohesion."""

import numpy as np

from fem.continuum.plane_strain import PlaneStrain
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section, Stratum

# Number of levels by which a varying cohesion of a stratum is represented, and the lowest level over the highest.
# Levels differ by a constant factor, since at a bare cut the smallest cohesions matter as much as the large ones.
COHESION_LEVELS, LOWEST_COHESION_RATIO = 512, 1e-3


def cohesion_levels(section: Section, mesh: QuadMesh) -> list[Stratum]:
    """Return soils of constant cohesion for every stratum whose cohesion varies.

    Parameters
    ----------
    section : the ground with its field of cohesion
    mesh : a mesh of the section

    Returns
    -------
    ``COHESION_LEVELS`` soils for each such stratum, from the smallest to the largest cohesion in it.
    """
    field, strata = section.cohesion_field, []
    corners = mesh.points[mesh.cells]
    for k in np.flatnonzero(field.varies):
        # A thin layer of a free mesh may have no cell: its points lie in cells of its neighbours.
        points, near = corners.reshape(-1, 2), np.repeat(corners.mean(axis=1), corners.shape[1], axis=0)
        in_stratum = np.repeat(mesh.stratum == k, corners.shape[1]) if (mesh.stratum == k).any() else slice(None)
        cohesion = field.at(points[in_stratum], near[in_stratum], np.full(len(points[in_stratum]), k))
        largest_cohesion = max(float(cohesion.max()), 1e-9)  # Pa
        bins = np.linspace(
            0.0,
            np.log(max(float(cohesion.min()), LOWEST_COHESION_RATIO * largest_cohesion) / largest_cohesion),
            COHESION_LEVELS,
        )[::-1]
        strata += [section.strata[k].with_cohesion(float(c)) for c in largest_cohesion * np.exp(bins)]
    return strata


def assign_levels(problem: PlaneStrain, section: Section, first: int) -> None:
    """Assign the soil of the nearest cohesion to every quadrature point of strata whose cohesion varies.

    Parameters
    ----------
    problem : the elements, whose ``material`` is changed
    section : the ground with its field of cohesion
    first : number, in the strata of the problem, of the first of the soils that `cohesion_levels` returned
    """
    field, points = section.cohesion_field, problem.points()
    for k in np.flatnonzero(field.varies):
        in_stratum = problem.material == k
        cohesion = field.at(points[in_stratum], points[in_stratum], np.full(int(in_stratum.sum()), k))
        levels = np.array([soil.cohesion for soil in problem.strata[first : first + COHESION_LEVELS]])
        problem.material[in_stratum] = first + np.searchsorted(0.5 * (levels[1:] + levels[:-1]), cohesion)
        first += COHESION_LEVELS
