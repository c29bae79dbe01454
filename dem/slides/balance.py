"""Checks a slide: lost ground, discs that pass through the box, and discs near its sides.

Areas are volumes per metre out of plane (m2).
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from dem.engine.checks import BALANCE
from dem.engine.energy_balance import EnergyBalance
from dem.ground import Ground
from dem.model import DiscModel
from dem.slides.surface import Surface
from dem.slides.volume import shortening
from meshes.section.cutting import shown_name
from meshes.section.sentences import counted

AREA_TOLERANCE = 0.01  # of the area, above the prescribed loss
PENETRATION = 1.0  # mean radii of overlap with a fixed disc, so that the centre of one disc lies inside the other
SIDE_DISTANCE = 2.0  # diameters from a side
PILED_RISE = 2.0  # mean radii that the surface at a side rises
DRIFT_TOLERANCE = 0.25  # diameters: level ground that liquefies drifts by 0.05 to 0.2 (discs of 1.26 and 0.63 m radius)
# Smallest step over the requested one; the step is halved and the slide restarted if the energy does not balance.
LEAST_STEP = 0.25
REPORTED_IMBALANCE = 0.01  # of the energy exchanged, above which it is reported
# Largest imbalance over the energy exchanged with the smallest step, since clay in fast flow collides.
IMBALANCE_TOLERANCE = 5e-3
STOPPED_SHARE = 0.5  # of the largest slide: ground at a side that has slid as far was stopped by the side


def ground_area(model: DiscModel, ground: Ground) -> float:
    """Return the area of the ground: below the surface of the discs, above the lowest disc, between the outermost
    discs.

    Between the side and the top disc of the first column the surface is taken as level.
    """
    x, z = Surface.of(model, ground).points(model, ground).T
    free_x, free_z = ground.to_section(model.x[~model.fixed], model.z[~model.fixed])
    x = np.concatenate([[free_x.min()], x, [free_x.max()]])
    z = np.concatenate([z[:1], z, z[-1:]]) - free_z.min()
    return float(np.sum(0.5 * (z[1:] + z[:-1]) * np.diff(x)))


def disc_area(model: DiscModel, strata: Sequence[int] | None = None) -> float:
    """Return the area of the free discs, of all strata or of some."""
    free = ~model.fixed if strata is None else np.isin(model.layer, strata) & ~model.fixed
    return float(np.sum(np.pi * model.radius[free] ** 2))


def expected_loss(
    start: DiscModel, model: DiscModel, strata: Sequence[int], area: float, drained: Mapping[int, float]
) -> float:
    """Return the expected decrease of the ground's area (m2), by drainage and by softer springs of strata.

    drained: drained share of the volume, by stratum. Springs that shorten by a share of the distance of two discs
    reduce the area of their stratum by twice this share. start, model: discs at the start and now; strata: numbers of
    the softened strata; area: area of the ground (m2).
    """
    discs = disc_area(start)
    gone = sum(share * disc_area(start, [k]) for k, share in drained.items())
    gave_way = 2.0 * (shortening(model, strata) - shortening(start, strata)) * disc_area(start, strata)
    return (gone + max(0.0, gave_way)) * area / discs


def pressed_through(model: DiscModel) -> int:
    """Return the number of free discs that overlap fixed discs by more than a mean radius, so that the box no longer
    retains them.
    """
    i, j = model.pair_i, model.pair_j
    wall = model.fixed[i] != model.fixed[j]
    over = model.radius[i] + model.radius[j] - model.distance()
    deep = wall & (over > PENETRATION * 0.5 * (model.radius[i] + model.radius[j]))
    moving = np.where(model.fixed[i[deep]], j[deep], i[deep])
    return len(np.unique(moving))


def energy_tolerance(step_share: float) -> float:
    """Return the share of the exchanged energy that may be unaccounted for. The share is larger if the time step was
    shortened to `LEAST_STEP` of the requested one or less.
    """
    return IMBALANCE_TOLERANCE if step_share <= LEAST_STEP else BALANCE


def on_energy(energies: EnergyBalance) -> list[str]:
    """Return a note on energy that is unaccounted for; empty if it is less than a hundredth of the exchanged energy."""
    share = abs(energies.gap) / energies.turnover if energies.turnover > 0.0 else 0.0
    if share <= REPORTED_IMBALANCE:
        return []
    return [f"{100.0 * share:.2g} % of the energy that the discs exchanged is unaccounted for"]


def on_pressed_through(model: DiscModel) -> list[str]:
    """Return a note on discs that the box no longer retains; empty if there are none."""
    through = pressed_through(model)
    if through == 0:
        return []
    return [
        f"{counted(through, 'disc overlaps', 'discs overlap')} the fixed ones at the sides or the base by more than a "
        "radius: the box no longer retains such discs, since their layer is too soft for discs of this size"
    ]


def deepest_overlap(model: DiscModel) -> float:
    """Return the largest overlap of two free discs, over their mean radius; contacts that fade by liquefaction do not
    count."""
    i, j = model.pair_i, model.pair_j
    inside = ~model.fixed[i] & ~model.fixed[j] & ~model.fading
    mean = 0.5 * (model.radius[i] + model.radius[j])
    return float(np.max(((2.0 * mean - model.distance()) / mean)[inside], initial=0.0))


class SideEffect(NamedTuple):
    """Describes how a side of the box affects a slide.

    Attributes
    ----------
    name : "left" or "right"
    discs_near : number of surface discs that slid to within `SIDE_DISTANCE` diameters of the side
    slide_share : largest slide of these discs, over the largest slide of the surface
    rise : rise of the surface at the side (m)
    piled : whether ground has piled up at the side
    """

    name: str
    discs_near: int
    slide_share: float
    rise: float
    piled: bool


def both_sides(model: DiscModel, start: DiscModel, ground: Ground) -> list[SideEffect]:
    """Return how each side of the box affects a slide from `start` to `model`; empty for periodic ground."""
    if model.period is not None:
        return []
    before, after = (Surface.of(m, ground).points(m, ground) for m in (start, model))
    surface = Surface.of(start, ground)
    slide = np.abs(surface.movement(model, ground)[0])
    x_of_surface = ground.to_section(model.x[surface.discs], model.z[surface.discs])[0]
    reach = SIDE_DISTANCE * 2.0 * ground.radius
    sides = []
    for name, side in (("left", before[0, 0]), ("right", before[-1, 0])):
        came = (np.abs(x_of_surface - side) < reach) & (np.abs(surface.x - side) >= reach) & (slide > ground.radius)
        near_before, near_after = (line[np.abs(line[:, 0] - side) < reach, 1] for line in (before, after))
        rise = float(near_after.mean() - near_before.mean()) if len(near_before) and len(near_after) else 0.0
        furthest = float(slide[came].max() / slide.max()) if came.any() else 0.0
        sides.append(SideEffect(name, int(came.sum()), furthest, rise, rise > PILED_RISE * ground.radius))
    return sides


def stopped_by(sides: Sequence[SideEffect]) -> str | None:
    """Return the side of the box ("left" or "right") that stopped a slide, None if the slide ended without a side.

    A side counts as having stopped the slide if ground piled up there, or if ground there slid at least half as far as
    the largest slide.
    """
    reached = [side for side in sides if side.piled or side.slide_share > STOPPED_SHARE]
    return max(reached, key=lambda side: (side.slide_share, side.rise)).name if reached else None


def at_the_sides(sides: Sequence[SideEffect]) -> list[str]:
    """Return notes on the sides that affect the slide: discs of the surface come near them, or ground piles up there.

    The side that stopped the slide has no note, since it is the reason why the slide ended.
    """
    notes, reason = [], stopped_by(sides)
    for side in sides:
        if side.name == reason:
            continue
        if side.piled:
            notes.append(
                f"the ground has piled up by {side.rise:.2g} m at the {side.name} side: take a longer section (setting "
                "beyond)"
            )
        if side.discs_near:
            notes.append(
                f"{counted(side.discs_near, 'disc', 'discs')} of the surface slid to within two diameters of the "
                f"{side.name} side, which may stop {'this disc' if side.discs_near == 1 else 'these discs'}: take a "
                "longer section (setting beyond)"
            )
    return notes


def within_scatter(far: float, radius: float) -> list[str]:
    """Return a sentence on a slide that is not larger than the scatter of liquefied discs on level ground; empty for
    larger slides.

    far: largest slide (m); radius: mean radius of the discs (m).
    """
    if abs(far) >= DRIFT_TOLERANCE * 2.0 * radius:
        return []
    return [
        f"the largest slide is less than {DRIFT_TOLERANCE * 2.0 * radius:.2g} m, a quarter of a disc: level ground "
        "that liquefies moves as far, in either direction, because of its random packing alone; a smaller radius would "
        "show whether this ground slides"
    ]


def thin_layers(start: DiscModel, ground: Ground, strata: Sequence[int]) -> list[str]:
    """Return a note on liquefied layers that are less than two discs thick, with the radius that they need.

    At River Park, discs with layers so thin slid 0.5 m and material points 1.1 m, where 3.7 m were measured.
    """
    notes, thin = [], dict[str, float]()
    free = ~start.fixed
    for k in strata:
        in_layer = free & (start.layer == k)
        if not in_layer.any():
            name = start.springs.layers[k].name
            notes.append(f'stratum "{name}" liquefies but has no disc: take a smaller radius')
            continue
        x, z = ground.to_local(start.x[in_layer], start.z[in_layer])
        column = _columns(x, ground.radius)
        depth = [float(np.ptp(z[column == c]) + 2.0 * start.radius[in_layer].mean()) for c in np.unique(column)]
        thick = float(np.median(depth))
        if thick < 4.0 * ground.radius:
            thin[shown_name(start.springs.layers[k].name)] = thick
    if not thin:
        return notes
    radius = f"{min(thin.values()) / 4.0:.2g} m radius"
    if len(thin) == 1:
        ((name, thick),) = thin.items()
        return [
            *notes,
            f"stratum {name} liquefies and is {thick:.2g} m thick in the model, less than two disc diameters: discs "
            "of this size "
            f"underestimate the slide of the ground behind a bank or quay wall; check with discs of {radius}",
        ]
    listed = ", ".join(f"{name} ({thick:.2g} m)" for name, thick in thin.items())
    return [
        *notes,
        f"strata {listed} liquefy and are less than two disc diameters thick in the model: discs of this size "
        f"underestimate the slide of the ground behind a bank or quay wall; check with discs of {radius}",
    ]


def _columns(x: np.ndarray, radius: float) -> np.ndarray:
    """Return the numbers of the columns, two discs wide, of discs at x (n,)."""
    return np.asarray((x - x.min()) / (4.0 * radius)).astype(int)


def thin_crust(start: DiscModel, ground: Ground, strata: Sequence[int]) -> list[str]:
    """Return a note on the strata above liquefied ground if they are less than two discs thick, with the radius that
    they need.

    86 m behind the quay of Port Island N the ground moved by -0.29 and -0.31 m with discs of three quarters of the
    thickness of its crust, and by 0.24 and 0.63 m with discs half as large (two packings; 1.18 m measured). The
    thickness is the median over columns of discs that have both liquefied ground and a crust.
    """
    free = np.flatnonzero(~start.fixed)
    x, z = ground.to_local(start.x[free], start.z[free])
    wet, top = np.isin(start.layer[free], strata), z + start.radius[free]
    column = _columns(x, ground.radius)
    thick = []
    for c in np.unique(column[wet]):
        in_column = column == c
        above = float(top[in_column].max() - top[in_column & wet].max())
        if above > 0.0:
            thick.append(above)
    crust = float(np.median(thick)) if thick else np.inf
    if crust >= 4.0 * ground.radius:
        return []
    return [
        f"the ground above the liquefied strata is {crust:.2g} m thick in the model, less than two disc diameters: "
        "discs of this size move at random and underestimate the slide of the ground behind a bank or quay wall; check "
        f"with discs of {crust / 4.0:.2g} m radius"
    ]
