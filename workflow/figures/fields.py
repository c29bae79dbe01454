"""The fields that the finite element analysis leaves, by the names that people ask for them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.continuum.fields import State


@dataclass(frozen=True)
class Field:
    """A field of a state: what it is with its unit, its values by cell or by point, and its colours."""

    label: str
    values: Callable[[State], np.ndarray]
    colours: str = "viridis"
    by_point: bool = False


def _stress(component: int) -> Callable[[State], np.ndarray]:
    return lambda state: state.stress[:, component] / 1e3


FIELDS = {
    "displacement": Field("displacement (m)", lambda state: np.hypot(*state.displacement.T), by_point=True),
    "displacement_x": Field("displacement to the right (m)", lambda state: state.displacement[:, 0], by_point=True),
    "displacement_z": Field("displacement upwards (m)", lambda state: state.displacement[:, 1], by_point=True),
    "mobilised": Field("mobilised share of strength (-)", lambda state: state.mobilised, "YlOrRd"),
    "shear_strain": Field("largest shear strain (-)", lambda state: state.shear_strain, "magma_r"),
    "plastic_shear_strain": Field("plastic shear strain (-)", lambda state: state.plastic_shear_strain, "magma_r"),
    "stress_xx": Field("stress xx (kPa), tension positive", _stress(0)),
    "stress_yy": Field("stress yy (kPa), tension positive", _stress(1)),
    "stress_zz": Field("stress zz (kPa), tension positive", _stress(2)),
    "stress_xy": Field("stress xy (kPa)", _stress(3)),
}
