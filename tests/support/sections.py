"""Provides sections for tests: a valid one to be altered, and random valid ones."""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import strategies as st

from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from meshes.settings import MeshSettings
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.earthquake.triggering.assessment import TriggeringAssessment, assess

SOIL: dict[str, Any] = {
    "youngs_modulus": "30 MPa",
    "poissons_ratio": 0.3,
    "density_ordinary": "1.9 t/m^3",
    "density_seismic": "1.9 t/m^3",
    "cohesion": "15 kPa",
    "friction_angle": "25 deg",
}


def layer(name: str, **changes: Any) -> dict[str, Any]:
    """Return a stratum as data of a file."""
    return {"name": name, **SOIL, **changes}


def slope() -> dict[str, Any]:
    """Return a valid section of two layers, 100 m long and 20 to 10 m high, as data of a file."""
    return {
        "name": "slope",
        "surface": [[0.0, 20.0], [100.0, 10.0]],
        "base": {"elevation": 0.0},
        "strata": [layer("upper", bottom={"depth": 4.0}), layer("lower")],
    }


def written(folder: Path, **changes: Any) -> Path:
    """Write the small slope with changes of its first stratum; return the file."""
    data = slope()
    data["strata"][0].update(changes)
    path = folder / "slope.toml"
    path.write_text(tomli_w.dumps(data))
    return path


def spoiled(change: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    """Return the valid section after a change to it."""
    data = copy.deepcopy(slope())
    change(data)
    return data


def analysed(data: dict[str, Any]) -> Config:
    """Return a config as the stages receive it, completed by triggering analysis, earthquake and site response."""
    return config_after_triggering(Config.parse(data))


def assessment(config: Config) -> TriggeringAssessment:
    """Return F_L at every blow count of a config."""
    return assess(config.section, config.earthquake, config.triggering)


def _read(data: dict[str, Any], model: type[Section] | type[Config]) -> None:
    """Read a section, or a config with the analyses that complete it."""
    ground = model.parse(data, "slope.toml")
    if isinstance(ground, Config):
        config_after_triggering(ground, "slope.toml")


def problems(data: dict[str, Any], model: type[Section] | type[Config] = Section) -> tuple[str, ...]:
    """Return the messages on bad input; fail if the input is accepted."""
    with pytest.raises(InputError) as caught:
        _read(data, model)
    assert caught.value.source == "slope.toml"
    assert str(caught.value).startswith(f"slope.toml: {len(caught.value.problems)} problem")
    return caught.value.problems


def assert_conforming(mesh: QuadMesh, section: Section, wanted: MeshSettings | None = None) -> None:
    """Check that there is no folded cell and no hanging node, that the boundary groups cover the outline once, and that
    the strata have their areas. ``wanted`` are the settings of a free mesh, in which layers that thin out end in steps.
    """
    layers = wanted.meshed_layers(section)[0] if wanted else section.layering
    assert mesh.quality().smallest_scaled_jacobian > 0.0
    edges = np.sort(np.concatenate([mesh.cells[:, [a, (a + 1) % 4]] for a in range(4)]), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    assert count.max() <= 2
    outer = {tuple(edge) for edge in edges[count == 1].tolist()}
    named = [tuple(sorted(edge)) for group in mesh.boundaries.values() for edge in group.tolist()]
    assert len(named) == len(set(named))
    assert set(named) == outer
    outline = layers.outline()
    perimeter = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T).sum()
    ends = mesh.points[np.array(sorted(outer))]
    assert np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum() == pytest.approx(perimeter, rel=1e-9)
    np.testing.assert_allclose(mesh.stratum_areas(), layers.areas(), rtol=1e-9, atol=0.0)


class _Ground:
    """Holds the depth (cm) down to which layers have been placed, left and right of every node."""

    def __init__(self, draw: st.DrawFn) -> None:
        self.draw = draw
        self.width = draw(st.integers(100, 3000)) / 10.0
        share = draw(st.sets(st.integers(1, 19).map(lambda part: 5 * part), max_size=6))  # no needles of ground
        self.x = [round(self.width * part / 100.0, 3) for part in (0, *sorted(share), 100)]
        self.last = len(self.x) - 1
        self.depth = np.zeros((len(self.x), 2))
        self.level = np.empty((len(self.x), 2))
        for node in range(len(self.x)):
            here = draw(st.integers(2000, 3000))
            self.level[node] = here
            if 0 < node < self.last and draw(st.integers(0, 5)) == 0:
                self.level[node, 1] = here + draw(st.sampled_from([-500, -120, 80, 400]))

    def surface(self) -> list[list[float]]:
        return self.points(range(len(self.x)), self.level)

    def points(self, nodes: range, values: np.ndarray) -> list[list[float]]:
        """Return the points (m) of a line through nodes, with a vertical step where left and right differ."""
        results = []
        for node in nodes:
            left, right = (float(value) / 100.0 for value in values[node])
            inner = nodes[0] < node < nodes[-1]
            if inner and left != right:
                results += [[self.x[node], left], [self.x[node], right]]
            else:
                results.append([self.x[node], left if node == nodes[-1] else right])
        return results

    def line(self, nodes: range, depth: np.ndarray) -> dict[str, Any]:
        """Return a bottom line as depths or as elevations."""
        if self.draw(st.booleans()):
            return {"depth": self.points(nodes, depth)}
        return {"elevation": self.points(nodes, self.level - depth)}

    def thicknesses(self, nodes: range, ends: tuple[bool, bool]) -> np.ndarray:
        """Return the thickness (cm) of a new layer at the nodes, zero at some but not all; zero at an end where
        ``ends`` is false."""
        thick = st.one_of(st.just(0), st.integers(20, 400))
        values = np.zeros_like(self.depth)
        for node in nodes:
            values[node] = self.draw(thick)
            if nodes[0] < node < nodes[-1] and self.draw(st.integers(0, 7)) == 0:
                values[node, 1] = self.draw(thick)
        if not ends[0]:
            values[nodes[0]] = 0
        if not ends[1]:
            values[nodes[-1]] = 0
        somewhere = nodes[len(nodes) // 2] if len(nodes) > 2 else nodes[0] if ends[0] else nodes[-1]
        if not values[list(nodes)].any():
            values[somewhere] = 150
        return values

    def lay(self, nodes: range, ends: tuple[bool, bool]) -> dict[str, Any]:
        """Return the bottom of a new layer along nodes; the layer has a vertical face at an end inside the section."""
        depth = self.depth + self.thicknesses(nodes, ends)
        bottom = self.line(nodes, depth)
        # Outside its nodes the new line does not exist: only the inward sides of its end nodes go down.
        self.depth[nodes[0], 1], self.depth[nodes[-1], 0] = depth[nodes[0], 1], depth[nodes[-1], 0]
        for node in nodes[1:-1]:
            self.depth[node] = depth[node]
        if nodes[0] == 0:
            self.depth[0] = depth[0]
        if nodes[-1] == self.last:
            self.depth[self.last] = depth[self.last]
        return bottom

    def outcrop(self) -> dict[str, Any]:
        """Return a first layer whose bottom crops out: elevations, above the ground at some nodes."""
        depth = np.repeat(self.draw(st.lists(st.integers(-300, 400), min_size=len(self.x), max_size=len(self.x))), 2)
        depth = depth.reshape(-1, 2).astype(float)
        depth[self.draw(st.integers(0, self.last))] = 250.0
        self.depth = np.maximum(depth, 0.0)
        return {"elevation": self.points(range(len(self.x)), self.level - depth)}


@st.composite
def sections(draw: st.DrawFn) -> Section:
    """Generate valid sections: steps, pinch-outs, lenses, neighbours, outcrops; lines as depths, elevations or
    levels."""
    ground = _Ground(draw)
    everywhere = range(len(ground.x))
    bottoms: list[dict[str, Any]] = []
    for number in range(draw(st.integers(0, 4))):
        kinds = ["across", "across", "level"] + ["lens", "neighbours"] * (ground.last > 1) + ["outcrop"] * (number == 0)
        kind = draw(st.sampled_from(kinds))
        if kind == "across":
            bottoms.append(ground.lay(everywhere, (True, True)))
        elif kind == "level":
            level = float(ground.depth.max()) + draw(st.integers(20, 300))
            ground.depth[:] = level
            bottoms.append({"depth": level / 100.0})
        elif kind == "lens":
            start = draw(st.integers(0, ground.last - 2))
            end = draw(st.integers(start + 2, ground.last))
            bottoms.append(ground.lay(range(start, end + 1), (draw(st.booleans()), draw(st.booleans()))))
        elif kind == "neighbours":
            middle = draw(st.integers(1, ground.last - 1))
            bottoms.append(ground.lay(range(middle + 1), (True, True)))
            bottoms.append(ground.lay(range(middle, ground.last + 1), (True, True)))
        else:
            bottoms.append(ground.outcrop())
    deepest = float(ground.depth.max()) + draw(st.integers(50, 800))
    base = draw(st.sampled_from(["depth", "elevation", "points"]))
    if base == "depth":
        lowest: dict[str, Any] = {"depth": deepest / 100.0 + 6.0}  # more than any step of the ground
    elif base == "elevation":
        lowest = {"elevation": (float(ground.level.min()) - deepest) / 100.0}
    else:
        lowest = {"elevation": ground.points(everywhere, np.floor(ground.level.min() - deepest - ground.depth / 3.0))}
    strata = [layer(f"layer {k}", bottom=bottom) for k, bottom in enumerate(bottoms)]
    data = {"name": "random", "surface": ground.surface(), "base": lowest, "strata": [*strata, layer("last")]}
    return Section.parse(data)
