"""Computes the response of the layers under a point of a section to a record of the rock below them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meshes.errors import InputError
from meshes.section.cutting import unknown_strata, value_of_stratum
from meshes.section.overburden import outside, overburden
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from workflow.earthquake import accelerogram
from workflow.earthquake.settings import SiteResponseSettings
from workflow.earthquake.site_response import ColumnLayer, HalfSpace, Response, response

THICKEST_SUBLAYER = 1.0  # m: layers are divided, so that strains are reported with depth
K0_OF_COLUMN = 0.5  # horizontal over vertical effective stress, for the mean that stiffness depends on
MAKDISI = "F. I. Makdisi, H. B. Seed, J. Geotech. Eng. Div. 104 (1978) 849-867"


@dataclass(frozen=True, eq=False)
class ResponseColumn:
    """Holds the response of a column of layers under a point of a section.

    Attributes
    ----------
    x : position of the column (m)
    record : name of the record
    step : time step (s)
    outcrop (t,) : acceleration of the rock where it crops out (m/s²)
    strata (n,) : name of the stratum of each layer
    response : the response of the n layers
    """

    x: float
    record: str
    step: float
    outcrop: np.ndarray
    strata: tuple[str, ...]
    response: Response

    def average_above(self, depth: float) -> np.ndarray:
        """Return the average acceleration (m/s²) over time of the soil above a depth (m), at the nearest bottom of a
        layer."""
        return np.asarray(self.response.average[int(np.argmin(np.abs(self.response.depth[1:] - depth)))])

    def k_max(self, depth: float) -> float:
        """Return the peak of the average acceleration, in either direction, over gravity: the seismic coefficient of
        the soil above (-)."""
        return float(np.abs(self.average_above(depth)).max()) / GRAVITY


def column_of(section: Section, settings: SiteResponseSettings) -> ResponseColumn:
    """Compute the response of a section to the record that the settings name.

    Strata are divided into layers of at most 1 m. V_s is measured, or √(G/ρ) by E and ν of the stratum.

    Parameters
    ----------
    section : the ground
    settings : record, position, V_s and plasticity of strata, and the rock below

    Returns
    -------
    The response of the layers, from the surface down, in steps of the smallest time step of the record.

    Raises
    ------
    InputError : No record is given, or the record cannot be read; the position lies outside the section, a stratum is
        unknown, or the record is too strong for equivalent linear layers.
    """
    if not settings.record:
        raise InputError(section.name, ["site_response, record: missing; expected a file with a record of the rock"])
    record = accelerogram.read(Path(settings.record), settings.unit, settings.component).scaled(settings.scale)
    left, right = section.given_extent
    x = 0.5 * (left + right) if settings.x is None else float(settings.x)
    problems = [f"site_response, {text}" for text in [outside(section, x, 0.0)] if text]
    names = [stratum.name for stratum in section.strata]
    for key in ("velocities", "plasticity"):
        unknown = sorted(unknown_strata(getattr(settings, key), names))
        problems += [f'site_response, {key}: there is no stratum "{name}"' for name in unknown]
    if problems:
        raise InputError(section.name, problems)
    layers, strata = _layers(section, settings, x)
    step = float(np.min(np.diff(record.time)[np.diff(record.time) > 0.0]))
    time = np.arange(record.time[0], record.time[-1] + 0.5 * step, step)
    outcrop = np.interp(time, record.time, record.acceleration)
    try:
        motion = response(layers, HalfSpace(settings.base_density, settings.base_velocity), step, outcrop)
    except ValueError as error:
        message = (
            f"site_response: {error}: too strong a record for equivalent linear layers; expected a nonlinear analysis"
        )
        raise InputError(section.name, [message]) from None
    return ResponseColumn(x, record.name, step, outcrop, strata, motion)


def _layers(section: Section, settings: SiteResponseSettings, x: float) -> tuple[list[ColumnLayer], tuple[str, ...]]:
    levels = section.layering.interfaces(np.array([x]))[0]
    layers, strata = [], []
    for k, stratum in enumerate(section.strata):
        thick = float(levels[k] - levels[k + 1])
        if thick <= 1e-6:
            continue
        count = max(1, int(np.ceil(thick / THICKEST_SUBLAYER)))
        density = stratum.density_seismic
        measured = value_of_stratum(settings.velocities, stratum.name)
        velocity = measured or float(np.sqrt(stratum.youngs_modulus / (2.0 * density * (1.0 + stratum.poissons_ratio))))
        for part in range(count):
            depth = float(levels[0] - levels[k]) + (part + 0.5) * thick / count
            stress = overburden(section, x, depth).effective * (1.0 + 2.0 * K0_OF_COLUMN) / 3.0
            plastic = value_of_stratum(settings.plasticity, stratum.name) or 0.0
            layers.append(ColumnLayer(thick / count, density, velocity, stress, plastic))
            strata.append(stratum.name)
    return layers, tuple(strata)
