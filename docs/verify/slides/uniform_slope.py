"""Computes a uniform slope with periodic sides by discs: an infinite slope whose layers liquefy, under a downslope Kh.

The axes lie along the slope: x along its surface, positive downslope, z perpendicular to it; gravity is inclined. By
statics without vertical inertia, planes parallel to the surface carry the shear stress p (tan b + kh) at the normal
stress p of the weight, and the block above slides as Newmark's block does.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from dem.acceleration import tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.case import Case
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.ground import Ground
from dem.laboratory.patch import POROSITY, VOID_RATIO
from dem.model import DiscModel
from dem.packing import Packing
from dem.settings import SlideSettings
from dem.slides.liquefaction import Slider
from dem.slides.until_rest import UntilRest, run_until_rest
from dem.springs import LayerSprings
from docs.verify.slides.tied_packing import TiedPacking, tied_packing
from meshes.section.quantity import GRAVITY

G = 9.81  # m/s2
UNIT_WEIGHT = 9.81e3  # of water, N/m3
SETTLING_TIME, TILTING_STEPS, REST_TIME = (
    6.0,
    5,
    3.0,
)  # s on the level, steps of a second in which it is tilted, s after that
FOLLOWED_TIME = 60.0  # s after a push, until which a slope is followed
REST_DISPLACEMENT = 5e-3  # m in `CHECK_INTERVAL`: a crust oscillates by less for some time
CHECK_INTERVAL = 0.5  # s

LayersOf = Callable[[float], Sequence[LayerSprings]]  # void ratio to springs, from the lowest layer up


class UniformSlope:
    """Holds the discs of one period of a uniform slope at rest.

    Parameters
    ----------
    angle : inclination of the slope (rad)
    thickness : thickness of the layers perpendicular to the slope (m), from the base up
    radius : mean radius of the discs (m)
    layers_of : function of the void ratio of the packing that returns the springs of the layers, from the base up
    length : length of the period along the slope (m)
    seed : seed of the packing
    water : depth of the water table (m), below which the ground is saturated and seepage is parallel to the slope; None
        for dry ground

    Attributes
    ----------
    model : the discs at rest
    ground : their geometry for `Slider`, without a section

    Raises
    ------
    ValueError
        If the numbers of springs and of layers differ.
    """

    def __init__(
        self,
        angle: float,
        thickness: Sequence[float],
        radius: float,
        layers_of: LayersOf,
        *,
        length: float = 40.0,
        seed: int = 0,
        water: float | None = None,
    ) -> None:
        self.angle, self.radius = angle, radius
        columns, rows = (round(size / (2.0 * radius)) for size in (length, sum(thickness)))
        bare = tied_packing(columns, rows, radius, porosity=POROSITY, seed=seed).without_upper_plate()
        layers = list(layers_of(VOID_RATIO))
        if len(layers) != len(thickness):
            raise ValueError(f"{len(thickness)} layers have a thickness, {len(layers)} have springs")
        self.model = _discs(bare, layers)
        self._on(SETTLING_TIME)
        free = ~self.model.fixed
        top = float(np.sort((self.model.z + self.model.radius)[free])[-columns // 2 :].mean())
        void_ratio = bare.length * top / float(np.sum(np.pi * self.model.radius[free] ** 2)) - 1.0
        # what has settled is as heavy as the soil, and divided into layers where these are to lie
        settled = replace(bare, x=self.model.x, z=self.model.z)
        self.model = _discs(settled, layers_of(void_ratio), thickness)
        if water is not None:
            wet = ~self.model.fixed & (self.model.z < top - water)
            area = (1.0 + void_ratio) * np.pi * self.model.radius**2
            self.model.pore_acceleration_z[wet] = (UNIT_WEIGHT * np.cos(angle) * area / self.model.mass)[wet]
        self._settle()
        packing = Packing(self.model.x, self.model.z, self.model.radius, self.model.layer, self.model.lines)
        self.ground = Ground(packing, "random", radius, 0, angle, (0.0, 0.0), 1)

    def _settle(self) -> None:
        self._on(REST_TIME)
        for tilt in np.linspace(0.0, self.angle, TILTING_STEPS + 1)[1:]:
            self.model.gravity = tilted_gravity(tilt, G)
            self._on(1.0)
        self._on(REST_TIME)

    def _on(self, seconds: float) -> None:
        Engine(dt=0.5 * largest_step(self.model).seconds, energies=False).run(self.model, seconds)

    def above(self, layer: int) -> np.ndarray:
        """Return the mask of the discs in the layers above this one."""
        return np.asarray(~self.model.fixed & (self.model.layer > layer))

    def liquefy(self, layers: Sequence[int], case: Case, settings: SlideSettings | None = None) -> Slider:
        """Liquefy layers without Kh, and follow the slope until it is at rest or its time is over.

        Parameters
        ----------
        layers : numbers of the layers, from the base up
        case : their remaining stiffness and strength
        settings : onset and duration; by default 20 s without Kh. Kh is applied before the layers liquefy

        Returns
        -------
        The slider with the slide; the slope continues from its end.
        """
        slider = Slider(self.model, self.ground, list(layers), case, settings or SlideSettings(kh=0.0, duration=20.0))
        slider.run()
        self.model = slider.model
        return slider

    def shake_constant(
        self, kh: float, seconds: float, *, layer: int = 0, later: float = FOLLOWED_TIME
    ) -> "SlopeResponse":
        """Apply a constant seismic coefficient for some seconds, and follow the slope until it is at rest.

        Parameters
        ----------
        kh : seismic coefficient, positive downslope; it is applied and removed within a millisecond, as in Newmark's
            closed form
        seconds : duration of Kh (s)
        layer : number of the layer above which the ground is the sliding block
        later : time after Kh until which the slope is followed (s)

        Returns
        -------
        The response of the block.
        """
        times = np.array([0.0, 1e-3, seconds, seconds + 1e-3])
        return self.shake(times, kh * GRAVITY * np.array([0.0, 1.0, 1.0, 0.0]), layer=layer, later=later)

    def shake(
        self, time: np.ndarray, acceleration: np.ndarray, *, layer: int = 0, later: float = FOLLOWED_TIME
    ) -> "SlopeResponse":
        """Shake the base, and follow the slope until it is at rest.

        Parameters
        ----------
        time (n,) : increasing times from 0 (s)
        acceleration (n,) : horizontal acceleration of the ground (m/s²), positive downslope
        layer : number of the layer above which the ground is the sliding block
        later : time after the shaking until which the slope is followed (s)

        Returns
        -------
        The response of the block.
        """
        model, block, seconds = self.model, self.above(layer), float(time[-1])
        begin, start = model.time, model.x.copy()
        model.acceleration = self.ground.recorded_acceleration(begin + time, acceleration)
        rows: list[tuple[float, float, float]] = []

        def look(m: DiscModel) -> None:
            rows.append((m.time - begin, float((m.x - start)[block].mean()), float(m.vx[block].mean())))

        rest = run_until_rest(
            model,
            still=REST_DISPLACEMENT,
            longest=seconds + later,
            every=CHECK_INTERVAL,
            at_least=seconds + 1.0,
            on_look=look,
        )
        return SlopeResponse(self.angle, float(acceleration.max()) / GRAVITY, seconds, np.array(rows), rest)


def _discs(packing: TiedPacking, layers: Sequence[LayerSprings], thickness: Sequence[float] = ()) -> DiscModel:
    """Return the discs of a periodic packing under vertical gravity, in layers of some thickness from z = 0 upwards."""
    layer = np.searchsorted(np.cumsum(thickness)[:-1], packing.z, side="right") if len(thickness) else 0
    return DiscModel.create(
        DiscGeometry(packing.x, packing.z, packing.radius, np.where(packing.layer < 0, -1, layer)),
        DiscMaterials(layers, law="soil"),
        DiscBoundary(period=(packing.length, 0.0)),
        gravity=(0.0, -G),
        skin=0.2 * float(packing.radius.mean()),
    )


class SlopeResponse:
    """Holds the response of a block to Kh or to a shaken base.

    Attributes
    ----------
    time (k,) : time since the beginning of Kh (s)
    slide, speed (k,) : mean displacement (m) and velocity (m/s) of the block along the slope
    rest : whether it came to rest
    """

    def __init__(self, angle: float, kh: float, seconds: float, rows: np.ndarray, rest: UntilRest) -> None:
        """Take the inclination ``angle`` (rad), the coefficient ``kh`` that acts for ``seconds`` (s), the ``rows`` (k,
        3) of time, slide and speed, and the state of ``rest`` at the end."""
        self.angle, self.kh, self.seconds, self.rest = angle, kh, seconds, rest
        self.time, self.slide, self.speed = rows.T

    def strength(self) -> tuple[float, float]:
        """Return the ratio of shear strength to normal stress that follows from the accelerations, under the constant
        Kh and after it.

        For a block on a plane it is (sin b + k cos b - a/g) / (cos b - k sin b); NaN if the block did not move long
        enough.
        """
        b = self.angle
        shaking = (self.time > 1.5) & (self.time <= self.seconds)
        braked = (self.time > self.seconds + 0.25) & (self.speed > 0.15 * self.speed.max())
        on, off = (
            float(np.polyfit(self.time[part], self.speed[part], 1)[0]) if part.sum() > 2 else np.nan
            for part in (shaking, braked)
        )
        driven = (np.sin(b) + self.kh * np.cos(b) - on / G) / (np.cos(b) - self.kh * np.sin(b))
        return float(driven), float((np.sin(b) - off / G) / np.cos(b))
