"""Every layer of soil discs tested once more as it stands in the slope: what the map promised, is it so?"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from threading import Event

import numpy as np

from dem.errors import DemError
from dem.laboratory.compression import PatchStrength, compress
from dem.laboratory.patch import Sample
from dem.laboratory.soil_layers import SoilLayer
from dem.laboratory.strength import from_principal
from dem.side_by_side import StoppedError, side_by_side
from dem.springs import LayerSprings

SEEDS = (101, 102, 103, 104)  # none of those that the map was made with


@dataclass(frozen=True)
class LayerCheck:
    """A stratum beside its discs, each tested at three confining pressures; means over the seeds.

    Attributes
    ----------
    stratum : str
        Its name.
    pressures_Pa, strength_soil_Pa, strength_discs_Pa, peak_discs_Pa : (3,)
        Confining pressures, and half the deviator: of the soil at failure, of the discs after their peak and there.
    E_soil_Pa, E_discs_Pa : float
        Young's modulus; that of the discs at small strain.
    c_soil_Pa, c_discs_Pa, phi_soil_deg, phi_discs_deg : float
        Of the discs: the line of Mohr and Coulomb through the strengths after the peak; through the origin where the
        soil has no cohesion.
    dilation_deg : float
        At the peak.
    friction, cohesion_N, stiffness_N_m : float
        mu, C and kn of the contacts.
    notes : tuple of str
        What discs cannot have, and tests that could not be done.
    """

    stratum: str
    pressures_Pa: tuple[float, ...]  # noqa: N815
    strength_soil_Pa: tuple[float, ...]  # noqa: N815
    strength_discs_Pa: tuple[float, ...]  # noqa: N815
    peak_discs_Pa: tuple[float, ...]  # noqa: N815
    E_soil_Pa: float
    E_discs_Pa: float
    c_soil_Pa: float  # noqa: N815
    c_discs_Pa: float  # noqa: N815
    phi_soil_deg: float
    phi_discs_deg: float
    dilation_deg: float
    friction: float
    cohesion_N: float  # noqa: N815
    stiffness_N_m: float  # noqa: N815
    notes: tuple[str, ...]


def soil_checks(
    layers: Sequence[SoilLayer],
    springs: Sequence[LayerSprings],
    radius: float,
    *,
    workers: int = 1,
    stop: Event | None = None,
) -> list[LayerCheck]:
    """All layers, some patches at a time. On an interrupt, or once `stop` is set, all end within an interval."""
    stop = stop or Event()

    def watch() -> None:
        if stop.is_set():
            raise StoppedError

    def work(spring: LayerSprings, pressure: float, seed: int) -> PatchStrength | str:
        try:
            return compress(Sample(spring, "random", radius, seed, law="soil"), pressure, watch)
        except (DemError, ValueError) as error:
            return f"{pressure / 1e3:.3g} kPa, seed {seed}: {error}"

    jobs = [
        partial(work, spring, float(pressure), seed)
        for layer, spring in zip(layers, springs, strict=True)
        for pressure in layer.pressures
        for seed in SEEDS
    ]
    found = side_by_side(jobs, workers, stop)
    each = len(found) // max(1, len(layers))
    return [
        _check(layer, spring, found[k * each : (k + 1) * each])
        for k, (layer, spring) in enumerate(zip(layers, springs, strict=True))
    ]


def _check(layer: SoilLayer, spring: LayerSprings, found: Sequence[PatchStrength | str]) -> LayerCheck:
    good = [one for one in found if isinstance(one, PatchStrength)]
    by_pressure = [[one for one in good if one.pressure == float(p)] for p in layer.pressures]

    def means(key: str) -> tuple[float, ...]:
        return tuple(float(np.mean([getattr(one, key) for one in ones])) if ones else np.nan for ones in by_pressure)

    after = np.array(means("after"))
    stratum = layer.stratum
    c, phi = 0.0, float(np.nanmean(np.arcsin(after / (layer.pressures + after))))
    if stratum.cohesion > 0.0 and np.isfinite(after).all():
        c, phi = from_principal(list(layer.pressures + 2.0 * after), list(layer.pressures))
    return LayerCheck(
        stratum=stratum.name,
        pressures_Pa=tuple(map(float, layer.pressures)),
        strength_soil_Pa=tuple(map(float, layer.wanted)),
        strength_discs_Pa=tuple(map(float, after)),
        peak_discs_Pa=means("peak"),
        E_soil_Pa=float(stratum.youngs_modulus),
        E_discs_Pa=float(np.nanmean(means("E"))),
        c_soil_Pa=float(stratum.cohesion),
        c_discs_Pa=c,
        phi_soil_deg=float(np.degrees(stratum.friction_angle)),
        phi_discs_deg=float(np.degrees(phi)),
        dilation_deg=float(np.degrees(np.nanmean(means("dilation")))),
        friction=spring.friction,
        cohesion_N=spring.contact_cohesion,
        stiffness_N_m=spring.kn,
        notes=(*layer.notes, *(one for one in found if isinstance(one, str))),
    )
