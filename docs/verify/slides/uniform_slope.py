"""A uniform slope with periodic sides: endless ground whose layers liquefy, under a Kh that acts downslope.

The frame of the discs lies along the slope: x downhill along its surface, z across it, gravity tilted. Planes parallel
to the surface carry, at a normal stress p, the shear stress p (tan b + kh) by statics, where vertical inertia is left
out (p from the weight alone), and the block on top slides as Newmark's does.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from dem.acceleration import tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.case import Case
from dem.engine.engine import Engine, largest_step
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
SETTLES, TILTS, RESTS = 6.0, 5, 3.0  # s on the level, steps of a second in which it is tilted, s after that
LATER = 60.0  # s after a push, until which a slope is followed
STILL = 5e-3  # m in `LOOK` s: a crust goes on swinging by less for a while
LOOK = 0.5  # s

LayersOf = Callable[[float], Sequence[LayerSprings]]  # void ratio to springs, from the lowest layer up


class UniformSlope:
    """Discs of a uniform slope at rest, one period of it.

    Parameters
    ----------
    angle
        Of the slope (rad).
    thickness
        Of its layers across the slope (m), from the base up.
    radius
        Mean radius of the discs (m).
    layers_of
        The springs of the layers, from the base up, by the void ratio of the packing.
    length
        The period along the slope (m).
    seed
        Of the packing.
    water
        Depth below the surface from which on the ground is saturated, its water flowing along the slope (m); dry if
        None.

    Attributes
    ----------
    model : DiscModel
        The discs, at rest.
    ground : Ground
        Where they lie, for `Slider`; without any section.

    Raises
    ------
    ValueError
        For as many springs as there are no layers.
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
        columns, rows = (round(way / (2.0 * radius)) for way in (length, sum(thickness)))
        bare = tied_packing(columns, rows, radius, porosity=POROSITY, seed=seed).without_upper_plate()
        layers = list(layers_of(VOID_RATIO))
        if len(layers) != len(thickness):
            raise ValueError(f"{len(thickness)} layers have a thickness, {len(layers)} have springs")
        self.model = _discs(bare, layers)
        self._on(SETTLES)
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
        self._on(RESTS)
        for tilt in np.linspace(0.0, self.angle, TILTS + 1)[1:]:
            self.model.gravity = tilted_gravity(tilt, G)
            self._on(1.0)
        self._on(RESTS)

    def _on(self, seconds: float) -> None:
        Engine(dt=0.5 * largest_step(self.model).seconds, energies=False).run(self.model, seconds)

    def above(self, layer: int) -> np.ndarray:
        """Mask of the discs of the layers above this one."""
        return np.asarray(~self.model.fixed & (self.model.layer > layer))

    def liquefy(self, layers: Sequence[int], case: Case, settings: SlideSettings | None = None) -> Slider:
        """Liquefies layers as a case says, without Kh, and follows the slope until it rests or its time is over.

        Parameters
        ----------
        layers
            Their numbers, from the base up.
        case
            What they lose, and keep.
        settings
            Onset and time; 20 s without Kh if None. Its Kh comes on before the layers liquefy.

        Returns
        -------
        Slider
            The slide as it went in its `slide`; the slope continues from where that ended.
        """
        slider = Slider(self.model, self.ground, list(layers), case, settings or SlideSettings(kh=0.0, duration=20.0))
        slider.run()
        self.model = slider.model
        return slider

    def shake_constant(self, kh: float, seconds: float, *, layer: int = 0, later: float = LATER) -> "SlopeResponse":
        """Puts a seismic coefficient on for some seconds, then takes it away, and follows the slope until it rests.

        Parameters
        ----------
        kh
            Seismic coefficient, downhill; it comes and goes within a millisecond, as in Newmark's closed form.
        seconds
            How long it acts (s).
        layer
            The layer above which the ground is the block that slides.
        later
            Time after it until which the slope is followed (s).

        Returns
        -------
        SlopeResponse
            How far the block slid, and the strength that held it.
        """
        times = np.array([0.0, 1e-3, seconds, seconds + 1e-3])
        return self.shake(times, kh * GRAVITY * np.array([0.0, 1.0, 1.0, 0.0]), layer=layer, later=later)

    def shake(
        self, time: np.ndarray, acceleration: np.ndarray, *, layer: int = 0, later: float = LATER
    ) -> "SlopeResponse":
        """Shakes the base, and follows the slope until it rests.

        Parameters
        ----------
        time, push
            (n,) Times from 0 (s), rising, and what the ground feels along the horizontal (m/s2), downhill positive.
        layer
            The layer above which the ground is the block that slides.
        later
            Time after it until which the slope is followed (s).

        Returns
        -------
        SlopeResponse
            How far the block slid.
        """
        model, block, seconds = self.model, self.above(layer), float(time[-1])
        begin, start = model.time, model.x.copy()
        model.acceleration = self.ground.recorded_acceleration(begin + time, acceleration)
        rows: list[tuple[float, float, float]] = []

        def look(m: DiscModel) -> None:
            rows.append((m.time - begin, float((m.x - start)[block].mean()), float(m.vx[block].mean())))

        rest = run_until_rest(
            model, still=STILL, longest=seconds + later, every=LOOK, at_least=seconds + 1.0, on_look=look
        )
        return SlopeResponse(self.angle, float(acceleration.max()) / GRAVITY, seconds, np.array(rows), rest)


def _discs(packing: TiedPacking, layers: Sequence[LayerSprings], thickness: Sequence[float] = ()) -> DiscModel:
    """Discs of a periodic packing on the level, in layers of some thickness from z = 0 up."""
    layer = np.searchsorted(np.cumsum(thickness)[:-1], packing.z, side="right") if len(thickness) else 0
    return DiscModel.create(
        DiscGeometry(packing.x, packing.z, packing.radius, np.where(packing.layer < 0, -1, layer)),
        DiscMaterials(layers, law="soil"),
        DiscBoundary(period=(packing.length, 0.0)),
        gravity=(0.0, -G),
        skin=0.2 * float(packing.radius.mean()),
    )


class SlopeResponse:
    """How a block slid under Kh, or under a base that shook.

    Attributes
    ----------
    time, slide, speed : (k,)
        Since Kh came on (s), along the slope (m), and its rate (m/s): means over the block.
    rest : UntilRest
        Whether it came to rest.
    """

    def __init__(self, angle: float, kh: float, seconds: float, rows: np.ndarray, rest: UntilRest) -> None:
        """angle: of the slope (rad); kh: held for `seconds` (s); rows (k, 3): time, slide, speed; rest: its end."""
        self.angle, self.kh, self.seconds, self.rest = angle, kh, seconds, rest
        self.time, self.slide, self.speed = rows.T

    def strength(self) -> tuple[float, float]:
        """Shear strength over normal stress that its accelerations show under a constant Kh, and while it is braked.

        Of a block on a plane: (sin b + k cos b - a/g) / (cos b - k sin b); NaN where it did not move long enough.
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
