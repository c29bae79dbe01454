"""Settles discs, and decides whether they stand or fail under a seismic coefficient that rises smoothly and is then
constant.

Two dimensionless numbers measure the distance to rest. Unbalanced force ratio: mean resultant on free discs over mean
contact force. Kinetic ratio: largest kinetic energy since the last record over stored energy. The displacement is the
mean over all free discs, weighted by mass, in the direction of the seismic force (m), and so work-conjugate to this
force.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, keep_slip, resultants
from dem.engine.pulses import ShortRuns
from dem.errors import DemError
from dem.ground import Ground
from dem.liquefied_ground import pressure_forces
from dem.model import DiscModel
from dem.search.undrained_clay import set_strengths
from dem.settings import DemSettings, TrialVerdict
from dem.springs import LayerSprings

STEP_SHARE = 0.9  # time step over the stable one: large, since no energies are summed on the way to rest
SETTLED_FORCE_RATIO = 1e-4  # unbalanced force ratio under weight
KH_PER_PERIOD = 0.05  # increase of Kh in one natural period of the ground
CHECK_INTERVAL = 0.25  # natural periods between two checks of rest
SETTLING_CHECK_INTERVAL = 1.0 / 32.0  # the same while the ground settles


class NotSettledError(DemError):
    """Discs did not come to rest under their own weight."""


@dataclass(frozen=True)
class RestState:
    """Holds measures of the distance to rest at one time.

    Attributes
    ----------
    time : time since the trial began (s)
    unbalanced_ratio : mean resultant over mean contact force
    kinetic_ratio : largest kinetic energy since the last record, over stored energy
    displacement : mean displacement in the direction of Kh (m)
    """

    time: float
    unbalanced_ratio: float
    kinetic_ratio: float
    displacement: float


class KhRise(NamedTuple):
    """Holds the rise of Kh in a trial.

    Attributes
    ----------
    from_kh : Kh at which the discs stand
    kh : Kh at the end of the rise
    flexibility : elastic displacement over Kh (m); infinite if it is not known, and then no trial fails
    """

    from_kh: float
    kh: float
    flexibility: float


@dataclass(frozen=True)
class Trial:
    """Holds the verdict on one seismic coefficient, and the numbers behind it.

    Attributes
    ----------
    kh : the seismic coefficient
    verdict : "stands", "fails" or "undecided"
    reason : reason of the verdict in words
    unbalanced_ratio, kinetic_ratio : measures of rest at the last record, see `RestState`
    displacement_m, elastic_displacement_m : mean displacement of the discs in the direction of Kh, and that of elastic
        ground under the same Kh (m)
    seconds : model time of the trial (s)
    """

    kh: float
    verdict: TrialVerdict
    reason: str
    unbalanced_ratio: float
    kinetic_ratio: float
    displacement_m: float
    elastic_displacement_m: float
    seconds: float


def unbalanced_ratio(model: DiscModel) -> float:
    """Return the unbalanced force ratio: how near discs are to rest.

    Parameters
    ----------
    model : the discs

    Returns
    -------
    Mean resultant force on free discs, over the mean force of loaded contacts, and of pore pressure on the diameter of
    liquefied discs; inf without such forces.
    """
    forces = contact_forces(model)
    fx, fz, _ = resultants(model, forces)
    size = np.hypot(np.append(forces.fx, forces.line_fx), np.append(forces.fz, forces.line_fz))
    size = np.append(size, pressure_forces(model))
    carrying = size > 0.0
    if not carrying.any():
        return float("inf")
    return float(np.hypot(fx, fz)[~model.fixed].mean() / size[carrying].mean())


def kinetic_ratio(model: DiscModel, kinetic: float | None = None) -> float:
    """Return the kinetic energy over the energy in springs, pore water and bonds of clay. `kinetic` (J/m) replaces the
    present kinetic energy.
    """
    energy = Engine().measure(model)
    stored = energy.in_springs + energy.pore_water + energy.liquefied_bonds
    return (energy.kinetic if kinetic is None else kinetic) / stored if stored > 0.0 else float("inf")


class Displacement:
    """Computes the mean horizontal displacement since a state `before`, weighted by mass, positive in the direction in
    which Kh acts in the search."""

    def __init__(self, before: DiscModel, ground: Ground) -> None:
        self.reference, self.ground, self.free = before, ground, np.flatnonzero(~before.fixed)
        self.mass = before.mass[self.free]
        self.total = self.mass.sum()

    def __call__(self, model: DiscModel) -> float:
        """Return the mean displacement of the discs since `before` (m)."""
        before, free = self.reference, self.free
        dx, _ = self.ground.to_section_axes(model.x[free] - before.x[free], model.z[free] - before.z[free])
        return float(self.ground.search_direction * ((dx * self.mass).sum() / self.total))


def displacement(model: DiscModel, before: DiscModel, ground: Ground) -> float:
    """Return the displacement of discs since `before` (m)."""
    return Displacement(before, ground)(model)


def period(model: DiscModel, ground: Ground) -> float:
    """Return the period of the lowest shear mode of the ground (s): 4 times the travel time of a shear wave from base
    to surface.

    V_s of each layer is the wave velocity of a triangular lattice, r sqrt(1.5 (kn + ks) / m); its thickness follows
    from its share of the discs.
    """
    free = ~model.fixed
    u, v = ground.to_local(model.x[free], model.z[free])
    height = float(np.ptp(v - np.polyval(np.polyfit(u, v, 1), u))) + 2.0 * ground.radius
    time = 0.0
    for k, layer in enumerate(model.springs.layers):
        share = float((model.layer[free] == k).mean())
        mass = np.pi * ground.radius**2 * layer.density
        time += share * height / (ground.radius * np.sqrt(1.5 * (layer.kn + layer.ks) / mass))
    return 4.0 * time


def settle(
    ground: Ground,
    layers: list[LayerSprings],
    settings: DemSettings,
    model: DiscModel | None = None,
    by_shaking: bool = True,
) -> DiscModel:
    """Bring discs to rest under their weight and set their pore springs.

    Parameters
    ----------
    ground : Ground
        Packing of the discs, and its place in the section.
    layers : list of LayerSprings
        Springs of the discs, one for each stratum.
    settings : DemSettings
        Contact law, and mean of the constants of two layers.
    model : DiscModel, optional
        Discs to start from instead of the packing; their pore springs are removed.
    by_shaking : bool
        Whether excess pore pressure by shaking is applied to a new packing once it is at rest.

    Returns
    -------
    DiscModel
        The discs at rest; ``model`` itself if it was given.

    Raises
    ------
    NotSettledError
        If the discs do not come to rest.
    """
    fresh = model is None
    if model is None:
        model = ground.model(layers, settings)
    else:
        model.cut_pore_springs()
        set_strengths(model, layers)
    damp_to_rest(model, ground, "under its weight")
    if any(layer.kpn > 0.0 for layer in layers):  # soil discs have no pore springs
        model.set_pore_springs()
    if fresh and by_shaking:
        shake(model, ground)
    return model


def shake(model: DiscModel, ground: Ground) -> None:
    """Apply excess pore pressure by shaking, if there is any, to discs at rest, and bring them to rest again."""
    if ground.weaken(model):
        damp_to_rest(model, ground, "with the excess pore pressure by shaking")


def damp_to_rest(model: DiscModel, ground: Ground, under: str) -> None:
    """Continue until the unbalanced force ratio is below `SETTLED_FORCE_RATIO`.

    Velocities are set to zero whenever the kinetic energy has passed a peak (kinetic damping, Cundall 1976).
    """
    cycle, start = period(model, ground), model.time
    last = 0.0
    while model.time < start + 40.0 * cycle:
        last, _ = advance_damped(model, CHECK_INTERVAL * cycle, last)
        if unbalanced_ratio(model) < SETTLED_FORCE_RATIO:
            stop(model)
            return
    raise NotSettledError(
        f"after {model.time - start:.3g} s {under} the ground is not at rest: unbalanced force ratio "
        f"{unbalanced_ratio(model):.2g}, {SETTLED_FORCE_RATIO:g} is required. Use stiffer springs or smaller discs."
    )


def advance_damped(model: DiscModel, seconds: float, last: float, threads: int = 1) -> tuple[float, float]:
    """Run the discs further with kinetic damping. last: kinetic energy at the end of the last call (J/m). Returns the
    final and the largest kinetic energy.

    model: model of the discs; seconds: model time; threads: threads of the engine.
    """
    count = round(CHECK_INTERVAL / SETTLING_CHECK_INTERVAL)
    most = 0.0
    with ShortRuns(model, STEP_SHARE, threads) as pulses:
        for _ in range(count):
            pulses.on(seconds / count)
            energy = kinetic_energy(model)
            most = max(most, energy)
            if energy < last:
                pulses.whole()
                stop(model)
                energy = 0.0
            last = energy
    return last, most


def stop(model: DiscModel) -> None:
    """Set the velocity of all free discs to zero."""
    keep_slip(model)
    model.set_velocity(0.0, 0.0, where=~model.fixed)


def kinetic_energy(model: DiscModel) -> float:
    """Return the kinetic energy of the discs (J per metre)."""
    turning = np.divide(model.vr**2, model.inertia_ratio, out=np.zeros(len(model)), where=model.inertia_ratio > 0.0)
    return float(0.5 * np.sum((model.mass * (model.vx**2 + model.vz**2 + turning))[~model.fixed]))


def step_on(model: DiscModel, seconds: float, threads: int = 1) -> None:
    """Advance the discs without energy balance, at the longest step that is safely stable."""
    with ShortRuns(model, STEP_SHARE, threads) as pulses:
        pulses.on(seconds)


def try_kh(
    model: DiscModel,
    before: DiscModel,
    ground: Ground,
    settings: DemSettings,
    rise: KhRise,
    threads: int = 1,
) -> Trial:
    """Raise Kh for discs that stand at a smaller Kh, and decide whether they still stand.

    Kh rises by `KH_PER_PERIOD` in a period of the ground, and is then constant, with kinetic damping as in `settle`:
    dashpots of contacts hardly damp the vibration of the whole ground, which is not the subject of the test. The discs
    stand if the unbalanced force ratio and the kinetic energy ratio are below their limits. The discs fail if both
    ratios are above their limits and the displacement exceeds `DemSettings.ductility` times the elastic one and grew at
    every record of the last period. Otherwise the trial is undecided: after `patience` periods, or when a DemError
    stopped the discs.

    Parameters
    ----------
    model : discs at rest under the Kh at which the rise begins; changed
    before : the same discs without Kh, from which displacements count
    ground : packing of the discs, and its place in the section
    settings : limits of rest and of failure
    rise : begin and end of Kh, and elastic displacement over Kh (m)
    threads : threads of the engine

    Returns
    -------
    The verdict, with the state at the last record.
    """
    from_kh, kh, flexibility = rise
    cycle = period(model, ground)
    start = model.time
    risen = start + cycle * max(0.5, abs(kh - from_kh) / KH_PER_PERIOD)
    model.acceleration = ground.shaking(from_kh, kh, start, risen)
    elastic = flexibility * abs(kh)
    seen: list[RestState] = []
    last = 0.0
    while model.time < risen + settings.patience * cycle:
        try:
            if model.time < risen:
                step_on(model, CHECK_INTERVAL * cycle, threads)
                most = kinetic_energy(model)
            else:
                last, most = advance_damped(model, CHECK_INTERVAL * cycle, last, threads)
        except DemError as error:
            return _trial(kh, "undecided", f"{type(error).__name__}: {error}", seen, elastic, model.time - start)
        ratios = unbalanced_ratio(model), kinetic_ratio(model, most)
        rest_state = RestState(model.time - start, *ratios, displacement(model, before, ground))
        seen.append(rest_state)
        moving = rest_state.unbalanced_ratio > settings.unbalanced and rest_state.kinetic_ratio > settings.kinetic
        resting = rest_state.unbalanced_ratio <= settings.unbalanced and rest_state.kinetic_ratio <= settings.kinetic
        if model.time < risen:
            continue
        if resting:
            return _trial(kh, "stands", "all forces are balanced and no disc moves", seen, elastic, rest_state.time)
        recent = np.array([rest.displacement for rest in seen[-round(1.0 / CHECK_INTERVAL) - 1 :]])
        if (
            moving
            and abs(rest_state.displacement) > settings.ductility * elastic
            and np.all(np.diff(np.abs(recent)) > 0.0)
        ):
            reason = f"the displacement is {abs(rest_state.displacement) / elastic:.1f} times the elastic one and grows"
            return _trial(kh, "fails", reason, seen, elastic, rest_state.time)
    reason = (
        f"the discs are neither at rest nor displaced by {settings.ductility:g} elastic displacements after "
        f"{settings.patience:g} periods"
    )
    return _trial(kh, "undecided", reason, seen, elastic, model.time - start)


def _trial(
    kh: float, verdict: TrialVerdict, reason: str, seen: list[RestState], elastic: float, seconds: float
) -> Trial:
    last = seen[-1] if seen else RestState(0.0, float("inf"), float("inf"), 0.0)
    return Trial(kh, verdict, reason, last.unbalanced_ratio, last.kinetic_ratio, last.displacement, elastic, seconds)
