"""Strict lower and upper bound of the critical seismic coefficient of a section, by limit analysis.

The flow rule is associated, ψ = φ; the upper bound holds for every smaller ψ, too (Radenkovic 1961). Where ψ < φ, the
substitute of Davis (1968) has c and tan φ times cos ψ cos φ / (1 - sin ψ sin φ), and associated flow: its bounds
are as strict, and judge the finite elements with that substitute.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem.errors import UnstableError
from fem.limit.adaptive_bounds import Bracket, Limits, Observer, bracket, proven_upper_bound
from fem.limit.limit_problem import Places, RigidPlasticBody, Side, Traction, limit_problem, units_of
from fem.limit.side_stress import SideStress, side_stresses
from fem.loads import lifted, push, soils
from fem.repetition import refuse_other_sides
from fem.settings import BoundsSettings, FemSettings
from fem.skin import Skin, skins, strengthened
from fem.strength import davis_factor, flow_of, is_dilating_fully, tensile_strengths
from meshes.errors import InputError
from meshes.pore_loads import Pressure
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section, Stratum
from meshes.section.water_pressure import WaterPressure
from meshes.triangles import TriMesh, triangulate

# Cells in the height of the section to start from, and in the thickness of a layer.
CELLS_IN_HEIGHT, CELLS_IN_LAYER = 5.0, 0.8
# The first mesh has at most this share of the cells allowed.
FIRST_SHARE = 0.15
# Cells allowed where a rough upper bound will do; the first mesh has a share of it.
COARSE_CELLS = 8000


@dataclass(frozen=True, eq=False)
class KhBounds(Bracket):
    """Bounds of the critical Kh with ψ = φ, and what else was found on the way.

    Attributes
    ----------
    skins : tuple of Skin
        Cohesionless faces whose grains roll down at a smaller Kh than the bounds are for. Where there is one, the
        ground below all such faces was strengthened down to the least depth, as it is in the finite elements, and the
        bounds are those of the slope as a whole: strict for the ground so strengthened. Without any they are strict for
        the ground as it is given.
    section : Section
        What was analysed: the section, or that with its faces strengthened.
    substitute : Bracket or None
        Bounds of Davis's substitute, where ψ < φ and it was asked for; from the last mesh of those for ψ = φ.
    """

    skins: tuple[Skin, ...] = ()
    section: Section | None = None
    substitute: Bracket | None = None


def kh_bounds(
    section: Section, fem: FemSettings, settings: BoundsSettings, observer: Observer | None = None
) -> KhBounds:
    """Lower and upper bound of Kh. Sides, direction and vertical coefficient are those of the finite elements.

    Raises InputError if the section lacks what the analysis needs or its sides are tied and differ, UnstableError if it
    is proven to fail whatever the push, BadMeshError if there are no triangles.
    """
    strata = soils(section, fem)
    if all(s.density_seismic == 0.0 for s in strata):
        raise InputError(section.name, ["density_seismic is 0 in all strata: there is nothing to accelerate"])
    limits = Limits(settings.gap, settings.max_cells, settings.seconds, enough=0.0)

    def bounds_of(ground: Section) -> Bracket:
        mesh = first_mesh(ground, settings.max_cells, fem.sides == "tied")
        return bracket(mesh, body_of(ground, mesh, fem), limits, observer)

    govern = governing_skins(section, fem)
    whole = strengthened(section, skins(section, fem), fem) if govern else section
    found = bounds_of(whole)
    govern = [face for face in govern if face.kh < found.upper]
    if whole is not section and not govern:  # what coarse triangles bore too much decides: no face needs strength
        whole, found = section, bounds_of(section)
    if found.upper < 0.0 and section.uplift is not None:
        raise lifted(section.uplift, "the section fails under its own weight")
    if found.upper < 0.0:
        raise UnstableError(
            f"the section fails under its own weight: its Kh is at most {found.upper:.3g}; check strengths, densities"
        )
    substitute = None
    davis = flow_of(section.strata, fem.flow) != "associated" if settings.davis == "auto" else settings.davis
    if davis and not is_dilating_fully(strata):
        substitute = bracket(found.mesh, body_of(whole, found.mesh, fem, davis=True), limits, observer)
    return KhBounds(**vars(found), skins=tuple(govern), section=whole, substitute=substitute)


def governing_skins(section: Section, fem: FemSettings, davis: bool = False) -> list[Skin]:
    """The cohesionless faces whose grains roll down at a smaller Kh than the slope as a whole fails at.

    They are compared with an upper bound on one coarse mesh, of the section and then of the section with these faces
    strengthened, so that they may be a few too many, and none is missing. Raises what ``first_mesh`` raises.
    """
    faces = skins(section, fem, strengths(section.strata, davis)[1])
    if faces:
        upper = _coarse_upper_bound(section, fem, davis)
        faces = [face for face in faces if face.kh < upper]
    if faces:
        upper = _coarse_upper_bound(strengthened(section, faces, fem), fem, davis)
        faces = [face for face in faces if face.kh < upper]
    return faces


def _coarse_upper_bound(section: Section, fem: FemSettings, davis: bool) -> float:
    """An upper bound of Kh on one coarse mesh, inf if there is none."""
    mesh = first_mesh(section, COARSE_CELLS, fem.sides == "tied")
    body = body_of(section, mesh, fem, davis)
    _, _, mechanism = proven_upper_bound(limit_problem(mesh, body, units_of(mesh, body)))
    return mechanism.multiplier if mechanism else np.inf


def first_mesh(section: Section, max_cells: int, repeats: bool = False) -> TriMesh:
    """Triangles about as large as the layers are thick, fewer where that would be too many; with the same edges on both
    sides of a section that ``repeats``; raises InputError if these differ."""
    if repeats:
        refuse_other_sides(section)
    layers = section.layering
    areas = layers.areas()
    across = (layers.present() * layers.width[:, None]).sum(axis=0)
    height = float(np.ptp(section.outline()[:, 1]))
    sizes = np.minimum(areas / across / CELLS_IN_LAYER, height / CELLS_IN_HEIGHT)
    expected = float((areas / (0.43 * sizes**2)).sum())
    sizes *= max(1.0, np.sqrt(expected / (FIRST_SHARE * max_cells)))
    return triangulate(
        section, float(sizes.max()), {s.name: float(h) for s, h in zip(section.strata, sizes, strict=True)}, repeats
    )


def body_of(
    section: Section, mesh: TriMesh, fem: FemSettings, davis: bool = False, shaken: bool = True, held: bool = False
) -> RigidPlasticBody:
    """The section, or its substitute of Davis, as a problem of limit analysis whose multiplier is Kh.

    The pore pressure that shaking adds is there if the ground is ``shaken``. Sides that are not fixed bear the K0
    stress and move; ``held``, they move up and down alone.
    """
    cohesion, friction = strengths(section.strata, davis)
    growth = np.array([s.cohesion_increase for s in section.strata])
    if davis:
        growth = growth * davis_factors(section.strata)
    ordinary = GRAVITY * np.array([s.density_ordinary for s in section.strata])
    seismic = GRAVITY * np.array([s.density_seismic for s in section.strata])
    nothing = np.zeros(len(ordinary))
    water = section.water_pressure
    sides = {"surface": _ground(section, push(section, fem)), **dict.fromkeys(("base", "left", "right"), Side("xy"))}
    if fem.sides == "tied":
        sides |= dict.fromkeys(("left", "right"), Side(tied=True))
    elif fem.sides == "roller" and held:
        sides |= {"left": Side("x"), "right": Side("x")}
    elif fem.sides == "roller":
        for name, stress in side_stresses(section, mesh).items():
            # The total stress stays when shaking adds to the pore pressure.
            pressing = _pressing(stress, -1.0 if name == "left" else 1.0)
            sides[name] = Side("y", dead=pressing, pressure=lambda at: water.at_rest(at.points, at.near, at.stratum))
    return RigidPlasticBody(
        cohesion=cohesion,
        friction=friction,
        dead_force=np.column_stack([nothing, fem.vertical * seismic - ordinary]),
        live_force=np.column_stack([push(section, fem) * seismic, nothing]),
        sides=sides,
        pore_pressure=_pore_pressure(water, shaken) if water.present else None,
        growth=growth if growth.any() else None,
        tension=tensile_strengths(section.strata),
    )


def _pore_pressure(water: WaterPressure, shaken: bool) -> Pressure:
    if not shaken:
        return water.at_rest
    return lambda *places: water.at_rest(*places) + water.shaken(*places)


def _ground(section: Section, sign: int) -> Side:
    """The ground with what stands on it."""
    water, loads = section.water_pressure, section.surface_loads
    if not (water.present or loads.present):
        return Side()
    return Side(
        dead=lambda at: loads.dead(at.points, at.near, at.normal),
        live=lambda at: loads.shaken(sign, at.points, at.near, at.normal),
        pressure=lambda at: water.on_ground(at.points, at.near),
    )


def _pressing(stress: SideStress, outwards: float) -> Traction:
    def traction(at: Places) -> np.ndarray:
        return np.column_stack([outwards * stress.at(at.points[:, 1], at.stratum), np.zeros(len(at.points))])

    return traction


def strengths(strata: Sequence[Stratum], davis: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Cohesion (Pa), at elevation 0 where it grows with depth, and friction angle (rad) of the strata, reduced by
    Davis's factor if asked for."""
    cohesion = np.array([s.cohesion_at(0.0) for s in strata])
    friction = np.array([s.friction_angle for s in strata])
    if not davis:
        return cohesion, friction
    factor = davis_factors(strata)
    return factor * cohesion, np.arctan(factor * np.tan(friction))


def davis_factors(strata: Sequence[Stratum]) -> np.ndarray:
    """Davis's β (strata,) of the strata as they are given."""
    friction = np.array([s.friction_angle for s in strata])
    return davis_factor(friction, np.array([s.dilation for s in strata]))
