"""Searches the critical Kh of discs with a factor on some of their constants, each factor once, several at a time.

A factor multiplies constants of all layers: all springs, and dashpots by its square root (parameter stiffness); the
friction of contacts and pore springs (friction); the cohesion of pore springs and the stretch at which they break, or
cohesion and undrained strength of soil discs (pore_strength); friction and cohesion (strength); or all of these
constants (all).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dem.errors import DemError
from dem.ground import Ground
from dem.model import DiscModel
from dem.search.critical import OnTrial, Search, critical_kh
from dem.search.equilibrium import settle
from dem.search.pushover import Continuum, pushover_critical_kh
from dem.settings import DemSettings, Parameter
from dem.springs import LayerSprings
from meshes.executor import SERIAL, Executor, Tell

PARAMETERS: tuple[Parameter, ...] = ("stiffness", "friction", "pore_strength", "strength", "all")

Key = tuple[str, float]  # parameter and factor
OnSearch = Callable[[str, float, Search], None]


def changed(layers: Sequence[LayerSprings], parameter: str, factor: float) -> list[LayerSprings]:
    """Return the layers with a factor on the constants of one parameter.

    Parameters
    ----------
    layers : springs of the layers; not changed
    parameter : one of `PARAMETERS`, see the docstring of this module
    factor : factor on these constants; dashpots are multiplied by the square root of the factor on the stiffness

    Returns
    -------
    Springs of the layers, in the same order.

    Raises
    ------
    ValueError
        If there is no such parameter.
    """
    if parameter not in PARAMETERS:
        raise ValueError(f"there is no parameter {parameter!r}; expected one of {', '.join(PARAMETERS)}")
    stiffness = factor if parameter in ("stiffness", "all") else 1.0
    friction = factor if parameter in ("friction", "strength", "all") else 1.0
    pore = factor if parameter in ("pore_strength", "strength", "all") else 1.0
    root = float(np.sqrt(stiffness))
    return [
        replace(
            s, kn=s.kn * stiffness, ks=s.ks * stiffness, kpn=s.kpn * stiffness, kps=s.kps * stiffness,
            cn=s.cn * root, ct=s.ct * root, friction=s.friction * friction, cohesion=s.cohesion * pore,
            contact_cohesion=s.contact_cohesion * pore, undrained_strength=s.undrained_strength * pore,
            beta=1.0 + (s.beta - 1.0) * pore,
            pore_friction=None if s.pore_friction is None else s.pore_friction * friction,
            undisturbed_friction=None if s.undisturbed_friction is None else s.undisturbed_friction * friction,
        )
        for s in layers
    ]  # fmt: skip


def key_of(parameter: str, factor: float) -> Key:
    """Return the key of a search in the table of searches.

    Parameters
    ----------
    parameter : name of the constants that the factor multiplies
    factor : the factor

    Returns
    -------
    Parameter and factor; ("", 1.0) for a factor of 1, which belongs to no parameter.
    """
    return (parameter, factor) if factor != 1.0 else ("", 1.0)


def middle(search: Search) -> float:
    """Return the critical Kh of a search as one number.

    Parameters
    ----------
    search : result of a search, with or without a bracket

    Returns
    -------
    The mean of the bracket; without an upper end, the largest Kh at which the discs stood.
    """
    if search.kc_upper is None:
        return search.kc_lower
    return 0.5 * (search.kc_lower + search.kc_upper)


class Calibrator:
    """Searches the critical Kh at given factors, each factor once, several at a time.

    Parameters
    ----------
    ground
        Packing of the discs, and its place in the section.
    layers
        Uncalibrated springs of the layers.
    settled
        The discs at rest.
    settings
        Settings of the searches.
    continuum
        The FEM model that soil discs are calibrated to; it determines the displacement at the end of the test.
    known
        Searches of an earlier run, which are not repeated.
    on_trial, on_search
        Called with every trial in this process, and with every search.
    executor
        Executor of several searches.
    until_failed
        Whether the test of soil discs continues beyond the critical Kh until they have failed.
    threads
        Threads of a search that is done alone; searches of the executor have one each.

    ``displaced`` holds the discs at the end of every displacement-controlled test in this process, and ``rested`` soil
    discs at rest, by parameter and factor.
    """

    def __init__(
        self,
        ground: Ground,
        layers: Sequence[LayerSprings],
        settled: DiscModel,
        settings: DemSettings,
        *,
        continuum: Continuum | None = None,
        known: dict[Key, Search] | None = None,
        on_trial: OnTrial | None = None,
        on_search: OnSearch | None = None,
        executor: Executor = SERIAL,
        until_failed: bool = True,
        threads: int = 1,
    ) -> None:
        self.ground, self.layers, self.settled, self.settings = ground, list(layers), settled, settings
        self.continuum, self.until_failed, self.threads = continuum, until_failed, threads
        self.searches = dict(known or {})
        self.displaced: dict[Key, DiscModel] = {}
        self.rested: dict[Key, DiscModel] = {}
        self.on_trial, self.on_search, self.executor = on_trial, on_search, executor

    def __getstate__(self) -> dict[str, Any]:
        """Return the state to pickle for another process, without listeners and known searches."""
        nothing: dict[str, Any] = {"searches": {}, "displaced": {}, "rested": {}}
        return self.__dict__ | nothing | {"on_trial": None, "on_search": None, "executor": SERIAL, "threads": 1}

    def settled_with(self, parameter: str, factor: float) -> DiscModel:
        """Return discs at rest with a factor on a parameter.

        Discs with the law "paper" start again from the initial lattice or packing. Soil discs start from the state of
        rest with uncalibrated strength, since their surface is already cut to that of the section.
        """
        if factor == 1.0:
            return self.settled
        if self.settings.model != "soil":
            return settle(self.ground, changed(self.layers, parameter, factor), self.settings)
        key, layers = (parameter, factor), changed(self.layers, parameter, factor)
        if key not in self.rested:
            self.rested[key] = settle(self.ground, layers, self.settings, self.settled.copy())
        return self.rested[key]

    def search(self, parameter: str, factor: float, *, fine: bool = True) -> Search:
        """Return the critical Kh with a factor on a parameter; fine: to half the tolerance or better."""
        key = key_of(parameter, factor)
        if key in self.searches:
            return self.searches[key]
        try:
            search = self._searched(key, self.settled_with(parameter, factor), fine)
        except DemError as error:  # critical_kh hands none on: the discs did not settle
            search = Search(kc_upper=0.0, verdict="fails under its own weight", reason=str(error))
        self._know(key, search)
        return search

    def _know(self, key: Key, search: Search) -> None:
        self.searches[key] = search
        if self.on_search is not None:
            self.on_search(*key, search)

    def _searched(self, key: Key, settled: DiscModel, fine: bool) -> Search:
        settings = self.settings
        if settings.model == "soil":
            if self.continuum is None:
                raise ValueError("soil discs need the yield displacement of the continuum: give `continuum`")
            search, self.displaced[key] = pushover_critical_kh(
                settled, self.ground, settings, self.continuum, threads=self.threads, on_trial=self.on_trial,
                until_failed=self.until_failed,
            )  # fmt: skip
            return search
        width = settings.resolution
        return critical_kh(
            settled, self.ground, settings, threads=self.threads,
            resolution=min(width, 0.5 * settings.tolerance) if fine else width,
            on_trial=self.on_trial,
        )  # fmt: skip

    def search_all(self, wanted: Sequence[Key], *, fine: bool = True) -> list[Search]:
        """Do several searches by the executor; known searches are not repeated."""
        new = [key for key in wanted if key not in self.searches]
        if self.executor.count < 2 or len(new) < 2:
            return [self.search(*key, fine=fine) for key in wanted]
        self.executor.compute(
            _search_task, [(self, *key, fine) for key in new], done=lambda k, search: self._know(new[k], search)
        )
        return [self.searches[key] for key in wanted]


def _search_task(task: tuple[Calibrator, str, float, bool], _: Tell) -> Search:
    """Return the result of one search for the critical Kh, as a task of the executor."""
    calibrator, parameter, factor, fine = task
    return calibrator.search(parameter, factor, fine=fine)
