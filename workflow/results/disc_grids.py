"""Writes discs and their pore springs (the breakable springs between discs that stand for pore water) as VTK files, in
the section's frame."""

from pathlib import PurePath

import numpy as np
import pyvista as pv

from dem.ground import Ground
from dem.model import DiscModel
from workflow.run.store import Store


def grid_of(model: DiscModel, before: DiscModel, ground: Ground) -> pv.PolyData:
    """Return discs as points with radius_m, stratum (-1: boundary), and displacement_m and velocity_m_s since `before`.
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
    """Write one state of a slide, with the seconds since its onset.

    ``store``: the folder of the run; ``name``: name of the file; ``model``, ``before``: discs now and at rest;
    ``ground``: the ground in which the discs lie.
    """
    grid = grid_of(model, before, ground)
    grid.field_data["seconds"] = np.array([seconds])
    store.write_grid(name, grid)


def write_collection(store: Store, name: str, folder: str = "dem") -> None:
    """Write <folder>/<name>.pvd over the frames of a case, with their times."""
    states = [
        (float(pv.read(store.folder / file).field_data["seconds"][0]), file.removeprefix(f"{folder}/"))
        for file in frames(store, name, folder).values()
    ]
    if states:
        store.write_collection(f"{folder}/{name}.pvd", states)


def case_name(springs: str, number: int) -> str:
    """Return the name of the files of a case, which has no suffix for calibrated discs."""
    return f"case{number}" if springs == "calibrated" else f"case{number}_{springs}"


def frame_file(name: str, number: int, folder: str = "dem") -> str:
    """Return the file of a state of a case."""
    return f"{folder}/{name}/frame_{number:03d}.vtp"


def frames(store: Store, name: str, folder: str = "dem") -> dict[int, str]:
    """Return the files of a case by their numbers, in time."""
    files = store.matching([f"{folder}/{name}/frame_*.vtp"])
    return dict(sorted((int(PurePath(file).stem.removeprefix("frame_")), file) for file in files))


def copy_frames(store: Store, of: str, to: str, folder: str = "dem") -> None:
    """Copy the states of one case to another with the same slide.

    ``store``: the folder of the run; ``of``, ``to``: the cases by the names of their files; ``folder``: folder of both.
    """
    store.remove(list(frames(store, to, folder).values()))
    for number, file in frames(store, of, folder).items():
        store.copy(file, frame_file(to, number, folder))
