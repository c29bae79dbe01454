"""Provides small assemblies of discs from which several tests start; one kind of soil unless a test gives another, in
SI units."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from dem.acceleration import Acceleration
from dem.assembly import DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.forces import ContactForces
from dem.model import DiscModel
from dem.springs import Law, LayerSprings

RADIUS = 0.75
DENSITY = 2000.0
MASS = np.pi * RADIUS**2 * DENSITY
KN = 1.0e8
GRAVITY = 9.81

# undamped, frictionless, without pore springs; tests add what they are about
BARE_SPRINGS = LayerSprings(
    "bare", kn=KN, ks=0.0, cn=0.0, ct=0.0, kpn=0.0, kps=0.0, density=DENSITY, effective_density=DENSITY,
    friction=0.0, cohesion=0.0,
)  # fmt: skip
# a soil with every part of the law at work
SOIL_SPRINGS = replace(
    BARE_SPRINGS, name="soil", ks=0.4 * KN, cn=0.2 * np.sqrt(MASS * KN), ct=0.1 * np.sqrt(MASS * KN), kpn=0.1 * KN,
    kps=0.04 * KN, friction=0.7, cohesion=1.0e4,
)  # fmt: skip
# ... and every part of the law of soil discs
EARTH_SPRINGS = replace(SOIL_SPRINGS, name="earth", contact_cohesion=2.0e3, rolling_friction=0.1, stop=4.0 * KN)
FLOOR = np.array([[0.0, 0.0, 0.0, 1.0, -1e6, 1e6]])


def lattice(columns: int, rows: int, spacing: float = 2.0 * RADIUS) -> tuple[np.ndarray, np.ndarray]:
    """Return the centres of a triangular lattice in rows of `columns` discs, every other row shifted by half a
    spacing."""
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    return ((i + 0.5 * (j % 2)) * spacing).ravel(), (j * spacing * np.sqrt(0.75)).ravel()


def box(
    columns: int,
    rows: int,
    soil: LayerSprings = SOIL_SPRINGS,
    tilt: float = 0.0,
    squeeze: float = 1e-4,
    law: Law = "paper",
) -> DiscModel:
    """Return a lattice at rest in a box of fixed discs, open at the top, with a layer for the lower and one for the
    upper half."""
    x, z = lattice(columns + 2, rows + 1, 2.0 * RADIUS * (1.0 - squeeze))
    row = np.repeat(np.arange(rows + 1), columns + 2)
    column = np.tile(np.arange(columns + 2), rows + 1)
    layer = np.where(row <= rows // 2, 1, 0)
    layer[(row == 0) | (column == 0) | (column == columns + 1)] = -1
    stiffer = replace(soil, name="stiffer", kn=2.0 * soil.kn, ks=2.0 * soil.ks)
    gravity = (GRAVITY * np.sin(tilt), -GRAVITY * np.cos(tilt))
    return DiscModel.create(DiscGeometry(x, z, RADIUS, layer), DiscMaterials([soil, stiffer], law=law), gravity=gravity)


def random_discs(seed: int, count: int, soil: LayerSprings, speed: float) -> DiscModel:
    """Return discs of many sizes in a closed heap, slightly overlapping, with random velocities and spins."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count)))
    x, z = lattice(side, side, 1.02 * 2.0 * RADIUS)
    radius = RADIUS * rng.uniform(0.8, 1.2, count)
    x = x[:count] + 0.1 * RADIUS * rng.standard_normal(count)
    z = z[:count] + 0.1 * RADIUS * rng.standard_normal(count)
    model = DiscModel.create(DiscGeometry(x, z, radius), DiscMaterials([replace(soil, allowed_overlap=2.0)]))
    vx, vz = speed * rng.standard_normal((2, count))
    model.set_velocity(vx, vz, speed / RADIUS * rng.standard_normal(count))
    return model


def trace(
    model: DiscModel, dt: float, steps: int, watch: Callable[[DiscModel], object], **settings: object
) -> np.ndarray:
    """Call `watch` after every step of a run without energies."""
    seen: list[object] = []
    Engine(dt=dt, **{"energies": False} | settings).run(  # type: ignore[arg-type]
        model, steps=steps, every=dt, on_output=lambda m: seen.append(watch(m))
    )
    return np.array(seen)


def order(errors: np.ndarray, ratio: float = 2.0) -> float:
    """Return the observed order of convergence: the slope of the errors of ever finer steps, each `ratio` times the
    previous one."""
    levels = np.arange(len(errors))
    return float(-np.polyfit(levels * np.log(ratio), np.log(np.abs(errors)), 1)[0])


def stress(model: DiscModel, forces: ContactForces, area: float, where: np.ndarray | None = None) -> np.ndarray:
    """Return the mean stress (2, 2) of the discs in the mask `where` on their share of the plane `area` (Pa, tension
    positive): the sum over pairs of force times branch vector, half of it for each of the two discs. The forces are
    those of pairs, since the resultants on discs vanish at rest."""
    chosen = np.ones(len(model), bool) if where is None else where
    i, j = model.pair_i, model.pair_j
    share = 0.5 * (chosen[i].astype(float) + chosen[j])
    branch = model.branch()
    return -np.einsum("c,ac,bc->ab", share, np.array([forces.fx, forces.fz]), branch) / area


QUAKE = Acceleration(np.linspace(0.0, 2.0, 41), 3.0 * np.sin(np.arange(41.0)), np.cos(np.arange(41.0)))


def shaking(law: Law = "paper") -> DiscModel:
    """A box in which lists are made anew, pore springs crack and discs slide; and roll, if they are soil discs."""
    model = box(20, 14, replace(SOIL_SPRINGS if law == "paper" else EARTH_SPRINGS, cohesion=4e3), tilt=0.1, law=law)
    model.skin = 0.04  # a thin one, so that lists are made often
    model.set_pore_springs()
    model.acceleration = QUAKE
    rng = np.random.default_rng(4)
    model.set_velocity(*(0.5 * rng.standard_normal((2, len(model))) * ~model.fixed), 0.0)
    return model


def same(a: DiscModel, b: DiscModel) -> bool:
    """Equal to the last bit in everything that is an array or a number."""
    return all(
        np.array_equal(value, getattr(b, name), equal_nan=True)
        for name, value in vars(a).items()
        if isinstance(value, np.ndarray | float | int)
    )
