"""Finds the critical Kh of soil discs by displacement control: their displacement is prescribed, and the Kh that it
requires is measured.

Under displacement control the curve continues beyond the largest Kh, like the equilibrium path of the FEM model. The
curves of discs and FEM model show Kh against the mass-weighted mean displacement (m) in the direction of the force.
Both curves are compared at the same displacement, since neither has a limit load in a box: loose ground hardens as it
is compressed. The critical Kh of the discs is the largest moving average of Kh up to a limit of the
displacement, `DemSettings.ductility` times the yield displacement of the FEM model; each average spans a fifth of this
limit.
Discs require a larger strain than an elastic-plastic body with the same E to reach the same strength: `settings.GROWTH`
describes how this larger strain was measured.

The place of failure is visible only later: at their critical Kh discs still harden, and shear everywhere. The
displacement-controlled test therefore continues until the discs have a slip surface.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from dem.engine.pulses import ShortRuns
from dem.errors import DemError
from dem.ground import Ground
from dem.model import DiscModel
from dem.search.critical import OnTrial, Search
from dem.search.equilibrium import STEP_SHARE, Displacement, Trial, kinetic_ratio, period, unbalanced_ratio
from dem.settings import DemSettings
from meshes.section.quantity import GRAVITY

# Stiffness of the loading spring, in critical Kh over the reach: about five times that of the ground.
MACHINE_STIFFNESS = 65.0
SLOWEST_RATE, FASTEST_RATE = 0.012, 0.04  # reaches in a period of the ground; half of both changes kc by 1 %
DAMPING = 0.3  # of the machine, over the critical one of the ground on its spring
PULSES = 64  # smallest number of checks of the displacement in a natural period of the ground;
LARGEST_PHASE = 0.2  # rad: largest phase of the oscillation on the loading spring between two checks
BLOCK = 0.05  # of the reach, over which a point of the curve is a mean
WINDOW = 4  # blocks over which Kh is averaged for the critical one
LAST_REACH = 1.1  # of the reach, where the curve ends: the last window has the reach in its middle
BAND_DISPLACEMENT = 8.0  # radii: displacement at which a shear band has formed, about its width
LAST_DISPLACEMENT = 8.0  # reaches at the end of the test: beyond, the sides have more and more influence
# Displacement over the mean displacement of all discs from which ground has separated from the rest.
DETACHMENT_RATIO = 5.0
# Percentile of the displacement that represents the ground: single discs may roll farther.
GROUND_PERCENTILE = 98
LATE_RATE = 0.1  # reaches in a natural period of the ground, after the curve is known


class Continuum(NamedTuple):
    """Holds results of the FEM model that discs are calibrated to.

    Attributes
    ----------
    kc : critical Kh of the continuum with the sides of the discs
    yielding : yield displacement: mean displacement of the continuum in the direction of the seismic force when Kh
        reaches the critical value (m)
    upper : upper end of the bracket of the critical Kh of the continuum; if its path softens, only this bracket is
        known
    """

    kc: float
    yielding: float
    upper: float = 0.0

    def nearest(self, kh: float) -> float:
        """Return the critical Kh within the bracket of the FEM that is nearest to ``kh``."""
        return float(np.clip(kh, self.kc, max(self.kc, self.upper)))


class DisplacementControl(NamedTuple):
    """Holds the displacement control: a spring and a parallel dashpot that move the discs.

    Attributes
    ----------
    reach : largest prescribed displacement of the discs, approximately (m)
    stiffness : Kh over the shortening of the spring (1/m)
    """

    reach: float
    stiffness: float

    @property
    def frequency(self) -> float:
        """Return the natural angular frequency of the ground on the spring (rad/s)."""
        return float(np.sqrt(GRAVITY * self.stiffness))

    @property
    def dashpot(self) -> float:
        """Return the coefficient of the dashpot: Kh over the speed of shortening (s/m)."""
        return 2.0 * DAMPING * self.frequency / GRAVITY

    def speed(self, moved: float, cycle: float) -> float:
        """Return the speed (m/s) of the loading end of the spring when the ground of period ``cycle`` (s) has ``moved``
        (m)."""
        share = (
            LATE_RATE
            if moved >= LAST_REACH * self.reach
            else np.clip(0.15 * moved / self.reach, SLOWEST_RATE, FASTEST_RATE)
        )
        return self.reach * float(share) / cycle


def pushover_critical_kh(
    settled: DiscModel,
    ground: Ground,
    settings: DemSettings,
    continuum: Continuum,
    *,
    threads: int = 1,
    on_trial: OnTrial | None = None,
    until_failed: bool = True,
) -> tuple[Search, DiscModel]:
    """Compute the critical Kh of settled soil discs by displacement control.

    Parameters
    ----------
    settled : discs at rest under their weight; not changed
    ground : packing of the discs, and its place in the section
    settings : settings of the discs; the curve ends at `DemSettings.ductility` times the yield displacement
    continuum : critical Kh and yield displacement of the finite elements
    threads : threads of the engine
    on_trial : is called with every point of the curve, and the discs there
    until_failed : whether the test continues beyond the end of the curve until a slip surface has formed, a part of the
        discs has separated, or the displacement is large enough

    Returns
    -------
    The critical Kh, with a bracket of one standard error to either side and the load-displacement curve, and the discs
    at the end of the test. The verdict is "undecided" if a DemError stops the discs before the end of the curve; after
    a later one, the discs are those at the end of the curve.

    Raises
    ------
    ValueError
        If the critical Kh or the yield displacement of the continuum is not positive.
    """
    if min(continuum.kc, continuum.yielding) <= 0.0:
        raise ValueError(f"{continuum}: expected a critical Kh and a displacement above 0")
    search, model, whole, ended = Search(), settled.copy(), False, ""
    reach = settings.ductility * continuum.yielding
    try:
        machine = DisplacementControl(reach, MACHINE_STIFFNESS * continuum.kc / reach)
        for trial in _points(model, settled, ground, machine, threads, until_failed):
            if trial is None or isinstance(trial, str):
                whole, ended = True, trial or ""
                continue
            search.trials.append(trial)
            last_point = model.copy()
            if on_trial is not None:
                on_trial(trial, model)
    except DemError as error:
        model = last_point if whole else model
        came = max((trial.displacement_m for trial in search.trials), default=0.0)
        search.reason = f"after {came:.3g} m: {type(error).__name__}: {error}"
        ended = f"; the test continued until {type(error).__name__}: {error}"
    if whole:
        search.verdict = "bracketed"
        search.reason = (
            f"this is the largest Kh up to a displacement of {reach:.3g} m, {settings.ductility:g} times the yield "
            f"displacement of the finite elements{ended}"
        )
    if search.trials:
        kc, half, last = critical_point(search.trials)
        search.kc_lower, search.kc_upper = kc - half, kc + half
        search.flexibility_m = continuum.yielding / kc if kc > 0.0 else 0.0
        search.curve = [(trial.kh, trial.displacement_m) for trial in search.trials[: last + 1]]
        if kc <= 0.0:
            search.verdict, search.kc_upper = "fails under its own weight", 0.0
    return search, model


def critical_point(points: Sequence[Trial]) -> tuple[float, float, int]:
    """Return the critical Kh, half the width of its bracket, and the number of the point at which it was reached.

    The width is the standard error of the mean over the window, since the curve of loose ground is jerky.
    """
    size = min(WINDOW, len(points))
    windows = np.lib.stride_tricks.sliding_window_view([point.kh for point in points], size)
    best = int(np.argmax(windows.mean(axis=1)))
    return float(windows[best].mean()), float(windows[best].std() / np.sqrt(size)), best + size - 1


def _points(
    model: DiscModel,
    before: DiscModel,
    ground: Ground,
    machine: DisplacementControl,
    threads: int,
    until_failed: bool,
) -> Iterator[Trial | str | None]:
    """Move the loading end of the spring, and with it the discs, to the end of the curve or until they have failed.
    Yields the points of the curve, each a mean over the time since the last point. Then yields None at the end of the
    curve, a little beyond the prescribed displacement ``reach``. The last value is a sentence with the displacement at
    the end of the test and the reason why the test ended.

    Between two points Kh is the force of spring and dashpot over the weight.
    """
    cycle, start = period(model, ground), model.time
    displacement = Displacement(before, ground)
    pulse = min(cycle / PULSES, LARGEST_PHASE / machine.frequency)
    moved, speed, end = 0.0, 0.0, 0.0
    most, count, curving, ended = 0.0, 0, True, ""
    since: list[tuple[float, float]] = []
    with ShortRuns(model, STEP_SHARE, threads) as pulses:
        while curving or not (ended := _end_reason(model, before, ground, machine, moved)):
            driven = machine.speed(moved, cycle)
            end += driven * pulse
            kh = machine.stiffness * (end - moved) + machine.dashpot * (driven - speed)
            model.acceleration = ground.steady(kh)
            then = model.time
            pulses.on(pulse)
            now = displacement(model)
            moved, speed = now, (now - moved) / (model.time - then)
            since.append((moved, kh))
            if curving and moved >= BLOCK * machine.reach * (count + 1):
                pulses.whole()
                there, borne = (float(value) for value in np.mean(since, axis=0))
                yield _point(model, there, borne, most, model.time - start)
                most, count, since = max(most, borne), count + 1, []
            if curving and moved >= LAST_REACH * machine.reach:
                curving = False
                yield None
                if not until_failed:
                    return
        pulses.whole()
    yield f"; the test continued to a displacement of {moved:.2g} m, {ended}"


def _end_reason(model: DiscModel, before: DiscModel, ground: Ground, machine: DisplacementControl, moved: float) -> str:
    """Return the reason why the test ends at this mean displacement (m), in words; empty while the test continues."""
    displacement = np.hypot(model.x - before.x, model.z - before.z)[~model.fixed]
    most = np.percentile(displacement, GROUND_PERCENTILE)
    if most >= BAND_DISPLACEMENT * ground.radius:
        return "where a band of shear has formed"
    if most >= DETACHMENT_RATIO * moved:
        return "where a part has separated from the rest"
    return "at the largest displacement of the test" if moved >= LAST_DISPLACEMENT * machine.reach else ""


def _point(model: DiscModel, moved: float, kh: float, most: float, seconds: float) -> Trial:
    """Return a point of the load-displacement curve, with the largest Kh so far."""
    more = kh > most
    reason = "more than the largest Kh so far" if more else "a larger Kh was reached before"
    ratios = unbalanced_ratio(model), kinetic_ratio(model)
    return Trial(kh, "stands" if more else "fails", reason, *ratios, moved, np.inf, seconds)
