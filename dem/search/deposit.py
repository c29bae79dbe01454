"""Prepares soil discs at rest. The discs are filled in a little too high, settled, cut to the surface of the section,
and settled again.

Random packings settle by some per cent of their height. The box is therefore filled above the surface of the section.
After settling, discs above the surface are removed, and every other disc is assigned to the stratum in which it lies.
After this cut, surface and interfaces agree with the section. Weight and mass follow from the void ratio of this
packing: area of the section over area of discs. Settling and cutting are done `LEVELLING_ROUNDS` times, the last time
with the hollows at the surface filled, which is repeated where a column still deviates (`dem.search.levelling`).

Discs that came to rest under their weight alone have hardly more contacts than equilibrium requires (three each), and
move at a small share of their strength: the discs of S-13 moved 0.44 m under Kh = 0.1, the continuum 0.10 m. Natural
ground is denser than such a packing. The discs are therefore compacted by some cycles of a small Kh, after which Kh =
0.1 moves the discs of S-13 by 0.05 m.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from dem.errors import DemError
from dem.ground import Ground, in_stratum
from dem.laboratory.patch import POROSITY, VOID_RATIO
from dem.laboratory.soil_contacts import SoilLayer, soil_layers
from dem.model import DiscModel
from dem.packing import Packing, brought_back, densest, periodic_packing, random_packing
from dem.search.equilibrium import damp_to_rest, period, settle, shake, step_on
from dem.search.levelling import levelled, misfit
from dem.search.undrained_clay import replace_contacts_of_clay
from dem.settings import DemSettings
from dem.springs import LayerSprings
from dem.undisturbed_contacts import mark_undisturbed
from meshes.errors import InputError
from meshes.section.polyline import downhill
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.translation import with_origin

LEVELLING_ROUNDS = 2  # times that the ground settles and is cut
EXTRA_ROUNDS = 3  # largest number of further rounds while the surface of a column deviates by more than
HEIGHT_TOLERANCE = 0.5  # mean radii
SINKING = 0.01  # settlement of a random packing over the height of the section
MARGIN = 2.0  # mean radii by which the fill is higher than the section with this settlement
# Width (mean radii) of fixed discs beyond base and sides, since discs slide on a row of equal discs; and below the base
# of periodic ground, where no rigid line stops liquefied discs.
RIM, DEEP_RIM = 2.4, 6.0
# Depth (mean radii) below the surface above which discs are removed by their centres, so that the tops of the remaining
# discs are level with the surface on average.
CUT_DEPTH = 0.35
CYCLES = 3  # of shaking
# Amplitudes of Kh, of which the first is taken under which the ground comes to rest: steep slopes fail under a small
# Kh.
SHAKING_KH = (0.1, 0.05, 0.025)
CYCLE_PERIODS = 4.0  # duration of a cycle over the natural period of the ground
# Largest movement in the last cycle, over that in the first one, or in mean radii: ground that fails moves on. The
# movement is that which this percentage of the discs does not exceed.
MOVEMENT_RATIO, SMALLEST_MOVEMENT, MOVEMENT_PERCENTILE = 0.5, 0.02, 99.0
LOOSER = (0.0, 0.005, 0.01, 0.02)  # porosity beyond that of the element tests, where walls leave no room for less


@dataclass(frozen=True)
class Deposit:
    """Holds the discs at rest in the section.

    Attributes
    ----------
    ground : packing of the discs, and its place in the section
    layers : springs of every stratum, before calibration
    settled : the discs at rest
    """

    ground: Ground
    layers: list[LayerSprings]
    settled: DiscModel


class Rounds(Protocol):
    """Stores the discs before every round of settling and cutting, from which a stopped deposit continues."""

    def latest(self) -> tuple[int, DiscModel] | None:
        """Return the number of the latest stored round, and the discs before it; None if no round is stored."""

    def add(self, number: int, settled: DiscModel) -> None:
        """Store the discs before a round."""


def deposit(
    section: Section,
    settings: DemSettings,
    soil: Sequence[SoilLayer] | None = None,
    *,
    periodic: bool = False,
    rounds: Rounds | None = None,
) -> Deposit:
    """Fill a section with soil discs, let them settle, and cut them to its surface. Clay is undrained from then on.

    Parameters
    ----------
    section : Section
        The layered ground.
    settings : DemSettings
        Radius, spread of the radii and packing of the discs.
    soil : sequence of SoilLayer or None
        Contacts of the discs of every stratum; None for the contacts by `soil_layers`, which have the strength of the
        soil.
    periodic : bool
        Whether the sides are periodic; else the discs are in a box.
    rounds : Rounds or None
        Where the discs are stored before every round, and read if the deposit was stopped; None to store nothing.

    Returns
    -------
    Deposit
        The discs at rest, their springs and the void ratio.

    Raises
    ------
    InputError
        If no packing fits into the section.
    NotSettledError
        If the ground does not come to rest.
    """
    whole, stored = section, rounds.latest() if rounds is not None else None
    place = _corner(whole) if stored is None else stored[1].place
    section = with_origin(whole, *place)
    radius = settings.mean_radius(section)
    soil = soil_layers(section) if soil is None else soil
    if stored is None:
        ground = replace(_overfilled_box(section, settings, radius, periodic), origin=place, place=place)
        layers = [layer.springs(radius, VOID_RATIO) for layer in soil]
        stored = 0, settle(ground, layers, settings, by_shaking=False)
    first, settled = stored
    ground = _with_discs(section, downhill(whole.ground), settings, settled)
    for done in range(first, LEVELLING_ROUNDS + EXTRA_ROUNDS):
        if rounds is not None:
            rounds.add(done, settled)
        packing = cut(section, settled, ground)
        if done >= LEVELLING_ROUNDS - 1:
            packing = levelled(section, packing, radius, settings.spread)
        ground = replace(ground, packing=_in_strata(section, packing))
        voids = void_ratio(section, ground.packing)
        layers = [layer.springs(radius, voids) for layer in soil]
        settled = settle(ground, layers, settings, by_shaking=False)
        if done < LEVELLING_ROUNDS - 1:
            continue
        settled = densified_by_shaking(settled, ground)
        if np.abs(misfit(section, settled, radius)).max() <= HEIGHT_TOLERANCE * radius:
            break
    shake(settled, ground)
    if replace_contacts_of_clay(settled, period(settled, ground), ground):
        damp_to_rest(settled, ground, "with clay that is undrained")
    return Deposit(ground, list(settled.springs.layers), _undisturbed(settled, ground))


def _undisturbed(settled: DiscModel, ground: Ground) -> DiscModel:
    """Return discs at rest whose contacts have the friction of undisturbed ground. Single discs at the surface slip
    with it; ground that fails by its weight is left to the searches and slides."""
    mark_undisturbed(settled)
    model = settled.copy()
    try:
        damp_to_rest(model, ground, "with the friction of undisturbed ground")
    except DemError:
        return settled
    return model


def densified_by_shaking(settled: DiscModel, ground: Ground) -> DiscModel:
    """Return discs at rest after cycles of Kh in both directions. The discs are unchanged if they keep moving under
    every Kh of `SHAKING_KH`."""
    cycle = CYCLE_PERIODS * period(settled, ground)
    time = np.linspace(0.0, cycle, 41)
    for kh in SHAKING_KH:
        model, moved = settled.copy(), []
        try:
            for _ in range(CYCLES):
                x, z = model.x.copy(), model.z.copy()
                model.acceleration = ground.recorded_acceleration(
                    model.time + time, kh * GRAVITY * np.sin(2.0 * np.pi * time / cycle)
                )
                step_on(model, cycle)
                model.acceleration = settled.acceleration
                damp_to_rest(model, ground, "after densification by shaking")
                moved.append(
                    float(np.percentile(np.hypot(model.x - x, model.z - z)[~model.fixed], MOVEMENT_PERCENTILE))
                )
        except DemError:
            continue
        if moved[-1] <= max(MOVEMENT_RATIO * moved[0], SMALLEST_MOVEMENT * ground.radius):
            return model
    return settled


def void_ratio(section: Section, packing: Packing) -> float:
    """Return the area of the section over the area of the free discs, less one."""
    solid = float(np.sum(np.pi * packing.radius[packing.free] ** 2))
    return float(section.layering.areas().sum()) / solid - 1.0


def cut(section: Section, settled: DiscModel, ground: Ground) -> Packing:
    """Return a packing of the discs in their present positions, without those above the surface."""
    packing = _packing_of(section, settled)
    level = np.interp(packing.x, *section.ground.T)
    keep = ~packing.free | (packing.z <= level - CUT_DEPTH * ground.radius)
    x, z, size, layer = (values[keep] for values in (packing.x, packing.z, packing.radius, packing.layer))
    return Packing(x, z, size, layer, packing.lines, packing.period)


def _packing_of(section: Section, settled: DiscModel) -> Packing:
    """Return a packing of the discs in their present positions; discs of periodic ground are moved into the section."""
    x, z = brought_back(settled.x, settled.z, section.extent[0], settled.repeats)
    return Packing(x, z, settled.radius, settled.layer, settled.lines, settled.period)


def _in_strata(section: Section, packing: Packing) -> Packing:
    """Return the packing with every free disc assigned to the stratum in which it lies."""
    layer, inside = packing.layer.copy(), packing.free
    layer[inside] = in_stratum(section, packing.x[inside], packing.z[inside])
    return replace(packing, layer=layer)


def ground_at_rest(section: Section, settings: DemSettings, settled: DiscModel) -> Ground:
    """Return the ground of a checkpoint of settled soil discs.

    Parameters
    ----------
    section : ground that the discs fill
    settings : settings of the discs, from which their mean radius follows
    settled : the discs of the checkpoint

    Returns
    -------
    The discs at their present positions, as a random packing in the frame of the section. Discs of periodic ground are
    moved into the section.
    """
    return _with_discs(with_origin(section, *settled.place), downhill(section.ground), settings, settled)


def _with_discs(local: Section, falls: int, settings: DemSettings, settled: DiscModel) -> Ground:
    """Return the ground of settled discs in a section in their own axes (``local``) that falls to one side."""
    packing, radius = _packing_of(local, settled), settings.mean_radius(local)
    return Ground(packing, "random", radius, 0, 0.0, settled.place, falls, local, place=settled.place)


def _corner(section: Section) -> tuple[float, float]:
    """Return the corner of the rectangle around a section at the left and at the bottom (m)."""
    x, z = section.outline().min(axis=0)
    return float(x), float(z)


def _overfilled_box(section: Section, settings: DemSettings, radius: float, periodic: bool) -> Ground:
    """Return a random packing that reaches above the surface, with strata stretched in proportion."""
    outline = section.outline()
    overfill = SINKING * float(np.ptp(outline[:, 1])) + MARGIN * radius
    surface = section.ground
    on_top = np.abs(outline[:, 1] - np.interp(outline[:, 0], *surface.T)) < 1e-6
    on_top |= (np.abs(outline[:, None] - surface).max(axis=2) < 1e-6).any(axis=1)  # both corners of a vertical step
    base = outline[~on_top]
    base = base[np.argsort(base[:, 0], kind="stable")]

    def stratum_at(x: np.ndarray, z: np.ndarray) -> np.ndarray:
        low, high = np.interp(x, *base.T), np.interp(x, *surface.T)
        # discs in the rim are fixed, and of no stratum
        share = np.clip((z - low) / (high + overfill - low), 0.0, 1.0)
        return in_stratum(section, x, low + share * (high - low))

    up = np.array([0.0, 1.0])
    lower, upper = base - DEEP_RIM * radius * up, surface + overfill * up
    box = _raised_outline(outline, on_top, overfill, RIM * radius)
    spread, seed = settings.spread, settings.seed

    def packed(porosity: float) -> Packing:
        if periodic:
            return periodic_packing(lower, upper, stratum_at, radius, spread=spread, porosity=porosity, seed=seed)
        return random_packing(box, stratum_at, radius, spread=spread, porosity=porosity, seed=seed)

    try:
        packing = _fixed_in_box(densest(packed, POROSITY + np.array(LOOSER)), base, *section.extent)
    except ValueError as error:
        raise InputError(section.name, [f"dem: {error}"]) from error
    return Ground(packing, "random", radius, 0, 0.0, (0.0, 0.0), downhill(section.ground), section)


def _raised_outline(outline: np.ndarray, on_top: np.ndarray, overfill: float, rim: float) -> np.ndarray:
    """Return the outline of a box that extends above the surface, and beyond base and sides of the section (m).

    on_top: mask (n,) of the corners that are on the surface; overfill, rim: heights above the surface, and distances
    beyond base and sides (m).
    """
    left, right = float(outline[:, 0].min()), float(outline[:, 0].max())
    raised = outline + np.where(on_top, overfill, -rim)[:, None] * np.array([0.0, 1.0])
    raised[:, 0] += rim * ((outline[:, 0] > right - 1e-6) * 1.0 - (outline[:, 0] < left + 1e-6))
    return raised


def _fixed_in_box(packing: Packing, base: np.ndarray, left: float, right: float) -> Packing:
    """Return the packing with all discs fixed whose centres are beyond the base or the sides. The fixed discs form a
    rough box, like the fixed nodes of the continuum.
    """
    beyond = (packing.x < left) | (packing.x > right) | (packing.z < np.interp(packing.x, *base.T))
    return replace(packing, layer=np.where(beyond, -1, packing.layer).astype(packing.layer.dtype))
