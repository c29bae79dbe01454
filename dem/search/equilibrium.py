"""Settling, and whether discs stand or fail under a seismic coefficient that is raised smoothly and then held.

Two dimensionless numbers measure how far they are from rest. Unbalanced force ratio: mean resultant on the discs that
can move over mean contact force. Kinetic ratio: kinetic energy, the most since the last look, over stored energy.
Displacement is the mean over all discs that can move, weighted with their mass, in the direction of the push (m): what
the seismic force works on.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, keep_slip, resultants
from dem.engine.pulses import Pulses
from dem.errors import DemError
from dem.ground import Ground
from dem.model import DiscModel
from dem.settings import DemSettings
from dem.springs import LayerSprings

STEP = 0.6  # of the stable one: what is looked for is rest, and no energies are summed on the way to it
SETTLED = 1e-4  # unbalanced force ratio under weight
RISE = 0.05  # Kh that is raised in one period of the ground
LOOK = 0.25  # of a period between two looks
PULSE = 1.0 / 32.0  # of a period between two looks while settling

Verdict = Literal["stands", "fails", "undecided"]


class NotSettledError(DemError):
    """Discs that did not come to rest under their own weight."""


@dataclass(frozen=True)
class Rest:
    """How far from rest discs are at one time.

    Attributes
    ----------
    time : float
        Since the trial began (s).
    unbalanced_ratio : float
        Mean resultant over mean contact force.
    kinetic_ratio : float
        Kinetic energy, the most since the last look, over stored energy.
    displacement : float
        Mean displacement downhill (m).
    """

    time: float
    unbalanced_ratio: float
    kinetic_ratio: float
    displacement: float


class Rise(NamedTuple):
    """Start and end of a trial.

    Attributes
    ----------
    from_kh : float
        At which the discs stand.
    kh : float
        To which they are taken.
    flexibility : float
        Elastic displacement over Kh (m), infinite if it is not known: nothing fails then.
    """

    from_kh: float
    kh: float
    flexibility: float


@dataclass(frozen=True)
class Trial:
    """The verdict on one seismic coefficient, and the numbers behind it.

    Attributes
    ----------
    kh : float
        The coefficient.
    verdict : str
        "stands", "fails" or "undecided".
    reason : str
        In words.
    unbalanced_ratio, kinetic_ratio : float
        At the last look, see `Rest`.
    displacement_m, elastic_displacement_m : float
        Mean displacement downhill, and what it would be if the ground were elastic (m).
    seconds : float
        Of the model's time (s).
    """

    kh: float
    verdict: Verdict
    reason: str
    unbalanced_ratio: float
    kinetic_ratio: float
    displacement_m: float
    elastic_displacement_m: float
    seconds: float


def unbalanced_ratio(model: DiscModel) -> float:
    """Mean resultant force on the discs that can move, over the mean force of the contacts that carry any."""
    forces = contact_forces(model)
    fx, fz, _ = resultants(model, forces)
    size = np.hypot(np.append(forces.fx, forces.line_fx), np.append(forces.fz, forces.line_fz))
    carrying = size > 0.0
    if not carrying.any():
        return float("inf")
    return float(np.hypot(fx, fz)[~model.fixed].mean() / size[carrying].mean())


def kinetic_ratio(model: DiscModel, kinetic: float | None = None) -> float:
    """Kinetic energy over that in springs; `kinetic` (J/m) in place of what there is now."""
    energy = Engine().measure(model)
    stored = energy.in_springs
    return (energy.kinetic if kinetic is None else kinetic) / stored if stored > 0.0 else float("inf")


class Displacement:
    """Mean displacement downhill, along the horizontal, since a state `before`, weighted with mass."""

    def __init__(self, before: DiscModel, ground: Ground) -> None:
        self.before, self.ground, self.free = before, ground, np.flatnonzero(~before.fixed)
        self.mass = before.mass[self.free]
        self.total = self.mass.sum()

    def __call__(self, model: DiscModel) -> float:
        """Mean displacement of the discs so far (m)."""
        before, free = self.before, self.free
        dx, _ = self.ground.turned(model.x[free] - before.x[free], model.z[free] - before.z[free])
        return float(self.ground.downhill * ((dx * self.mass).sum() / self.total))


def displacement(model: DiscModel, before: DiscModel, ground: Ground) -> float:
    """The displacement of discs since `before` (m)."""
    return Displacement(before, ground)(model)


def period(model: DiscModel, ground: Ground) -> float:
    """Period of the lowest shear mode of the ground (s): 4 times the time a shear wave takes from base to surface.

    V_s = r sqrt(1.5 (kn + ks) / m) of the triangular lattice for each layer, its thickness by its share of the discs.
    """
    free = ~model.fixed
    u, v = ground.to_section(model.x[free], model.z[free])
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
    shaken: bool = True,
) -> DiscModel:
    """Bring discs to rest under their weight and set their pore springs.

    Parameters
    ----------
    ground : Ground
        Where they lie in the section.
    layers : list of LayerSprings
        Their springs, one for each stratum.
    settings : DemSettings
        Contact law, and mean of the constants of two layers.
    model : DiscModel, optional
        Discs to continue from in place of the packing; they lose their pore springs.
    shaken : bool
        Whether a new packing gets the excess pore pressure of shaking once it is at rest.

    Returns
    -------
    DiscModel
        The discs at rest; ``model`` itself if it was given.

    Raises
    ------
    NotSettledError
        If they do not come to rest.
    """
    fresh = model is None
    if model is None:
        model = ground.model(layers, settings)
    else:
        model.cut_pore_springs()
        model.set_springs(layers)
    calm_down(model, ground, "under its weight")
    if any(layer.kpn > 0.0 for layer in layers):  # soil discs have no pore springs
        model.set_pore_springs()
    if fresh and shaken:
        shake(model, ground)
    return model


def shake(model: DiscModel, ground: Ground) -> None:
    """Adds the pore pressure that shaking adds to discs at rest, if it adds any, and takes them to rest again."""
    if ground.weaken(model):
        calm_down(model, ground, "once shaking has added its pore pressure")


def calm_down(model: DiscModel, ground: Ground, under: str) -> None:
    """Takes discs on until the unbalanced force ratio is below `SETTLED`.

    Velocities are set to zero whenever the kinetic energy has passed a peak (kinetic damping, Cundall 1976).
    """
    cycle, start = period(model, ground), model.time
    last = 0.0
    while model.time < start + 40.0 * cycle:
        last, _ = calm(model, LOOK * cycle, last)
        if unbalanced_ratio(model) < SETTLED:
            stop(model)
            return
    raise NotSettledError(
        f"after {model.time - start:.3g} s {under} the ground is not at rest: unbalanced force ratio "
        f"{unbalanced_ratio(model):.2g}, {SETTLED:g} is asked for. Take stiffer springs or smaller discs."
    )


def calm(model: DiscModel, seconds: float, last: float, threads: int = 1) -> tuple[float, float]:
    """Takes discs on with kinetic damping. last: kinetic energy they were left with (J/m); returns it, and the most.

    model: the discs; seconds: how long; threads: of the engine.
    """
    count = round(LOOK / PULSE)
    most = 0.0
    with Pulses(model, STEP, threads) as pulses:
        for _ in range(count):
            pulses.on(seconds / count)
            energy = moving_energy(model)
            most = max(most, energy)
            if energy < last:
                pulses.whole()
                stop(model)
                energy = 0.0
            last = energy
    return last, most


def stop(model: DiscModel) -> None:
    """Takes the velocity away from all discs that can move."""
    keep_slip(model)
    model.set_velocity(0.0, 0.0, where=~model.fixed)


def moving_energy(model: DiscModel) -> float:
    """Kinetic energy of the discs (J per metre)."""
    turning = np.divide(model.vr**2, model.inertia_ratio, out=np.zeros(len(model)), where=model.inertia_ratio > 0.0)
    return float(0.5 * np.sum((model.mass * (model.vx**2 + model.vz**2 + turning))[~model.fixed]))


def step_on(model: DiscModel, seconds: float, threads: int = 1) -> None:
    """Takes discs on without summing energies, at the longest step that is safely stable now, or all at once."""
    with Pulses(model, STEP, threads) as pulses:
        pulses.on(seconds)


def try_kh(
    model: DiscModel,
    before: DiscModel,
    ground: Ground,
    settings: DemSettings,
    rise: Rise,
    threads: int = 1,
) -> Trial:
    """Raises Kh for discs that stand at a smaller one, and says whether they still stand; `model` is changed.

    Kh rises by `RISE` in a period of the ground, and is held with kinetic damping, as in `settle`: dashpots of contacts
    hardly damp the vibration of the whole ground, which is not what is tested. Stands: both ratios are below their
    limits. Fails: the displacement since `before` exceeds `growth` times the elastic one and grew at every look of the
    last period, and neither ratio is below its limit. Else undecided: after `patience` periods, or when a DemError
    stopped the discs. settings: of the discs; rise: from which Kh to which, and the elastic displacement per Kh (m);
    threads: of the engine.
    """
    from_kh, kh, flexibility = rise
    cycle = period(model, ground)
    start = model.time
    risen = start + cycle * max(0.5, abs(kh - from_kh) / RISE)
    model.acceleration = ground.shaking(from_kh, kh, start, risen)
    elastic = flexibility * abs(kh)
    seen: list[Rest] = []
    last = 0.0
    while model.time < risen + settings.patience * cycle:
        try:
            if model.time < risen:
                step_on(model, LOOK * cycle, threads)
                most = moving_energy(model)
            else:
                last, most = calm(model, LOOK * cycle, last, threads)
        except DemError as error:
            return _trial(kh, "undecided", f"{type(error).__name__}: {error}", seen, elastic, model.time - start)
        ratios = unbalanced_ratio(model), kinetic_ratio(model, most)
        here = Rest(model.time - start, *ratios, displacement(model, before, ground))
        seen.append(here)
        moving = here.unbalanced_ratio > settings.unbalanced and here.kinetic_ratio > settings.kinetic
        resting = here.unbalanced_ratio <= settings.unbalanced and here.kinetic_ratio <= settings.kinetic
        if model.time < risen:
            continue
        if resting:
            return _trial(kh, "stands", "forces balance and nothing moves", seen, elastic, here.time)
        recent = np.array([rest.displacement for rest in seen[-round(1.0 / LOOK) - 1 :]])
        if moving and abs(here.displacement) > settings.ductility * elastic and np.all(np.diff(np.abs(recent)) > 0.0):
            reason = f"displacement is {abs(here.displacement) / elastic:.1f} times the elastic one and grows"
            return _trial(kh, "fails", reason, seen, elastic, here.time)
    reason = (
        f"neither at rest nor past {settings.ductility:g} elastic displacements after {settings.patience:g} periods"
    )
    return _trial(kh, "undecided", reason, seen, elastic, model.time - start)


def _trial(kh: float, verdict: Verdict, reason: str, seen: list[Rest], elastic: float, seconds: float) -> Trial:
    last = seen[-1] if seen else Rest(0.0, float("inf"), float("inf"), 0.0)
    return Trial(kh, verdict, reason, last.unbalanced_ratio, last.kinetic_ratio, last.displacement, elastic, seconds)
