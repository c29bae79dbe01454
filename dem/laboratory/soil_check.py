"""Biaxial tests of the soil discs of every layer as they are in the slope, to compare with the strength map."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dem.errors import DemError
from dem.laboratory.compression import PatchStrength, compress
from dem.laboratory.layer_check import LayerCheck
from dem.laboratory.patch import VOID_RATIO, Sample
from dem.laboratory.soil_layers import SoilLayer
from dem.laboratory.strength import from_principal
from dem.springs import LayerSprings
from meshes.executor import Tell

SEEDS = (101, 102, 103, 104)  # none of those that the map was made with
# Patches whose kappa = kn/p is the same but for a fifth are one: strength hardly depends on it, E on its fourth root.
KAPPAS_PER_DOUBLING = 2

Likeness = tuple[float, float, float, int]


@dataclass(frozen=True)
class ElementTestProgramme:
    """The tests of some layers, as discs of one mean radius, each by several patches at three confining pressures.

    Patches that differ by nothing but their scale, as those of all sands with one angle of friction do, count once.

    Attributes
    ----------
    layers : sequence of SoilLayer
        What is tested.
    wanted : list of (LayerSprings, float)
        Springs and confining pressure (Pa) of every test, layer by layer.
    first : dict
        Those of them that are carried out, by what patches are told by.
    radius : float
        Mean of the discs (m).
    """

    layers: Sequence[SoilLayer]
    wanted: list[tuple[LayerSprings, float]]
    first: dict[Likeness, tuple[LayerSprings, float]]
    radius: float

    @classmethod
    def of(cls, layers: Sequence[SoilLayer], radius: float) -> "ElementTestProgramme":
        """The tests of discs of a mean ``radius`` (m)."""
        wanted = [(layer.springs(radius, VOID_RATIO), float(p)) for layer in layers for p in layer.pressures]
        first: dict[Likeness, tuple[LayerSprings, float]] = {}
        for test in wanted:
            first.setdefault(_alike(*test), test)
        return cls(layers, wanted, first, radius)

    @property
    def patches(self) -> list[tuple[Sample, float]]:
        """The patches to compress, each with its confining pressure (Pa)."""
        return [
            (Sample(spring, "random", self.radius, seed, law="soil"), p)
            for spring, p in self.first.values()
            for seed in SEEDS
        ]

    def checks(self, done: Sequence[PatchStrength | str]) -> list[LayerCheck]:
        """The comparison of every layer with its discs, from the tests ``done`` on its ``patches``."""
        by_kind = {like: done[k * len(SEEDS) : (k + 1) * len(SEEDS)] for k, like in enumerate(self.first)}
        scaled = [
            [_scaled(patch, self.first[like], itself) for patch in by_kind[like]]
            for itself in self.wanted
            for like in [_alike(*itself)]
        ]
        n = len(scaled) // max(1, len(self.layers))
        return [
            _check(layer, self.wanted[k * n][0], [patch for tests in scaled[k * n : (k + 1) * n] for patch in tests])
            for k, layer in enumerate(self.layers)
        ]


def _alike(spring: LayerSprings, pressure: float) -> Likeness:
    """Key of patches that differ by scale alone: mu, ks/kn, C/p, and kappa by its nearest step."""
    kappa = round(KAPPAS_PER_DOUBLING * float(np.log2(spring.kn / pressure)))
    return spring.friction, round(spring.ks / spring.kn, 6), round(spring.contact_cohesion / pressure, 6), kappa


def _scaled(
    patch: PatchStrength | str, tested: tuple[LayerSprings, float], wanted: tuple[LayerSprings, float]
) -> PatchStrength | str:
    """The result of a patch scaled to other springs and another pressure: stresses go with the pressure, E with kn."""
    if isinstance(patch, str):
        return patch
    (spring, pressure), (new_spring, new_pressure) = tested, wanted
    share = new_pressure / pressure
    return replace(
        patch, pressure=new_pressure, E=patch.E * new_spring.kn / spring.kn, peak=patch.peak * share,
        after=patch.after * share, course=patch.course * share,
    )  # fmt: skip


def compressed(task: tuple[Sample, float], _: Tell) -> PatchStrength | str:
    """The result of one compressed patch, or the reason why it has no strength."""
    sample, pressure = task
    try:
        return compress(sample, pressure)
    except (DemError, ValueError) as error:
        return f"{pressure / 1e3:.3g} kPa, seed {sample.seed}: {error}"


def _check(layer: SoilLayer, spring: LayerSprings, patches: Sequence[PatchStrength | str]) -> LayerCheck:
    good = [patch for patch in patches if isinstance(patch, PatchStrength)]
    by_pressure = [[patch for patch in good if patch.pressure == float(p)] for p in layer.pressures]

    def means(key: str) -> tuple[float, ...]:
        return tuple(
            float(np.mean([getattr(patch, key) for patch in at_pressure])) if at_pressure else np.nan
            for at_pressure in by_pressure
        )

    after = np.array(means("after"))
    stratum = layer.stratum
    c, phi = 0.0, float(np.nanmean(np.arcsin(after / (layer.pressures + after))))
    if stratum.cohesion > 0.0 and np.isfinite(after).all():
        c, phi = from_principal(list(layer.pressures + 2.0 * after), list(layer.pressures))
    return LayerCheck(
        stratum=stratum.name,
        pressures_Pa=tuple(map(float, layer.pressures)),
        strength_soil_Pa=tuple(map(float, layer.wanted)),
        strength_discs_Pa=tuple(map(_known, after)),
        peak_discs_Pa=tuple(
            float(np.mean([patch.course for patch in at_pressure], axis=0).max()) if at_pressure else None
            for at_pressure in by_pressure
        ),
        E_soil_Pa=float(stratum.youngs_modulus),
        E_discs_Pa=_known(float(np.nanmean(means("E")))),
        c_soil_Pa=float(stratum.cohesion),
        c_discs_Pa=_known(c),
        phi_soil_deg=float(np.degrees(stratum.friction_angle)),
        phi_discs_deg=_known(np.degrees(phi)),
        dilation_deg=_known(np.degrees(np.nanmean(means("dilation")))),
        friction=spring.friction,
        cohesion_N=spring.contact_cohesion,
        stiffness_N_m=spring.kn,
        notes=(*layer.notes, *(patch for patch in patches if isinstance(patch, str))),
    )


def _known(value: float) -> float | None:
    """A number, or None where there is none."""
    return float(value) if np.isfinite(value) else None
