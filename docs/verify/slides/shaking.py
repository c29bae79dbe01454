"""Provides the shaking of a uniform slope of the collection."""

from pathlib import Path

import numpy as np

from dem.slides.drive import cyclic_acceleration
from docs.verify.slides.case import UniformSlope
from meshes.section.quantity import GRAVITY
from workflow.earthquake import accelerogram

RISE_TIME = 1e-3  # s in which a constant Kh is applied, and removed


def shaking_of_slope(wanted: UniformSlope, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the acceleration of a uniform slope: a constant Kh for some seconds, cycles of Kh, or a record scaled to
    its peak.

    Parameters
    ----------
    wanted : the slope
    folder : folder of its record

    Returns
    -------
    time (n,) : times from 0 (s)
    acceleration (n,) : horizontal acceleration of the ground (m/s²), positive downslope
    """
    if wanted.seconds is not None:
        time = np.array([0.0, RISE_TIME, wanted.seconds, wanted.seconds + RISE_TIME])
        return time, wanted.kh * GRAVITY * np.array([0.0, 1.0, 1.0, 0.0])
    if not wanted.record:
        return cyclic_acceleration(wanted.kh, wanted.cycles or 1.0, wanted.period)
    record = accelerogram.read(folder / wanted.record)
    return record.time - record.time[0], record.acceleration * (wanted.kh * GRAVITY / record.peak)
