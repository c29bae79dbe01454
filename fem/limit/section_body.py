"""Returns a section as a problem of limit analysis: strengths, forces, pore pressure and sides."""

import numpy as np

from fem.continuum.loads import seismic_sign
from fem.continuum.strength import davis_factors, strengths, tensile_strengths
from fem.limit.limit_problem import CornerCohesion, EdgeTraction, Places, RigidPlasticBody, Side
from fem.limit.side_stress import SideStress, side_stresses
from fem.settings import FemSettings
from meshes.pore_loads import Pressure
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.water_pressure import WaterPressure
from meshes.triangles import TriMesh


def body_of(
    section: Section,
    mesh: TriMesh,
    fem: FemSettings,
    davis: bool = False,
    excess_pressure: bool = True,
    smooth_sides: bool = False,
) -> RigidPlasticBody:
    """Return the section as a problem of limit analysis whose multiplier is Kh; the strength is that of the strata, or
    Davis's estimate.

    Excess pore pressure by shaking acts with ``excess_pressure``. Smooth sides have no normal velocity and no shear
    traction. Free-field sides carry the K0 stress and move horizontally; with ``smooth_sides`` free-field sides are
    treated as smooth sides. ``mesh``: triangles of the section; ``fem``: sides and direction of the seismic force;
    ``davis``: whether strengths are those of Davis's estimate.
    """
    cohesion, friction = strengths(section.strata, davis)
    ordinary = GRAVITY * np.array([s.density_ordinary for s in section.strata])
    seismic = GRAVITY * np.array([s.density_seismic for s in section.strata])
    zeros = np.zeros(len(ordinary))
    water = section.water_pressure
    sides = {
        "surface": _ground(section, seismic_sign(section, fem)),
        **dict.fromkeys(("base", "left", "right"), Side("xy")),
    }
    if fem.sides == "periodic":
        sides |= dict.fromkeys(("left", "right"), Side(periodic=True))
    elif fem.sides == "smooth" or (fem.sides == "free-field" and smooth_sides):
        sides |= {"left": Side("x"), "right": Side("x")}
    elif fem.sides == "free-field":
        # The effective horizontal stress of level ground falls with the vertical one when shaking adds to the pressure.
        at_sides = section.after_shaking() if excess_pressure and water.rises_by_shaking else section
        pores = at_sides.water_pressure
        for name, stress in side_stresses(at_sides, mesh).items():
            pressing = _pressure_traction(stress, -1.0 if name == "left" else 1.0)
            sides[name] = Side("y", dead=pressing, pressure=lambda at: pores.at_rest(at.points, at.middles, at.stratum))
    return RigidPlasticBody(
        cohesion=cohesion,
        friction=friction,
        dead_force=np.column_stack([zeros, fem.vertical * seismic - ordinary]),
        live_force=np.column_stack([seismic_sign(section, fem) * seismic, zeros]),
        sides=sides,
        pore_pressure=_pore_pressure(water, excess_pressure) if water.present else None,
        varying=_varying_cohesion(section, davis) if section.cohesion_field.varies.any() else None,
        tension=tensile_strengths(section.strata),
    )


def _pore_pressure(water: WaterPressure, excess_pressure: bool) -> Pressure:
    if not excess_pressure:
        return water.at_rest
    return lambda *places: water.at_rest(*places) + water.excess(*places)


def _varying_cohesion(section: Section, davis: bool) -> CornerCohesion:
    """Return the cohesion at corners of triangles for strata whose cohesion varies, reduced by Davis's factor if
    ``davis``."""
    field = section.cohesion_field
    factor = davis_factors(section.strata) if davis else np.ones(len(section.strata))

    def cohesion(mesh: TriMesh, above: bool) -> np.ndarray:
        corners = mesh.points[mesh.cells]
        return field.corners(corners, mesh.stratum, above) * factor[mesh.stratum][:, None]

    return cohesion


def _ground(section: Section, sign: int) -> Side:
    """Return the ground surface with its loads and the water on it."""
    water, loads = section.water_pressure, section.surface_loads
    if not (water.present or loads.present):
        return Side()
    return Side(
        dead=lambda at: loads.dead(at.points, at.middles, at.normal),
        live=lambda at: loads.seismic(sign, at.points, at.middles, at.normal),
        pressure=lambda at: water.on_ground(at.points, at.middles),
    )


def _pressure_traction(stress: SideStress, outwards: float) -> EdgeTraction:
    def traction(at: Places) -> np.ndarray:
        return np.column_stack([outwards * stress.at(at.points[:, 1], at.stratum), np.zeros(len(at.points))])

    return traction
