"""Runs biaxial tests of the soil discs of every layer, to be compared with the soil."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dem.laboratory.compression import PatchStrength
from dem.laboratory.contact_numbers import PRESSURE, ContactNumbers
from dem.laboratory.layer_check import LayerCheck
from dem.laboratory.patch import VOID_RATIO
from dem.laboratory.soil_contacts import SoilLayer
from dem.laboratory.stored_strengths import is_stored, strength_of_patch
from dem.laboratory.strength import from_principal, known
from dem.springs import LayerSprings
from meshes.executor import Tell

SEEDS = (101, 102, 103, 104)  # none of those that the map was made with

Task = tuple[ContactNumbers, int]  # a patch, and the seed of its packing
TestOutcome = PatchStrength | str  # the result of a test, or the reason why there is none


@dataclass(frozen=True)
class ElementTestProgramme:
    """Tests the discs of some layers: several patches for each layer at three confining pressures.

    Similar contacts, as those of one sand at two pressures, share their patches, which have rounded dimensionless
    numbers (`ContactNumbers.nearest`). Strength and stiffness are corrected by a few per cent: by the ratio of the
    strength map at the numbers of the layer to the strength map at the rounded numbers.

    Attributes
    ----------
    layers : the layers to be tested
    radius : mean radius of the discs (m)
    """

    layers: Sequence[SoilLayer]
    radius: float

    @property
    def tasks(self) -> list[Task]:
        """Return the patches to compress."""
        kinds = dict.fromkeys(
            ContactNumbers.of(layer, float(p)).nearest for layer in self.layers for p in layer.pressures
        )
        return [(kind, seed) for kind in kinds for seed in SEEDS]

    @property
    def is_stored(self) -> bool:
        """Return whether all patches were compressed in earlier runs, whose results are stored."""
        return all(is_stored(*task) for task in self.tasks)

    def checks(self, done: Sequence[TestOutcome]) -> list[LayerCheck]:
        """Return the comparison of every layer with its discs, from the results of the ``tasks``."""
        outcomes = dict(zip(self.tasks, done, strict=True))
        return [self._check(layer, outcomes) for layer in self.layers]

    def _check(self, layer: SoilLayer, outcomes: dict[Task, TestOutcome]) -> LayerCheck:
        patches = [
            _scaled_outcome(outcomes[numbers.nearest, seed], numbers, float(p), seed)
            for p in layer.pressures
            for numbers in [ContactNumbers.of(layer, float(p))]
            for seed in SEEDS
        ]
        return _layer_check(layer, layer.springs(self.radius, VOID_RATIO), patches)


def compressed(task: Task, _: Tell) -> TestOutcome:
    """Compress one patch, as a task of an executor.

    Parameters
    ----------
    task : dimensionless numbers of the contacts, and seed of the packing
    _ : messages to the executor, of which there are none

    Returns
    -------
    The strength of the patch at `contact_numbers.PRESSURE`, or the reason why it has none.
    """
    return strength_of_patch(*task)


def _scaled_outcome(patch: TestOutcome, numbers: ContactNumbers, pressure: float, seed: int) -> TestOutcome:
    """Return the result of a patch, converted to other dimensionless numbers and another pressure (Pa)."""
    if isinstance(patch, str):
        return f"{pressure / 1e3:.3g} kPa, seed {seed}, scaled to {PRESSURE / 1e3:.3g} kPa: {patch}"
    near = numbers.nearest
    share = numbers.strength / near.strength * pressure / PRESSURE
    stiffer = numbers.modulus * numbers.stiffness * pressure / (near.modulus * near.stiffness * PRESSURE)
    return replace(
        patch, pressure=pressure, E=patch.E * stiffer, peak=patch.peak * share, post_peak=patch.post_peak * share,
        course=patch.course * share,
    )  # fmt: skip


def _layer_check(layer: SoilLayer, spring: LayerSprings, patches: Sequence[PatchStrength | str]) -> LayerCheck:
    good = [patch for patch in patches if isinstance(patch, PatchStrength)]
    by_pressure = [[patch for patch in good if patch.pressure == float(p)] for p in layer.pressures]

    def means(key: str) -> tuple[float, ...]:
        return tuple(
            float(np.mean([getattr(patch, key) for patch in at_pressure])) if at_pressure else np.nan
            for at_pressure in by_pressure
        )

    post_peak = np.array(means("post_peak"))
    stratum = layer.stratum
    c, phi = 0.0, float(np.nanmean(np.arcsin(post_peak / (layer.pressures + post_peak))))
    if stratum.cohesion > 0.0 and np.isfinite(post_peak).all():
        c, phi = from_principal(list(layer.pressures + 2.0 * post_peak), list(layer.pressures))
    return LayerCheck(
        stratum=stratum.name,
        pressures_Pa=tuple(map(float, layer.pressures)),
        strength_soil_Pa=tuple(map(float, layer.required_strength)),
        strength_discs_Pa=tuple(map(known, post_peak)),
        peak_discs_Pa=tuple(
            float(np.mean([patch.course for patch in at_pressure], axis=0).max()) if at_pressure else None
            for at_pressure in by_pressure
        ),
        E_soil_Pa=float(stratum.youngs_modulus),
        E_discs_Pa=known(float(np.nanmean(means("E")))),
        c_soil_Pa=float(stratum.cohesion),
        c_discs_Pa=known(c),
        phi_soil_deg=float(np.degrees(stratum.friction_angle)),
        phi_discs_deg=known(np.degrees(phi)),
        dilation_deg=known(np.degrees(np.nanmean(means("dilation")))),
        friction=spring.friction,
        cohesion_N=spring.contact_cohesion,
        stiffness_N_m=spring.kn,
        notes=(*layer.notes, *(patch for patch in patches if isinstance(patch, str))),
    )
