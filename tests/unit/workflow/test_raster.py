"""Images of cells painted by matplotlib: size, colours, no lines between cells of one colour."""

import subprocess
import sys
from collections.abc import Callable

import numpy as np

from tests.support import TOP
from workflow.figures.canvas import LEFT, RIGHT, WIDTH, Renderer, Window, image_size, render
from workflow.figures.raster import fill_cells, painted, shade_cells

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
    """It takes half a second to load, in each process that draws anything but failure zones and discs."""
    names = "bounds, fem, ground, weights"
    look = f"import sys; from workflow.figures import {names}; from workflow.results import fem_states, mesh_grids; "
    subprocess.run(
        [sys.executable, "-c", f"{look}assert 'pyvista' not in sys.modules"], cwd=TOP, check=True, timeout=120
    )


def test_an_image_does_not_depend_on_the_images_rendered_before_it_in_one_window() -> None:
    """Neither size nor camera, scale of heights or ground of one image stay for the next."""
    import pyvista as pv

    def plane(size: float, colour: str) -> Callable[[pv.Plotter], object]:
        ground = pv.Plane(center=(5.0, 1.0, 0.0), i_size=size, j_size=0.3 * size)
        return lambda plotter: plotter.add_mesh(ground, color=colour, lighting=False)

    requests = [(WINDOW, plane(6.0, "red"), 300, 1), (Window(2.0, 9.0, 0.0, 2.0), plane(3.0, "blue"), 400, 2)]
    with Renderer() as renderer:
        together = [renderer.image(*request) for request in requests * 2]
    for request, first, second in zip(requests, together[:2], together[2:], strict=True):
        alone = render(*request)
        np.testing.assert_array_equal(first, alone)
        np.testing.assert_array_equal(second, alone)
        assert 0.05 < (alone < 100).any(axis=2).mean() < 0.95
