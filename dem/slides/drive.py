"""Defines the loading of a slide, and times of liquefaction: constant or cyclic Kh, or a record of the base."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

import numpy as np

from dem.acceleration import Acceleration, half_cosine
from dem.ground import Ground
from dem.liquefied_ground import FADING_STEPS
from dem.model import DiscModel
from dem.settings import SlideSettings
from dem.springs import Law
from meshes.section.quantity import GRAVITY

# s in which Kh comes on before anything liquefies; in the paper all happens at once. Soil discs have the stiffness of
# their soil, and the shock would move them several times as far as Kh does
LEAD_TIME: Mapping[Law, float] = {"paper": 0.0, "soil": 2.0}
FALL_TIME = 1.0  # s in which a constant Kh ends, so that the ground is not shocked
TIME_TOLERANCE = 1e-6  # s: difference up to which two times are equal
# Of a step of the onset: the engine stops up to half a time step before a step ends.
STEP_TOLERANCE = 0.02
SHORTEST_RISE = 1e-3  # s in which the Kh of the paper rises
STEP_DURATION = 1e-6  # s between the two ends of a step of a record
POINTS_PER_CYCLE = 64  # points in time
TAPER_CYCLES = 1.0  # cycles of the taper at the beginning and at the end; half of each counts


@dataclass(frozen=True, eq=False)
class Shaking:
    """Holds the acceleration of a slide in time, and the time at which each stratum begins to liquefy.

    The acceleration is a record of the base, or that of the ground. Base and fixed discs move as one rigid body. In the
    frame of the base, the acceleration of the base, with the opposite sign, acts on the full mass of the discs. For a
    box and for periodic sides the change of frame is exact. Cycles of Kh, and the average acceleration of the soil,
    contain the response of the ground already, so that the base is compliant then (`dem.engine.compliant_base`).

    Attributes
    ----------
    time (n,) : times (s), rising
    acceleration (n,) : acceleration of the discs relative to the base (m/s2), linear in between. The acceleration is
        positive downslope, when the base accelerates upslope.
    onsets : onset of liquefaction by stratum (s after the beginning of the record)
    of_the_base : whether the record is the motion of a rigid base
    """

    time: np.ndarray
    acceleration: np.ndarray
    onsets: Mapping[int, float]
    of_the_base: bool = False


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """Holds the loading of a slide: base motion and onset of liquefaction, in s since the beginning of the slide.

    Attributes
    ----------
    acceleration : external acceleration of the discs in the frame of the base
    starts : time at which each stratum begins to liquefy
    first_onset : first time at which a stratum liquefies, or could liquefy (s)
    onset : time in which each stratum liquefies (s)
    rest_from : time before which the slide does not end, even if the ground is at rest (s)
    end : time at which the computation ends (s)
    """

    acceleration: Acceleration
    starts: Mapping[int, float]
    first_onset: float
    onset: float
    rest_from: float
    end: float

    def share(self, stratum: int, since: float) -> float:
        """Return the degree of liquefaction of a stratum, 0 to 1: in the middle of the step that begins, so that it is
        neither early nor late on average."""
        since -= self.starts[stratum]
        if since < -TIME_TOLERANCE or self.onset == 0.0:
            return float(since >= -TIME_TOLERANCE)
        steps = np.floor(FADING_STEPS * since / self.onset + STEP_TOLERANCE)
        return 1.0 if steps >= FADING_STEPS else float((steps + 0.5) / FADING_STEPS)

    def wait(self, since: float, longest: float) -> float:
        """Return the time to the next change of springs (s), at most ``longest``."""
        starts = {self.first_onset, *self.starts.values()}
        waits = [start - since for start in starts if start - since > TIME_TOLERANCE]
        going = self.onset > 0.0 and any(-TIME_TOLERANCE <= since - start < self.onset for start in starts)
        return min([longest, *waits, *([self.onset / FADING_STEPS] if going else [])])


def cycles(
    settings: SlideSettings, strata: Sequence[int], law: Law = "soil", passed: Mapping[int, float] | None = None
) -> Shaking | None:
    """Return cycles of Kh after a pause of one onset, in which ground that liquefies at the beginning liquefies.

    Parameters
    ----------
    settings : settings of the slide: ``kh``, ``kh_cycles``, ``kh_period`` (s), and ``liquefies_at``, s after the pause,
        or "F_L"
    strata : numbers of the strata that liquefy
    law : contact law of the discs, which determines the onset
    passed : share of the cycles after which each stratum has fully liquefied, for "F_L"; missing strata liquefy at the
        beginning

    Returns
    -------
    The cycles; None if Kh is zero or not cyclic.
    """
    if settings.kh_cycles is None or settings.kh_period is None or settings.kh == 0.0:
        return None
    onset = settings.onset_of(law)
    time, acceleration = cyclic_acceleration(settings.kh, settings.kh_cycles, settings.kh_period)
    time, acceleration = np.append(0.0, time + onset + STEP_DURATION), np.append(0.0, acceleration)
    if settings.liquefies_at != "F_L":
        return Shaking(time, acceleration, dict.fromkeys(strata, onset + settings.liquefies_at))
    over, shares = settings.kh_cycles * settings.kh_period, passed or {}
    return Shaking(time, acceleration, {k: over * shares.get(k, 0.0) for k in strata})


def signed_kh(settings: SlideSettings, lower_end: int) -> float:
    """Return the constant Kh of slides.

    Parameters
    ----------
    settings : settings of the slide: ``kh``, ``kh_towards``
    lower_end : direction in which slides are positive, see `meshes.section.polyline.downhill`

    Returns
    -------
    Kh (-), positive if it acts as positive slides go.
    """
    match settings.kh_towards:
        case "left":
            return -settings.kh * lower_end
        case "right":
            return settings.kh * lower_end
        case None:
            return settings.kh
        case _:
            assert_never(settings.kh_towards)


def constant_kh_in_time(settings: SlideSettings, lower_end: int, law: Law) -> tuple[np.ndarray, np.ndarray]:
    """Return the constant Kh of slides in time. It begins and ends along half cosines.

    Half of it has gone ``kh_seconds`` after the layers have liquefied: it gives a rigid block the velocity of a Kh that
    ends at once. It acts while the layers liquefy, too. Ground whose strength falls below the shear stress by Kh
    before it has liquefied slides from then on, as a block does whose strength falls.

    Parameters
    ----------
    settings : settings of the slide: ``kh``, ``kh_seconds``, ``kh_towards``, ``onset``
    lower_end : direction in which slides are positive, see `meshes.section.polyline.downhill`
    law : contact law of the discs, "soil" for material points

    Returns
    -------
    Times (n,) in s since Kh began to rise, increasing, and Kh (n,) at these times; it is constant after the last one.
    """
    lead, onset, kh = LEAD_TIME[law], settings.onset_of(law), signed_kh(settings, lower_end)
    s, share = half_cosine()
    times, values = (lead or max(onset, SHORTEST_RISE)) * s, kh * share
    if settings.kh_seconds is None:
        return times, values
    seconds = max(settings.kh_seconds, 2.0 * SHORTEST_RISE)
    falls = lead + onset + seconds + min(FALL_TIME, 2.0 * seconds) * (s - 0.5)
    later = falls > times[-1]
    return np.append(times, falls[later]), np.append(values, kh * (1.0 - share[later]))


def constant_kh(start: DiscModel, ground: Ground, strata: Sequence[int], settings: SlideSettings) -> BaseMotion:
    """Return the loading by a constant Kh, under which all strata liquefy together. Strata of soil discs liquefy once
    Kh has its full value, and ``kh_seconds`` count from the time at which they have liquefied.

    start: discs at rest; ground: the ground in which the discs lie; settings: settings of the slide.
    """
    lead, onset = LEAD_TIME[start.law], settings.onset_of(start.law)
    begin = lead + onset
    times, kh = constant_kh_in_time(settings, ground.downhill, start.law)
    return BaseMotion(
        acceleration=ground.horizontal_acceleration(start.time + times, GRAVITY * kh),
        starts=dict.fromkeys(strata, lead),
        first_onset=lead,
        onset=onset,
        rest_from=begin if settings.kh_seconds is None else begin + settings.kh_seconds + 1.0,
        end=settings.duration,
    )  # fmt: skip


def recorded_motion(
    start: DiscModel, ground: Ground, strata: Sequence[int], settings: SlideSettings, shaking: Shaking
) -> BaseMotion:
    """Return the loading by a record of the base; each stratum liquefies at its onset.

    start: discs at rest; ground: the ground in which the discs lie; strata: numbers of the strata that liquefy;
    settings: settings of the slide; shaking: acceleration of the base, and onsets (s).
    """
    over, onset = float(shaking.time[-1] - shaking.time[0]), settings.onset_of(start.law)
    starts = {k: shaking.onsets[k] for k in strata}
    first_onset = min(starts.values(), default=0.0)
    return BaseMotion(
        acceleration=ground.recorded_acceleration(shaking.time - shaking.time[0] + start.time, shaking.acceleration),
        starts=starts,
        first_onset=first_onset,
        onset=onset,
        rest_from=max([over, *(begin + onset for begin in starts.values())]),
        end=over + settings.duration,
    )


def cyclic_acceleration(kh: float, cycles: float, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the acceleration Kh g cos(2 π t / T), which rises in the first cycle and fades in the last one.

    The acceleration is the derivative of a velocity Kh g T/(2 π) w(t) sin(2 π t / T) with w a half cosine at either
    end, so that the base has no mean velocity: without the half cosines it would drift away from liquefied ground.

    Parameters
    ----------
    kh : amplitude of the seismic coefficient (-)
    cycles : equivalent number of cycles with this amplitude: the first and the last count as half a cycle each
    period : period T of a cycle (s)

    Returns
    -------
    Times (n,) from 0 (s), and acceleration (n,) of the mass of the ground (m/s2), which begins and ends with 0.

    Raises
    ------
    ValueError
        If cycles or period are not positive.
    """
    if not (cycles > 0.0 and period > 0.0):
        raise ValueError(f"expected positive cycles and a positive period, not {cycles} and {period} s")
    last = max(cycles, TAPER_CYCLES) + TAPER_CYCLES  # in cycles; at least one cycle has full amplitude
    phase = np.linspace(0.0, last, int(np.ceil(POINTS_PER_CYCLE * last)) + 1)
    inside = np.clip(np.minimum(phase, last - phase) / TAPER_CYCLES, 0.0, 1.0)
    window = 0.5 - 0.5 * np.cos(np.pi * inside)
    rises = np.where(phase < 0.5 * last, 1.0, -1.0) * 0.5 * np.pi * np.sin(np.pi * inside) / TAPER_CYCLES  # a cycle
    acceleration = window * np.cos(2.0 * np.pi * phase) + rises * np.sin(2.0 * np.pi * phase) / (2.0 * np.pi)
    return period * phase, kh * GRAVITY * acceleration
