"""The shaking of a uniform slope of the collection."""

from pathlib import Path

import numpy as np

from dem.slides.drive import cyclic_acceleration
from docs.verify.slides.case import UniformSlope
from meshes.section.quantity import GRAVITY
from workflow.earthquake import accelerogram

SUDDEN = 1e-3  # s in which a constant Kh comes, and in which it goes


def shaking_of_slope(wanted: UniformSlope, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """What the ground feels: Kh held for some seconds, cycles of it, or a record with its peak.

    Parameters
    ----------
    wanted : UniformSlope
        The problem.
    folder : Path
        Where its record lies.

    Returns
    -------
    time, push : ndarray (n,)
        Times from 0 (s), and accelerations along the horizontal (m/s²), downhill positive.
    """
    if wanted.seconds is not None:
        time = np.array([0.0, SUDDEN, wanted.seconds, wanted.seconds + SUDDEN])
        return time, wanted.kh * GRAVITY * np.array([0.0, 1.0, 1.0, 0.0])
    if not wanted.record:
        return cyclic_acceleration(wanted.kh, wanted.cycles or 1.0, wanted.period)
    record = accelerogram.read(folder / wanted.record)
    return record.time - record.time[0], record.acceleration * (wanted.kh * GRAVITY / record.peak)
