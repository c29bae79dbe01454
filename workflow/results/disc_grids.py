"""Writes discs with their pore springs (the breakable springs between discs that stand for pore water), and material
points with the same fields, as VTK files in the section's frame."""

from pathlib import PurePath

import numpy as np
import pyvista as pv

from dem.ground import Ground
from dem.model import DiscModel
from fem.kernels.material_points import VOLUME
from fem.mpm import PointSlider
from workflow.run.store import Store


def grid_of(model: DiscModel, before: DiscModel, ground: Ground) -> pv.PolyData:
    """Return discs as points with radius_m, stratum (-1: boundary), displacement_m since `before`, and velocity_m_s.

    Pore springs are lines, with cracked = 1 for cracked ones; the cells of points have cracked = -1.
    """
    x, z = ground.to_section(model.x, model.z)
    n = len(model)
    near = model.distance() < 1.5 * np.abs(model.pore_length)  # discs that parted long ago are not joined in a picture
    i, j = model.pair_i[near], model.pair_j[near]
    grid = pv.PolyData()
    grid.points = np.column_stack([x, z, np.zeros(n)])
    grid.verts = np.column_stack([np.ones(n, int), np.arange(n)]).ravel()
    if len(i):
        grid.lines = np.column_stack([np.full(len(i), 2), i, j]).ravel()
    grid.point_data["radius_m"] = model.radius
    grid.point_data["stratum"] = model.layer
    for name, u, v in (
        ("displacement_m", model.x - before.x, model.z - before.z),
        ("velocity_m_s", model.vx, model.vz),
    ):
        dx, dz = ground.to_section_axes(u, v)
        grid.point_data[name] = np.column_stack([dx, dz, np.zeros(n)])
    grid.cell_data["cracked"] = np.concatenate([np.full(n, -1), (model.pore_length[near] < 0.0).astype(int)])
    return grid


def write_frame(store: Store, name: str, model: DiscModel, before: DiscModel, ground: Ground, seconds: float) -> None:
    """Write one state of a slide: discs with radius, stratum, displacement and velocity, and their pore springs.

    Parameters
    ----------
    store : the folder of the run
    name : file within the folder, as `frame_file` names it
    model, before : discs in this state, and at rest before the slide
    ground : place of the discs in the section
    seconds : time since Kh began to rise (s)
    """
    grid = grid_of(model, before, ground)
    grid.field_data["seconds"] = np.array([seconds])
    store.write_grid(name, grid)


def write_points(store: Store, name: str, slider: PointSlider) -> None:
    """Write one state of a slide: points with radius_m, stratum (-1: rigid), displacement_m and velocity_m_s.

    The radius is half the side of a square with the area of the point.

    Parameters
    ----------
    store : the folder of the run
    name : file within the folder, as `frame_file` names it
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


def write_collection(store: Store, name: str, folder: str = "dem") -> None:
    """Write <folder>/<name>.pvd over the states of a case, with their times; nothing without any state.

    Parameters
    ----------
    store : the folder of the run
    name : case by the name of its files, as `case_name` returns it
    folder : folder of the case within that of the run: "dem" for discs, "mpm" for material points
    """
    states = [
        (float(pv.read(store.folder / file).field_data["seconds"][0]), file.removeprefix(f"{folder}/"))
        for file in frames(store, name, folder).values()
    ]
    if states:
        store.write_collection(f"{folder}/{name}.pvd", states)


def case_name(springs: str, number: int) -> str:
    """Return the name of the files of a case, which has no suffix for calibrated discs.

    Parameters
    ----------
    springs : set of springs, "calibrated" or "table2", or name of a random packing
    number : number of the case; 0 is Kh alone

    Returns
    -------
    The name, such as "case3" or "case3_table2".
    """
    return f"case{number}" if springs == "calibrated" else f"case{number}_{springs}"


def frame_file(name: str, number: int, folder: str = "dem") -> str:
    """Return the file of a state of a case.

    Parameters
    ----------
    name : case by the name of its files
    number : number of the state, in time from 0
    folder : folder of the case within that of the run

    Returns
    -------
    The file within the folder of the run.
    """
    return f"{folder}/{name}/frame_{number:03d}.vtp"


def frames(store: Store, name: str, folder: str = "dem") -> dict[int, str]:
    """Return the files of all states of a case.

    Parameters
    ----------
    store : the folder of the run
    name : case by the name of its files
    folder : folder of the case within that of the run

    Returns
    -------
    The files within the folder of the run by the numbers of the states, in time.
    """
    files = store.matching([f"{folder}/{name}/frame_*.vtp"])
    return dict(sorted((int(PurePath(file).stem.removeprefix("frame_")), file) for file in files))


def copy_frames(store: Store, of: str, to: str, folder: str = "dem") -> None:
    """Copy the states of one case to another with the same slide, in place of the states that this has.

    Parameters
    ----------
    store : the folder of the run
    of, to : both cases by the names of their files
    folder : folder of both cases within that of the run
    """
    store.remove(list(frames(store, to, folder).values()))
    for number, file in frames(store, of, folder).items():
        store.copy(file, frame_file(to, number, folder))
