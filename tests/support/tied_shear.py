"""Direct simple shear of soil discs between two rough plates, in a box whose sides are tied.

No frame at the sides stiffens what lies near, and a uniform slope of the same discs fails in just this way. The lower
plate is fixed; the upper one moves along at a steady rate and up or down so that the stress on it is kept. Pressures
are positive (Pa).
"""

from dataclasses import dataclass

import numpy as np

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine, largest_step
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
    """A test, record by record.

    Attributes
    ----------
    pressure : float
        Kept on the upper plate (Pa).
    porosity : float
        Between the plates, before shear.
    strain, shear, normal : (n,)
        Shear strain; shear stress and pressure on the upper plate (Pa).
    """

    pressure: float
    porosity: float
    strain: np.ndarray
    shear: np.ndarray
    normal: np.ndarray

    @property
    def peak(self) -> float:
        """Largest shear stress over pressure."""
        return float((self.shear / self.normal).max())

    @property
    def after(self) -> float:
        """Shear stress over pressure after the peak, from a strain of `POST_PEAK_STRAIN` on."""
        late = self.strain > POST_PEAK_STRAIN
        return float((self.shear / self.normal)[late].mean())


class _Box:
    """The discs between the plates, and the stress on the upper one."""

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
        """Between the plates (m)."""
        model = self.model
        lower = model.fixed & ~self.plate
        return float(model.z[self.plate].mean() - model.z[lower].mean() - 2.0 * model.radius[lower].mean())

    def stress(self) -> tuple[float, float]:
        """What the upper plate carries: along and up (Pa), dashpots included."""
        m = self.model
        on_j, on_i = self.plate[m.pair_j], self.plate[m.pair_i]
        along, up = (f[on_j].sum() - f[on_i].sum() for f in (m.force_x, m.force_z))
        return float(along) / self.packing.length, float(up) / self.packing.length

    def advance(self, along: float, fastest: float) -> None:
        """One interval with the upper plate at this speed (m/s), and up or down no faster than `fastest` (m/s).

        Changes of its speed go to the free discs in proportion to their height, so that no wave starts at the plate.
        """
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
        """Presses the discs together. Raises ConfinementError if they do not come to rest."""
        for _ in range(MOST_INTERVALS):
            self.advance(0.0, 1e-2 * self.packing.height / self.interval)
            moving = 0.5 * np.sum((self.model.mass * (self.model.vx**2 + self.model.vz**2))[self.free])
            pressed = self.pressure**2 / self.modulus * self.packing.length * self.packing.height
            if abs(self.stress()[1] - self.pressure) < PRESSURE_TOLERANCE * self.pressure and moving < 1e-6 * pressed:
                return
        raise ConfinementError(f"the discs between the plates do not come to rest at {self.pressure:g} Pa")


def shear(packing: TiedPacking, layer: LayerSprings, pressure: float, strain: float = 0.2) -> ShearTest:
    """Confines the discs at this pressure (Pa) and shears them. Raises ConfinementError, DemError."""
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
