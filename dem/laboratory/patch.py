"""Builds a patch of discs of one layer inside a frame of fixed discs, the sample of an element test, and computes its
strain and stress.

The frame moves affinely, x = F X about the middle of the patch, so that the mean strain is known without measurement
(Gauss), and no platen or membrane influences the place of failure. Stress is the mean over a region inside the frame
that deforms with it. Tension is positive, SI units, per metre out of plane.
"""

from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from dem.assembly import DiscGeometry, DiscMaterials
from dem.engine.engine import Engine, EngineRun
from dem.engine.packer import pack
from dem.engine.time_step import largest_step
from dem.errors import EscapeError
from dem.kernels.layout import Layout
from dem.kernels.patch import outside, pair_forces, turn
from dem.kernels.stable_step import stable_step_of_layout
from dem.model import DiscModel
from dem.packing import ROW, Packing, densest, one_stratum, random_packing
from dem.springs import Law, LayerSprings

PackingKind = Literal["lattice", "random"]

# columns and rows by default, frame included; a frame stiffens what lies near, where that is not affine anyway
SIZES: dict[PackingKind, tuple[int, int]] = {"lattice": (12, 14), "random": (24, 27)}
# of soil discs: between dense ones, which have more of a peak, and loose ones (0.25), which have hardly any but want
# twice the strain, so that slopes of them fail at a fifth less Kh within the displacements that count
POROSITY = 0.23
VOID_RATIO = POROSITY / (1.0 - POROSITY)
# of a random patch before it is confined: the first that its seed can do
POROSITIES: dict[Law, tuple[float, ...]] = {"paper": (0.2, 0.21, 0.22, 0.24), "soil": (POROSITY, 0.235, 0.24, 0.25)}
DASHPOTS = 0.2  # of sqrt(m k)
STEP = 0.6  # of the stable step
SKIN = 0.2  # radii; pairs in a wider margin would only shorten the step


@dataclass(frozen=True)
class PatchSample:
    """Specifies the discs of a patch.

    Attributes
    ----------
    layer : springs of the discs
    packing : arrangement of the discs
    radius : mean radius of the discs (m)
    seed : seed of a random packing
    size : numbers of columns and rows, including the frame; `SIZES` if None
    law : contact law of the discs. A patch of soil discs has the porosity of the discs in the slope.
    """

    layer: LayerSprings
    packing: PackingKind
    radius: float
    seed: int = 0
    size: tuple[int, int] | None = None
    law: Law = "paper"

    def __post_init__(self) -> None:
        if self.packing not in SIZES:
            raise ValueError(f"packing is 'lattice' or 'random', not {self.packing!r}")
        columns, rows = self.size or SIZES[self.packing]
        if columns < 8 or rows < 8:
            raise ValueError(f"a patch of {columns} x {rows} discs has no interior; expected at least 8 x 8")

    def patch(self, threads: int = 1) -> "Patch":
        """Place the sample in its frame, not yet confined. Raises ValueError if no random packing of the required
        porosity fits."""
        size = self.size or SIZES[self.packing]
        if self.packing == "lattice":
            patch = lattice_patch(self.layer, self.radius, size)
        else:
            patch = random_patch(self.layer, self.radius, size, self.seed, self.law)
        return replace(patch, threads=threads)


@dataclass(eq=False)
class Patch:
    """Holds the current state of a sample in its frame of fixed discs.

    Attributes
    ----------
    model : all discs, including those of the frame
    frame (n,) : mask of the discs of the frame
    region (2, 2) : low and high corner of the region over which stress is averaged, in the coordinates X before any
        strain (m)
    threads : threads of the engine
    deformation (2, 2) : present deformation gradient F
    rates (2, 2) : velocity gradient of the frame (1/s)
    run : press that strains the patch at present
    """

    model: DiscModel
    frame: np.ndarray
    region: np.ndarray
    threads: int = 1
    deformation: np.ndarray = field(default_factory=lambda: np.eye(2))
    rates: np.ndarray = field(default_factory=lambda: np.zeros((2, 2)))
    run: EngineRun | None = None

    @property
    def time_unit(self) -> float:
        """Return sqrt(m / kn) of a disc of the layer (s), the time unit of the tests."""
        return float(np.sqrt(self.model.mass.mean() / self.model.springs.layers[0].kn))

    def inertia(self, pressure: float) -> float:
        """Return the inertial number at this pressure (Pa) for unit strain rate: diameter times sqrt(density / p), in
        s."""
        model = self.model
        diameter = 2.0 * float(model.radius[~self.frame].mean())
        density = model.springs.layers[0].density
        return diameter * float(np.sqrt(density / pressure)) / self.time_unit

    def copy(self) -> "Patch":
        """Return a copy of the patch in the same state."""
        return replace(self, model=self.model.copy(), deformation=self.deformation.copy(), rates=self.rates.copy())

    @property
    def layout(self) -> Layout:
        """Return the layout of discs and contacts of the press or, without a press, a layout made from the model."""
        return pack(self.model) if self.run is None else self.run.pack()

    def stress_state(self) -> "StressState":
        """Return the stress from the contact forces of the last step, dashpots included."""
        back = np.linalg.inv(self.deformation)
        sums, unbalanced, cracked = pair_forces(self.layout, len(self.model), back, self.region)
        area = float(np.prod(self.region[1] - self.region[0]) * np.linalg.det(self.deformation))
        return StressState(sums / area, unbalanced, cracked)

    def check_frame(self) -> None:
        """Raise EscapeError if a free disc has left the frame, NotFiniteError if its position is NaN."""
        model = self.model
        gone = outside(self.layout, len(model), np.linalg.inv(self.deformation))
        if gone >= 0:
            if self.run is not None:
                self.run.show()
            raise EscapeError(
                f"disc {model.order[gone]} has slipped out through a gap in the frame at t = {model.time:.6g} s. "
                "Test to a smaller strain, or take another seed."
            )


@dataclass(frozen=True)
class StressState:
    """Holds stress and equilibrium of a patch.

    Attributes
    ----------
    stress (2, 2) : mean stress over the region (Pa): the sum of pair force times the part of the branch vector inside
        the region, over its area
    unbalanced : mean unbalanced force on a free disc, over the mean force of loaded contacts
    cracked : number of cracked pore springs
    """

    stress: np.ndarray
    unbalanced: float
    cracked: int


class StrainControl:
    """Imposes strain on a patch: steps of the engine with constant velocity gradients of the frame.

    Inside the ``with`` block the contacts are only in the layout of the kernels, since writing the contacts back takes
    longer than most intervals of strain; the model of the patch is complete again after the block.
    """

    def __init__(self, patch: Patch) -> None:
        self.patch = patch
        engine = Engine(dt=STEP * largest_step(patch.model).seconds, threads=patch.threads, energies=False)
        self.run = EngineRun(engine, patch.model, engine.step_of(patch.model))

    def __enter__(self) -> "StrainControl":
        self.patch.run = self.run
        return self

    def __exit__(self, *_: object) -> None:
        self.patch.run = None
        self.run.close()

    def turn_to(self, rates: np.ndarray) -> None:
        """Set the velocity gradient (2, 2) of the frame (1/s).

        Free discs get the same change of velocity, so that no wave runs inwards from the frame. Velocities are changed
        in the layout, since after `set_velocity` the contacts would lose the slip of the last step.
        """
        patch, model = self.patch, self.patch.model
        turn(self.run.pack(), model.radius[model.order], rates - patch.rates, rates)
        patch.rates = rates.copy()

    def stable_step(self) -> float:
        """Return the largest stable time step in the present state (s)."""
        model, layout = self.patch.model, self.run.pack()
        return float(stable_step_of_layout(layout, len(model), model.skin, self.run.springs, model.repeats))

    def strain(self, rates: np.ndarray, duration: float) -> None:
        """Strain the patch for `duration` (s) at a velocity gradient (1/s).

        Raises DemError.
        """
        patch, run = self.patch, self.run
        self.turn_to(rates)
        # contacts come and go, and the stable step with them
        steps = int(np.ceil(duration / (STEP * self.stable_step())))
        run.dt = duration / steps
        run.go(steps)
        patch.deformation = (np.eye(2) + rates * duration) @ patch.deformation
        patch.check_frame()


def lattice_patch(layer: LayerSprings, radius: float, size: tuple[int, int] = SIZES["lattice"]) -> Patch:
    """Arrange rows of discs that just touch, along x; the outermost ring of discs is the frame.

    The region spans whole columns and rows, so that the mean stress over the region is the stress of a periodic
    lattice.
    """
    columns, rows = size
    step = 2.0 * radius
    row, column = np.divmod(np.arange(columns * rows), columns)
    x = (column + 0.5 * (row % 2)) * step
    z = row * ROW * step
    middle = np.array([0.5 * (columns - 0.5) * step, 0.5 * (rows - 1) * ROW * step])
    frame = (row == 0) | (row == rows - 1) | (column == 0) | (column == columns - 1)
    half = 0.5 * step * np.array([columns - 4, (rows - 4) * ROW])
    return _patch(layer, x - middle[0], z - middle[1], np.full(len(x), radius), frame, half)


def random_patch(
    layer: LayerSprings,
    radius: float,
    size: tuple[int, int] = SIZES["random"],
    seed: int = 0,
    law: Law = "paper",
) -> Patch:
    """Arrange the discs of `random_packing` in the space of the lattice. Discs at the edge of the patch, within the
    reach of pore springs, are the frame.

    layer: springs of the layer; radius: mean radius of the discs (m); size: half width and half height in radii and
    rows; seed: seed of the packing; law: contact law.
    """
    half = radius * np.array([size[0], size[1] * ROW])
    packing = _heap(float(half[0]), float(half[1]), radius, seed, law)
    x, z = packing.x, packing.z
    depth = np.minimum(half[0] - np.abs(x), half[1] - np.abs(z))
    reach = 2.0 * layer.alpha * radius
    return _patch(layer, x, z, packing.radius, depth < reach, half - reach - radius, law)


@lru_cache(maxsize=16)
def _heap(half_width: float, half_height: float, radius: float, seed: int, law: Law) -> Packing:
    outline = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * [half_width, half_height]
    try:
        whole = densest(
            lambda porosity: random_packing(outline, one_stratum, radius, porosity=porosity, seed=seed), POROSITIES[law]
        )
    except ValueError as error:
        raise ValueError(
            f"no random patch for seed {seed} up to a porosity of {POROSITIES[law][-1]}: take another seed"
        ) from error
    free = whole.free
    return Packing(whole.x[free], whole.z[free], whole.radius[free], whole.layer[free], whole.lines)


def _patch(
    layer: LayerSprings,
    x: np.ndarray,
    z: np.ndarray,
    radius: np.ndarray,
    frame: np.ndarray,
    half: np.ndarray,
    law: Law = "paper",
) -> Patch:
    # dashpots do not affect the state at rest, and those of the layer would require a step four times smaller
    mass = layer.density * np.pi * float(np.mean(radius**2))
    cn, ct = (DASHPOTS * float(np.sqrt(mass * k)) for k in (layer.kn, layer.ks))
    model = DiscModel.create(
        DiscGeometry(x, z, radius, np.where(frame, -1, 0)),
        DiscMaterials([replace(layer, cn=cn, ct=ct)], law=law),
        skin=SKIN * float(radius.mean()),
    )
    return Patch(model, model.fixed.copy(), np.array([-half, half]))
