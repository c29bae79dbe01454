"""Images of cells painted by matplotlib: size, colours, no lines between cells of one colour."""

import subprocess
import sys
from types import SimpleNamespace

import numpy as np

from tests.support import TOP
from workflow.figures.canvas import LEFT, RIGHT, WIDTH, Window
from workflow.figures.raster import fill_cells, fill_discs, image_size, painted, shade_cells

POINTS = np.array([[x, z] for z in (0.0, 1.3, 4.0) for x in (0.0, 3.1, 7.7, 10.0)])
CELLS = np.array([[k, k + 1, k + 5, k + 4] for k in (0, 1, 2, 4, 5, 6)])
WINDOW = Window(0.0, 10.0, 0.0, 4.0)


def test_image_is_exactly_the_window_and_cells_of_one_colour_have_no_lines_between_them() -> None:
    image = painted(WINDOW, lambda axes: fill_cells(axes, POINTS, CELLS, ["#203040"], np.zeros(6, dtype=int)))
    assert image.shape[1::-1] == image_size(WINDOW, round((RIGHT - LEFT) * WIDTH), 1)
    inside = image[2:-2, 2:-2].reshape(-1, 3)
    assert (inside == [0x20, 0x30, 0x40]).all()


def test_every_cell_has_the_colour_of_its_class() -> None:
    colours = ["#ff0000", "#00ff00", "#0000ff"]
    image = painted(WINDOW, lambda axes: fill_cells(axes, POINTS, CELLS, colours, np.array([0, 1, 2, 2, 1, 0])), 2)
    centres = POINTS[CELLS].mean(axis=1)
    high, width, _ = image.shape
    seen = [image[int(high * (1.0 - z / 4.0)), int(width * x / 10.0)].argmax() for x, z in centres]
    assert seen == [0, 1, 2, 2, 1, 0]


def test_colours_change_linearly_between_the_points() -> None:
    image = painted(WINDOW, lambda axes: shade_cells(axes, POINTS, CELLS, POINTS[:, 0], "gray", (0.0, 10.0)))
    row = image[len(image) // 3, :, 0].astype(float)
    expected = 255.0 * (np.arange(len(row)) + 0.5) / len(row)
    assert np.abs(row - expected).max() < 4.0


def test_modules_of_pictures_load_without_pyvista() -> None:
    """It takes half a second to load, in each process that draws anything but slides."""
    names = "bounds, discs, fem, ground, weights"
    look = f"import sys; from workflow.figures import {names}; from workflow.results import fem_states, mesh_grids; "
    subprocess.run(
        [sys.executable, "-c", f"{look}assert 'pyvista' not in sys.modules"], cwd=TOP, check=True, timeout=120
    )


def test_discs_have_their_radius_in_metres_and_the_colours_of_their_values() -> None:
    model = SimpleNamespace(x=np.array([2.0, 7.0]), z=np.array([2.0, 2.0]), radius=np.array([1.5, 1.0]))
    image = painted(WINDOW, lambda axes: fill_discs(axes, model, facecolors=["#ff0000", "#0000ff"]), width=500)
    assert image.shape == (200, 500, 3)
    areas = [(image == colour).all(axis=2).mean() * 10.0 * 4.0 for colour in ([255, 0, 0], [0, 0, 255])]
    np.testing.assert_allclose(areas, np.pi * model.radius**2, rtol=0.03)
    few = painted(WINDOW, lambda axes: fill_discs(axes, model, np.array([False, True]), facecolors="#0000ff"))
    assert few[:, : few.shape[1] // 2].min() == 255
