"""Computes the critical Kh and factor of safety of ground with strong zones, by limit analysis on adapted meshes."""

from dataclasses import dataclass

import numpy as np

from fem.continuum.fields import sliding_sides
from fem.continuum.loads import direction_of, sign_of
from fem.search.adaptive import AdaptiveSearch
from fem.search.slip_surface import moving_ground, slip_surface
from fem.settings import FemSettings
from meshes.errors import NoAnswerError
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings


@dataclass(frozen=True, eq=False)
class FaceLimit:
    """Holds a critical Kh or a factor of safety of ground with strong zones.

    Attributes
    ----------
    value : critical Kh, or factor of safety, with ψ = φ (-)
    davis : Davis's estimate of the same quantity (-); None without an answer
    surface (n, 2) : the slip surface with ψ = φ (m)
    sides : sides to which the ground slides, -1 for left and 1 for right; the side of the lower end of the slip surface
        if there are none
    extent : x (m) of both ends of the ground surface that moves; None if it is not known
    """

    value: float
    davis: float | None
    surface: np.ndarray
    sides: tuple[int, ...] = ()
    extent: tuple[float, float] | None = None

    def moving(self, section: Section) -> np.ndarray:
        """Return the slip surface (n, 2) in m or, where spreading ground has none, both ends of the ground surface of
        the ``section`` that moves; empty without any."""
        if len(self.surface) or self.extent is None:
            return self.surface
        return np.column_stack([self.extent, np.interp(self.extent, *section.ground.T)])


def critical_of_face(section: Section, meshing: MeshSettings, settings: FemSettings, direction: str) -> FaceLimit:
    """Find the critical Kh of ground with strong zones, in one direction.

    Parameters
    ----------
    section : the ground with its strong zones
    meshing : settings of the meshes
    settings : sides, accuracy and number of cells
    direction : direction of the seismic force, "downhill" or "uphill"

    Returns
    -------
    The critical Kh with ψ = φ, Davis's estimate of it, and the ground that moves.

    Raises
    ------
    NoAnswerError
        If there is no failure up to ``kh_limit``, or no answer on the first mesh.
    """
    search = AdaptiveSearch(section, meshing, generate(section, meshing))
    full = settings.changed(direction=direction, flow="associated")
    result = search.critical(full)
    if result.result.mechanism is None:
        raise NoAnswerError(f"no failure up to Kh = {settings.kh_limit:g}")
    try:
        davis = search.with_davis(result, full)[1].result.kc
    except NoAnswerError:
        davis = None
    mechanism, sides = result.result.mechanism, (sign_of(section, direction_of(full)),)
    extent = moving_ground(result.mesh, mechanism)
    return FaceLimit(result.result.kc, davis, slip_surface(result.mesh, mechanism), sides, extent)


def safety_of_face(section: Section, meshing: MeshSettings, settings: FemSettings) -> FaceLimit:
    """Find the factor of safety of ground with strong zones, without shaking.

    Parameters
    ----------
    section, meshing, settings : as in `critical_of_face`

    Returns
    -------
    The factor with ψ = φ, Davis's estimate of it, and the ground that moves.

    Raises
    ------
    NoAnswerError
        If there is no mechanism, or no answer on the first mesh.
    """
    search = AdaptiveSearch(section, meshing, generate(section, meshing))
    full = settings.changed(flow="associated")
    result = search.safety(full, 0.0)
    if result.result.mechanism is None:
        raise NoAnswerError("the finite elements have no factor of safety")
    try:
        davis = search.safety_by_other_rule(result, full.changed(flow="davis"), 0.0)
    except NoAnswerError:
        davis = None
    mechanism = result.result.mechanism
    sides = sliding_sides(result.mesh, mechanism)
    extent = moving_ground(result.mesh, mechanism)
    return FaceLimit(result.result.factor, davis, slip_surface(result.mesh, mechanism), sides, extent)
