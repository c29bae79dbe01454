"""Performs direct simple shear of soil discs between two rough plates, in a box with periodic sides.

There is no frame at the sides, and a uniform slope of the same discs fails in the same way. The lower plate is fixed.
The upper plate moves horizontally at a constant rate, and vertically so that its normal stress is constant. Pressures
are positive (Pa).
"""

from dataclasses import dataclass

import numpy as np

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.errors import ConfinementError
from dem.model import DiscModel
from dem.springs import LayerSprings
from docs.verify.slides.tied_packing import TiedPacking

STEP_SHARE = 0.4  # of the stable step
SKIN = 0.2  # mean radii
INERTIAL_NUMBER = 2e-3  # number at most: rate times diameter times sqrt(density / pressure)
INTERVAL = 10.0  # sqrt(m / kn) between two looks of the servo
CORRECTION_INTERVALS, STEADY_INTERVALS = 1.5, 4.0  # intervals in which it takes back an error, and a steady one
PRESSURE_TOLERANCE = 0.01  # of the pressure: error of what the plate carries
MOST_INTERVALS = 4000  # intervals
RECORDS = 60
POST_PEAK_STRAIN = 0.1  # shear strain from which on is after the peak


@dataclass(frozen=True)
class ShearTest:
    """Holds the records of a test.

    Attributes
    ----------
    pressure : constant pressure on the upper plate (Pa)
    porosity : porosity between the plates before shear
    strain, shear, normal (n,) : shear strain; shear stress and pressure on the upper plate (Pa)
    """

    pressure: float
    porosity: float
    strain: np.ndarray
    shear: np.ndarray
    normal: np.ndarray

    @property
    def peak(self) -> float:
        """Return the largest shear stress over pressure."""
        return float((self.shear / self.normal).max())

    @property
    def after(self) -> float:
        """Return the shear stress over pressure after the peak, from a strain of `POST_PEAK_STRAIN`."""
        late = self.strain > POST_PEAK_STRAIN
        return float((self.shear / self.normal)[late].mean())


class _Box:
    """Holds the discs between the plates, and the stress on the upper plate."""

    def __init__(self, packing: TiedPacking, layer: LayerSprings, pressure: float) -> None:
        self.packing, self.pressure = packing, pressure
        self.plate = packing.above
        self.model = DiscModel.create(
            DiscGeometry(packing.x, packing.z, packing.radius, packing.layer),
            DiscMaterials([layer], law="soil"),
            DiscBoundary(period=(packing.length, 0.0)),
            skin=SKIN * float(packing.radius.mean()),
        )
        self.free = ~self.model.fixed
        self.interval = INTERVAL * float(np.sqrt(self.model.mass[self.free].mean() / layer.kn))
        self.modulus = layer.kn  # about that of one-dimensional compression: a contact a diameter
        self.steady = 0.0
        self.speed = np.zeros(2)

    @property
    def height(self) -> float:
        """Return the distance between the plates (m)."""
        model = self.model
        lower = model.fixed & ~self.plate
        return float(model.z[self.plate].mean() - model.z[lower].mean() - 2.0 * model.radius[lower].mean())

    def stress(self) -> tuple[float, float]:
        """Return the horizontal and vertical stress on the upper plate (Pa), including dashpots."""
        m = self.model
        on_j, on_i = self.plate[m.pair_j], self.plate[m.pair_i]
        along, up = (f[on_j].sum() - f[on_i].sum() for f in (m.force_x, m.force_z))
        return float(along) / self.packing.length, float(up) / self.packing.length

    def advance(self, along: float, fastest: float) -> None:
        """Advance by one interval, with this horizontal speed of the upper plate (m/s) and a vertical speed of at most
        `fastest` (m/s). Changes of its speed are applied to the free discs in proportion to their height, so that no
        wave starts at the plate."""
        answer = (
            (self.stress()[1] - self.pressure)
            / self.modulus
            * self.packing.height
            / (CORRECTION_INTERVALS * self.interval)
        )
        self.steady = float(np.clip(self.steady + answer / STEADY_INTERVALS, -fastest, fastest))
        speed = np.array([along, np.clip(answer + self.steady, -fastest, fastest)])
        share = np.where(self.free, self.model.z / self.height, self.plate)
        for name, change in zip(("vx", "vz"), speed - self.speed, strict=True):
            # in place: `set_velocity` would make the contacts forget the slip of the step under way
            for values in (getattr(self.model, name), getattr(self.model, name + "_half")):
                values += share * change
        self.speed = speed
        Engine(dt=STEP_SHARE * largest_step(self.model).seconds, energies=False).run(self.model, self.interval)

    def confine(self) -> None:
        """Compress the discs. Raises ConfinementError if they do not come to rest."""
        for _ in range(MOST_INTERVALS):
            self.advance(0.0, 1e-2 * self.packing.height / self.interval)
            moving = 0.5 * np.sum((self.model.mass * (self.model.vx**2 + self.model.vz**2))[self.free])
            pressed = self.pressure**2 / self.modulus * self.packing.length * self.packing.height
            if abs(self.stress()[1] - self.pressure) < PRESSURE_TOLERANCE * self.pressure and moving < 1e-6 * pressed:
                return
        raise ConfinementError(f"the discs between the plates do not come to rest at {self.pressure:g} Pa")


def shear(packing: TiedPacking, layer: LayerSprings, pressure: float, strain: float = 0.2) -> ShearTest:
    """Confine the discs at this pressure (Pa) and shear them. Raises ConfinementError, DemError."""
    box = _Box(packing, layer, pressure)
    box.confine()
    solid = float(np.sum(np.pi * box.model.radius[box.free] ** 2))
    porosity = 1.0 - solid / (packing.length * box.height)
    density = layer.density
    rate = INERTIAL_NUMBER / (2.0 * float(packing.radius.mean()) * np.sqrt(density / pressure))
    intervals = int(np.ceil(strain / (rate * box.interval) / RECORDS)) * RECORDS
    rows = []
    for step in range(intervals):
        box.advance(rate * box.height, rate * box.height)
        along, up = box.stress()
        rows.append([(step + 1) * rate * box.interval, -along, up])
    records = np.array(rows).reshape(RECORDS, -1, 3).mean(axis=1)
    return ShearTest(pressure, porosity, *records.T)
