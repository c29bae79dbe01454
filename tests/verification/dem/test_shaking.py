"""Discs shaken in time at their base: the elastic column's amplification, and the block on a plane by Newmark."""

from dataclasses import replace

import numpy as np
import pytest

from dem.acceleration import Acceleration
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.model import DiscModel
from tests.support.dem_cases import BARE_SPRINGS, FLOOR, GRAVITY, MASS, RADIUS
from workflow.estimates.sliding_block import newmark

KN, KS = 1.0e9, 0.5e9
ROWS, COLUMNS = 16, 8
SPACING = 2.0 * RADIUS * (1.0 - 1e-3)


def column(beta: float = 0.0) -> DiscModel:
    """A triangular lattice between tied sides, its lowest row fixed, in equilibrium; dashpots beta (s) times springs.

    Contacts across the rows carry the weight above them by their overlap alone, those along a row are pressed.
    """
    height, heights = 0.0, [0.0]
    for row in range(1, ROWS + 1):
        supported = MASS * GRAVITY * (ROWS + 1 - row)
        length = 2.0 * RADIUS - supported / (2.0 * np.sqrt(1.0 - 0.25 * (SPACING / (2.0 * RADIUS)) ** 2)) / KN
        height += float(np.sqrt(length**2 - 0.25 * SPACING**2))
        heights.append(height)
    row, place = np.repeat(np.arange(ROWS + 1), COLUMNS), np.tile(np.arange(COLUMNS), ROWS + 1)
    soil = replace(BARE_SPRINGS, kn=KN, ks=KS, cn=beta * KN, ct=beta * KS, friction=1e9)
    return DiscModel.create(
        DiscGeometry((place + 0.5 * (row % 2)) * SPACING, np.array(heights)[row], RADIUS, np.where(row == 0, -1, 0)),
        DiscMaterials([soil], law="soil"),
        DiscBoundary(period=(SPACING * COLUMNS, 0.0)),
        gravity=(0.0, -GRAVITY),
    )


@pytest.mark.parametrize(("mode", "cycles"), [(1, 20), (2, 60)])
def test_an_elastic_column_amplifies_as_the_continuum_does(mode: int, cycles: int) -> None:
    """|1 / cos(k H)| with k = ω / (Vs √(1 + i β ω)), Kelvin-Voigt ground on a rigid base (Kramer 1996, sec. 7.2.1.2).

    G = √3/4 (kn + ks) of the lattice; damping 5 % at the first mode, 15 % at the second; half a row more to the top.
    """
    still = column()
    row = float(still.z.max()) / ROWS
    height = row * (ROWS + 0.5)
    speed = np.sqrt(np.sqrt(3.0) / 4.0 * (KN + KS) / (MASS / (2.0 * RADIUS * row)))
    first = 0.5 * np.pi * speed / height
    beta, omega = 0.1 / first, (2 * mode - 1) * first
    period, size = 2.0 * np.pi / omega, 1e-3
    model = column(beta)
    times = np.linspace(0.0, cycles * period, 80 * cycles + 1)
    model.acceleration = Acceleration(times, -size * np.sin(omega * times), np.zeros_like(times))
    before, top = model.x.copy(), np.argsort(model.z)[-COLUMNS:]
    engine = Engine(dt=0.8 * largest_step(model).seconds)
    engine.run(model, (cycles - 2) * period)
    seen: list[tuple[float, float]] = []
    engine.run(
        model, 2.0 * period, every=period / 60.0,
        on_output=lambda m: seen.append((m.time, float((m.x - before)[top].mean()))),
    )  # fmt: skip
    time, moved = np.array(seen).T
    waves = np.column_stack([np.sin(omega * time), np.cos(omega * time), np.ones(len(time))])
    sine, cosine, _ = np.linalg.lstsq(waves, moved, rcond=None)[0]
    base = size / omega**2  # the base moves by -base sin ωt
    exact = 1.0 / abs(np.cos(omega * height / (speed * np.sqrt(1.0 + 1j * beta * omega))))
    assert np.hypot(sine - base, cosine) / base == pytest.approx(exact, rel=0.05)


def record() -> tuple[np.ndarray, np.ndarray]:
    """Two wavelets of 1.2 and 0.9 Hz, 10 s long, up to 0.45 g."""
    time = np.linspace(0.0, 10.0, 1001)
    shape = np.exp(-(((time - 4.0) / 1.6) ** 2))
    return time, GRAVITY * shape * (0.3 * np.sin(2.0 * np.pi * 1.2 * time) + 0.18 * np.cos(2.0 * np.pi * 0.9 * time))


@pytest.mark.parametrize("tilt", [0.15, 0.25])
def test_a_block_on_a_plane_slides_as_newmark_says(tilt: float) -> None:
    """A disc that cannot turn resists kc = μ cos β - sin β along the plane; uphill it never slides."""
    friction = 0.35
    soil = replace(
        BARE_SPRINGS, kn=1e9, ks=5e8, cn=0.4 * np.sqrt(MASS * 1e9), ct=0.4 * np.sqrt(MASS * 5e8), friction=friction
    )
    sunk = MASS * GRAVITY * np.cos(tilt) / 1e9
    time, shaking = record()
    model = DiscModel.create(
        DiscGeometry([0.0], [RADIUS - sunk], RADIUS),
        DiscMaterials([soil], turns=False),
        DiscBoundary(FLOOR),
        gravity=(GRAVITY * np.sin(tilt), -GRAVITY * np.cos(tilt)),
    )
    Engine(dt=1e-4, balance=np.inf).run(model, 2.0)  # at rest on the slope, held by its shear spring
    start = float(model.x[0])
    model.acceleration = Acceleration(model.time + time, shaking, np.zeros_like(time))
    Engine(dt=1e-4, balance=np.inf).run(model, 12.0)
    kc = friction * np.cos(tilt) - np.sin(tilt)
    exact = newmark(time, shaking * 9.80665 / GRAVITY, kc).permanent * GRAVITY / 9.80665
    assert exact > 0.05
    assert float(model.x[0]) - start == pytest.approx(exact, rel=0.01)
