"""Writes material points as VTK files, in the section's frame, with the fields that discs have."""

import numpy as np
import pyvista as pv

from fem.kernels.material_points import VOLUME
from fem.mpm import PointSlider
from workflow.run.store import Store


def write_points(store: Store, name: str, slider: PointSlider) -> None:
    """Write one state of a slide: points with radius_m, stratum (-1: rigid), displacement_m and velocity_m_s.

    The radius is half the side of a square with the area of the point.

    Parameters
    ----------
    store : the folder of the run
    name : file within the folder, as `frame_file` of ``disc_grids.py`` names it
    slider : the slide in this state
    """
    points, offset = slider.ground.points, slider.ground.offset
    grid = pv.PolyData(_flat(points.x + offset))
    grid.point_data["radius_m"] = 0.5 * np.sqrt(points.state[:, VOLUME])
    grid.point_data["stratum"] = points.stratum
    grid.point_data["displacement_m"] = _flat(np.where(points.stratum[:, None] < 0, 0.0, points.displacement))
    grid.point_data["velocity_m_s"] = _flat(points.v)
    grid.field_data["seconds"] = np.array([slider.engine.time])
    store.write_grid(name, grid)


def _flat(values: np.ndarray) -> np.ndarray:
    return np.column_stack([values, np.zeros(len(values))])
