"""Calibration: which factor on the springs moves the critical Kh of the discs, and which value meets the FEM's.

A factor multiplies the constants of every layer alike, so that what tells the layers apart stays:
stiffness: all springs, dashpots by its square root (the damping ratio stays); friction: of elements and pore springs;
pore_strength: cohesion and stretch at which pore springs break; strength: friction and pore_strength together.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from threading import Event, Lock
from typing import Any, Literal

import numpy as np
from scipy.optimize import brentq

from dem.critical import OnTrial, Search, critical_kh
from dem.equilibrium import NotSettledError, settle
from dem.ground import Ground
from dem.model import DiscModel
from dem.settings import DemSettings, Parameter
from dem.side_by_side import side_by_side
from dem.springs import LayerSprings

PARAMETERS: tuple[Parameter, ...] = ("stiffness", "friction", "pore_strength", "strength")
ONE_AT_A_TIME = PARAMETERS[:3]
SENSITIVITIES = (0.5, 2.0)
RANGE = (0.1, 10.0)

Key = tuple[str, float]  # parameter and factor
OnSearch = Callable[[str, float, Search], None]


@dataclass(frozen=True)
class Calibration:
    """The factor that meets the target, or the closest there is.

    searches: the critical Kh of every parameter and factor that was tried, in the order of trying.
    """

    target: float
    tolerance: float
    parameter: str
    value: float
    range: tuple[float, float]
    verdict: Literal["calibrated", "out of reach"]
    reason: str
    search: Search
    sensitivity: tuple[tuple[str, float, Search], ...]
    trials: tuple[tuple[float, Search], ...]

    def as_json(self) -> dict[str, Any]:
        """The answer, how sensitive the critical Kh is to what, and every trial."""
        return {
            "target_kc": self.target,
            "tolerance": self.tolerance,
            "parameter": self.parameter,
            "value": self.value,
            "range": list(self.range),
            **{key: value for key, value in self.search.as_json().items() if key in ("kc", "kc_lower", "kc_upper")},
            "verdict": self.verdict,
            "reason": self.reason,
            "sensitivity": [
                {"parameter": name, "value": v, **brief(s)}
                for name in ONE_AT_A_TIME
                for p, v, s in sorted(self.sensitivity, key=lambda row: row[1])
                if p in ("", name)
            ],
            "trials": [{"value": v, **brief(s)} for v, s in self.trials],
        }


def brief(search: Search) -> dict[str, Any]:
    """The bracket and the verdict of a search, and the seconds of model time it took."""
    whole = search.as_json()
    kept = {key: whole[key] for key in ("kc", "kc_lower", "kc_upper", "verdict", "reason")}
    return {**kept, "seconds": round(sum(trial.seconds for trial in search.trials), 3)}


def changed(layers: Sequence[LayerSprings], parameter: str, factor: float) -> list[LayerSprings]:
    """The layers with a factor on one parameter. Raises ValueError for a parameter that there is not."""
    if parameter == "stiffness":
        root = float(np.sqrt(factor))
        return [
            replace(
                s, kn=s.kn * factor, ks=s.ks * factor, kpn=s.kpn * factor, kps=s.kps * factor, cn=s.cn * root,
                ct=s.ct * root,
            )
            for s in layers
        ]  # fmt: skip
    if parameter not in PARAMETERS:
        raise ValueError(f"there is no parameter {parameter!r}; there are {', '.join(PARAMETERS)}")
    friction = factor if parameter in ("friction", "strength") else 1.0
    pore = factor if parameter in ("pore_strength", "strength") else 1.0
    return [
        replace(
            s, friction=s.friction * friction, cohesion=s.cohesion * pore, beta=1.0 + (s.beta - 1.0) * pore,
            pore_friction=None if s.pore_friction is None else s.pore_friction * friction,
        )
        for s in layers
    ]  # fmt: skip


class Calibrator:
    """Searches for the critical Kh at any factor, each at most once, some at a time; known ones are taken as they are.

    known: searches of an earlier run. on_trial and on_search hear of every trial and search, on_search once at a time.
    Threads share the work, since the kernels let go of Python's lock; what they find does not depend on their number.
    """

    def __init__(
        self,
        ground: Ground,
        layers: Sequence[LayerSprings],
        settled: DiscModel,
        settings: DemSettings,
        *,
        known: dict[Key, Search] | None = None,
        on_trial: OnTrial | None = None,
        on_search: OnSearch | None = None,
    ) -> None:
        self.ground, self.layers, self.settled, self.settings = ground, list(layers), settled, settings
        self.searches = dict(known or {})
        self.on_trial, self.on_search = on_trial, on_search
        self.stop = Event()
        self.lock = Lock()

    def settled_with(self, parameter: str, factor: float) -> DiscModel:
        """Discs at rest with a factor on a parameter, from the lattice or packing they all start with."""
        if factor == 1.0:
            return self.settled
        return settle(self.ground, changed(self.layers, parameter, factor), self.settings)

    def search(self, parameter: str, factor: float, threads: int = 1) -> Search:
        """The critical Kh with a factor on a parameter."""
        key = (parameter, factor) if factor != 1.0 else ("", 1.0)
        if key in self.searches:
            return self.searches[key]
        try:
            found = critical_kh(
                self.settled_with(parameter, factor), self.ground, self.settings, threads=threads,
                resolution=min(self.settings.resolution, 0.5 * self.settings.tolerance), on_trial=self.on_trial,
                stopped=self.stop.is_set,
            )  # fmt: skip
        except NotSettledError as error:
            found = Search(upper=0.0, verdict="fails under its own weight", reason=str(error))
        with self.lock:
            self.searches[key] = found
            if self.on_search is not None:
                self.on_search(*key, found)
        return found

    def search_all(self, wanted: Sequence[Key]) -> list[Search]:
        """Several searches at a time. On an interrupt all of them stop at their next look."""
        return side_by_side([partial(self.search, *key) for key in wanted], self.settings.workers, self.stop)


def sensitivities(calibrator: Calibrator) -> list[tuple[str, float, Search]]:
    """The critical Kh with each parameter halved and doubled, one at a time."""
    wanted = [("", 1.0), *((p, f) for p in ONE_AT_A_TIME for f in SENSITIVITIES)]
    found = calibrator.search_all(wanted)
    return [(p, f, search) for (p, f), search in zip(wanted, found, strict=True)]


def likeliest(table: Sequence[tuple[str, float, Search]], target: float) -> str:
    """The parameter that halved or doubled brings the critical Kh closest to the target."""
    missed = {(p, f): abs(middle(s) - target) for p, f, s in table if p}
    return min(missed, key=lambda key: missed[key])[0]


def middle(search: Search) -> float:
    """What a search comes to as a number: the middle of its bracket, or the end it ran into."""
    if search.upper is None:
        return search.lower
    return 0.5 * (search.lower + search.upper)


def calibrate(
    calibrator: Calibrator, target: float, parameter: str, table: Sequence[tuple[str, float, Search]]
) -> Calibration:
    """The factor at which the critical Kh is within the tolerance of the target, by Brent's method on its logarithm.

    Bracketed first by what is known of the parameter, then by the ends of the range. Only a search that ended in a
    bracket counts as met.
    """
    settings = calibrator.settings
    low, high = settings.range or RANGE
    tried: dict[float, Search] = {f: s for p, f, s in table if p in ("", parameter) and low <= f <= high}

    def miss(log_factor: float) -> float:
        factor = float(np.exp(log_factor))
        search = tried[factor] = calibrator.search(parameter, factor, settings.workers)
        gap = middle(search) - target
        return 0.0 if _met(search, target, settings.tolerance) else gap

    ends = _bracket(tried, target)
    if ends is None and not any(_met(s, target, settings.tolerance) for s in tried.values()):
        missing = [f for f in (low, high) if f not in tried]
        for factor, search in zip(missing, calibrator.search_all([(parameter, f) for f in missing]), strict=True):
            tried[factor] = search
        ends = _bracket(tried, target)
    if ends is not None and not any(_met(s, target, settings.tolerance) for s in tried.values()):
        known = {float(np.log(f)): middle(tried[f]) - target for f in ends}
        brentq(lambda a: known[a] if a in known else miss(a), *sorted(known), xtol=1e-3, maxiter=20, disp=False)
    value = min(tried, key=lambda f: (tried[f].verdict != "bracketed", abs(middle(tried[f]) - target)))
    met = _met(tried[value], target, settings.tolerance)
    reach = [middle(s) for s in tried.values()]
    reason = (
        f"critical Kh {middle(tried[value]):.4f}, the FEM's is {target:.4f}"
        if met
        else f"{parameter} times {min(tried):.3g} to {max(tried):.3g} reaches critical Kh from {min(reach):.3f} to "
        f"{max(reach):.3f}, closest to {target:.4f} at {value:.3g}: {middle(tried[value]):.4f}"
    )
    return Calibration(
        target, settings.tolerance, parameter, value, (low, high), "calibrated" if met else "out of reach", reason,
        tried[value], tuple(table), tuple(tried.items()),
    )  # fmt: skip


def _met(search: Search, target: float, tolerance: float) -> bool:
    return search.verdict == "bracketed" and abs(middle(search) - target) <= tolerance


def _bracket(tried: dict[float, Search], target: float) -> tuple[float, float] | None:
    """Two neighbouring factors with the target between their critical Kh, the narrowest such pair."""
    factors = sorted(tried)
    pairs = [(a, b) for a, b in pairwise(factors) if (middle(tried[a]) - target) * (middle(tried[b]) - target) < 0.0]
    return min(pairs, key=lambda p: p[1] / p[0]) if pairs else None
