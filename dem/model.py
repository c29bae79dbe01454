"""DiscModel: the whole state of the discs as plain arrays, in the order the user numbered them.

x to the right, z up (m); angles and spins positive counter-clockwise. Rotation is kept as radius times spin and radius
times angle, since that is what contacts work with. Everything a run needs is here, so that a
checkpoint is this and no more, and a run from a checkpoint has the same bits as the run without.
"""

import copy
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dem import checkpoint
from dem.acceleration import Acceleration
from dem.kernels.contact import DEPTH, KN, KPN, KPS, KS, STOP
from dem.kernels.neighbours import find_lines, find_pairs, share_out, spatial_order
from dem.springs import Law, LayerSprings, Mean, PairTable, pair_table

LEDGER_COLUMNS = 7
# what a pair remembers, of the paper's discs and of soil discs besides; a new one starts with nothing
MEMORY = ("pore_length", "shear", "pore_shear", "force_x", "force_z")
ROLLING_MEMORY = ("rolled", "torque")
# what changes its sign when the two discs of a pair change places
TURNED = ("force_x", "force_z", "rolled", "torque")
LINE_MEMORY = ("line_shear", "line_force_x", "line_force_z", "line_rolled", "line_torque")
SORT_EVERY = 16  # lists made between two sortings in space


@dataclass(eq=False)
class DiscModel:
    """n discs, their contacts and the table of springs. Make one with `DiscModel.create`.

    Whoever changes lines or skin by hand calls `make_list` then; positions are looked at when a run begins.

    Attributes
    ----------
    x, z, roll : (n,)
        Position, and radius times angle turned (m).
    vx, vz, vr : (n,)
        Velocity, and radius times spin, at `time` (m/s).
    vx_half, vz_half, vr_half : (n,)
        The same half a step before (m/s).
    radius : (n,)
        m.
    mass : (n,)
        With the full density (kg/m).
    weight : (n,)
        Effective over full density.
    inertia_ratio : (n,)
        m r^2/I: 2 for a disc, 0 for one that cannot turn.
    layer : (n,) int32
        Number in the table of springs, -1 for boundary discs.
    fixed : (n,) bool
        Whether a disc keeps its velocity whatever pushes it.
    x_list, z_list : (n,)
        Position when the neighbour list was made (m).
    order : (n,) int32
        Numbers of the discs, sorted in space.
    pair_i, pair_j : (pairs,) int32
        The neighbour list.
    shear, pore_shear : (pairs,)
        Tangential forces kept by element and pore spring (N).
    pore_length : (pairs,)
        Distance at which the pore spring was set (m), negative once cracked, 0 without one.
    force_x, force_z : (pairs,)
        Force on pair_j in the last step (N), for the ledger.
    rolled, torque : (pairs,)
        Rolling moment over r_i r_j/(r_i + r_j) kept by the spring, and that of spring and dashpot in the last step (N);
        empty for the paper's discs.
    lines : (k, 6)
        Point (m), inward normal, reach (m) along (-nz, nx) of rigid lines.
    line_disc, line_id : (contacts with lines,)
        Discs near rigid lines, and numbers of those.
    line_shear, line_force_x, line_force_z, line_rolled, line_torque : (contacts with lines,)
        The same memory of theirs (N).
    energy_sums : (slices, 7)
        Work and losses so far (J/m), columns as in `kernels.stepping`.
    springs : PairTable
        Constants by kind of pair.
    mean, law : str
        How they were made of the layers' constants, and which law holds.
    gravity : (float, float)
        m/s2.
    acceleration : Acceleration
        Of the frame, in time.
    skin : float
        Margin of the neighbour list (m).
    time, steps, last_dt : float, int, float
        Time (s), steps taken, and the step that the half-step velocities belong to (s), 0 if set by hand.
    lists_made : int
        How often the neighbour list was made.
    energy_known, energy_edited, turnover : float
        Energy at the end of the last run, energy that came with changes between runs, and the most in play (J/m).
    """

    x: np.ndarray
    z: np.ndarray
    roll: np.ndarray
    vx: np.ndarray
    vz: np.ndarray
    vr: np.ndarray
    vx_half: np.ndarray
    vz_half: np.ndarray
    vr_half: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    weight: np.ndarray
    inertia_ratio: np.ndarray
    layer: np.ndarray
    fixed: np.ndarray
    x_list: np.ndarray
    z_list: np.ndarray
    order: np.ndarray
    pair_i: np.ndarray
    pair_j: np.ndarray
    shear: np.ndarray
    pore_shear: np.ndarray
    pore_length: np.ndarray
    force_x: np.ndarray
    force_z: np.ndarray
    rolled: np.ndarray
    torque: np.ndarray
    lines: np.ndarray
    line_disc: np.ndarray
    line_id: np.ndarray
    line_shear: np.ndarray
    line_force_x: np.ndarray
    line_force_z: np.ndarray
    line_rolled: np.ndarray
    line_torque: np.ndarray
    energy_sums: np.ndarray
    springs: PairTable
    mean: Mean
    law: Law
    gravity: tuple[float, float]
    acceleration: Acceleration
    skin: float
    time: float = 0.0
    steps: int = 0
    last_dt: float = 0.0
    lists_made: int = 0
    energy_known: float = float("nan")
    energy_edited: float = 0.0
    turnover: float = 0.0

    @classmethod
    def create(
        cls,
        x: np.ndarray,
        z: np.ndarray,
        radius: np.ndarray | float,
        layers: Sequence[LayerSprings],
        layer: np.ndarray | int = 0,
        *,
        fixed: np.ndarray | bool = False,
        turns: np.ndarray | bool = True,
        gravity: tuple[float, float] = (0.0, 0.0),
        acceleration: Acceleration | None = None,
        lines: np.ndarray | None = None,
        mean: Mean = "arithmetic",
        law: Law = "paper",
        skin: float | None = None,
    ) -> "DiscModel":
        """Discs at rest. layer: index into `layers`, -1 for boundary discs, which are fixed too.

        turns: False for discs that cannot rotate; those of layers with infinite rolling friction cannot either.
        mean, law: see `springs.pair_table`. skin (m): margin of the neighbour list, 0.4 mean radii if not given.
        Raises ValueError for arrays that do not fit together.
        """
        x, z = np.array(x, float), np.array(z, float)
        n = len(x)
        radii = np.array(np.broadcast_to(np.asarray(radius, float), n))
        layer = np.array(np.broadcast_to(layer, n), np.int32)
        still = np.array(np.broadcast_to(fixed, n), bool) | (layer < 0)
        if n == 0 or z.shape != (n,) or not (np.isfinite(x).all() and np.isfinite(z).all()):
            raise ValueError("discs: x and z must be finite, of one length, and not empty")
        if not (radii > 0.0).all():
            raise ValueError(f"discs: radius of disc {int(np.argmin(radii))} is {radii.min()}, must be positive")
        if layer.max() >= len(layers) or layer.min() < -1:
            raise ValueError(f"discs: layer {layer.max()} of {len(layers)} layers (they count from 0, -1 is boundary)")
        density = np.array([s.density for s in layers] + [layers[0].density])[layer]
        effective = np.array([s.effective_density for s in layers] + [0.0])[layer]
        margin = float(0.4 * radii.mean()) if skin is None else skin
        if not margin > 0.0:
            raise ValueError(f"discs: the skin of the neighbour list must be positive, is {margin}")
        free = np.isfinite([s.rolling_friction for s in layers] + [0.0])[layer]
        rotates = np.where(np.broadcast_to(turns, n) & free, 2.0, 0.0)
        # what belongs to contacts is there once the list is made
        numbers = ("pair_i", "pair_j", "line_disc", "line_id")
        contacts: dict[str, Any] = {name: np.zeros(0) for name in MEMORY + ROLLING_MEMORY + LINE_MEMORY}
        contacts |= {name: np.zeros(0, np.int32) for name in numbers}
        motion: dict[str, Any] = {
            name: np.zeros(n) for name in ("roll", "vx", "vz", "vr", "vx_half", "vz_half", "vr_half")
        }
        model = cls(
            x=x, z=z, **motion, radius=radii, mass=np.pi * radii**2 * density, weight=effective / density,
            inertia_ratio=rotates, layer=layer, fixed=still, x_list=x.copy(), z_list=z.copy(),
            order=np.arange(n, dtype=np.int32), **contacts,
            lines=np.array(lines if lines is not None else np.zeros((0, 6)), float).reshape(-1, 6),
            energy_sums=np.zeros((n // 64 + 1, LEDGER_COLUMNS)), springs=pair_table(layers, mean, law), mean=mean,
            law=law, gravity=(float(gravity[0]), float(gravity[1])), acceleration=acceleration or Acceleration(),
            skin=margin,
        )  # fmt: skip
        model.make_list()
        return model

    def __len__(self) -> int:
        return len(self.x)

    @property
    def memory(self) -> tuple[str, ...]:
        """Names of what a pair remembers."""
        return MEMORY + (ROLLING_MEMORY if self.law == "soil" else ())

    @property
    def spin(self) -> np.ndarray:
        """Angular velocity (1/s), counter-clockwise."""
        return self.vr / self.radius

    @property
    def angle(self) -> np.ndarray:
        """How far each disc has turned (rad), counter-clockwise."""
        return self.roll / self.radius

    def set_velocity(
        self,
        vx: np.ndarray | float,
        vz: np.ndarray | float,
        spin: np.ndarray | float = 0.0,
        where: np.ndarray | None = None,
    ) -> None:
        """Velocities (m/s, 1/s) of all discs, or of those in the mask `where`, from now on.

        Fixed discs keep the velocity they are given: that moves a boundary.
        """
        chosen = np.ones(len(self), bool) if where is None else where
        rim_speed = np.broadcast_to(spin, int(chosen.sum())) * self.radius[chosen]
        for value, name in ((vx, "vx"), (vz, "vz"), (rim_speed, "vr")):
            getattr(self, name)[chosen] = value
            getattr(self, name + "_half")[:] = getattr(self, name)
        self.last_dt = 0.0

    def kind(self, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """Column of the table of springs for pairs of discs."""
        code = np.where(self.layer < 0, self.springs.size - 1, self.layer).astype(np.uint16)
        return code[i] * np.uint16(self.springs.size) + code[j]

    def distance(self) -> np.ndarray:
        """Distance of the centres of all listed pairs (m)."""
        i, j = self.pair_i, self.pair_j
        return np.hypot(self.x[j] - self.x[i], self.z[j] - self.z[i])

    def make_list(self) -> None:
        """Makes the neighbour list for where the discs are now; memory of contacts is carried over."""
        if self.lists_made % SORT_EVERY == 0:
            self.order = spatial_order(self.x, self.z, 2.0 * self.radius.mean())
        self.lists_made += 1
        self._list(1.0, self.skin)
        self.x_list, self.z_list = self.x.copy(), self.z.copy()

    def _list(self, factor: float, skin: float) -> None:
        order = self.order
        number = np.empty(len(self), np.int32)
        number[order] = np.arange(len(self), dtype=np.int32)
        xs, zs, rs, still = self.x[order], self.z[order], self.radius[order], self.fixed[order]
        i, j, old = find_pairs(
            xs, zs, rs, still, factor, skin, number[self.pair_i], number[self.pair_j], self.pore_length
        )
        share_out(i, j, len(self))
        for name in self.memory:
            values = np.append(getattr(self, name), 0.0)
            setattr(self, name, values[old])
        # a pair may have changed its owner
        turned = np.append(self.pair_i, -1)[old] == order[j]
        for name in set(TURNED) & set(self.memory):
            getattr(self, name)[turned] *= -1.0
        self.pair_i, self.pair_j = order[i], order[j]
        disc, line = find_lines(xs, zs, rs, still, skin, self.lines, 4.0 * rs.max())
        kept = {key: k for k, key in enumerate(zip(self.line_disc, self.line_id, strict=True))}
        self.line_disc, self.line_id = order[disc], line
        before = np.array([kept.get(key, -1) for key in zip(self.line_disc, line, strict=True)], int)
        for name in LINE_MEMORY:
            setattr(self, name, np.append(getattr(self, name), 0.0)[before])

    def set_pore_springs(self) -> int:
        """Sets a pore spring, free of force, between all discs with D <= alpha (r_i + r_j), eq. (14).

        Pairs that have one keep it, whole or cracked. Returns how many were set.
        """
        alpha = self.springs.alpha
        self._list(float(alpha.max()) * (1.0 + 1e-12), 0.0)
        reach = alpha[self.kind(self.pair_i, self.pair_j)] * (self.radius[self.pair_i] + self.radius[self.pair_j])
        distance = self.distance()
        new = (self.pore_length == 0.0) & (distance <= reach)
        self.pore_length[new] = distance[new]
        self.pore_shear[new] = 0.0
        self.make_list()
        return int(new.sum())

    def cut_pore_springs(self, layers: Sequence[int] | None = None) -> int:
        """Takes the pore springs away whose discs, one or both, are in these layers; all if none are named.

        Unlike cracked ones they resist nothing from then on. Returns how many were cut.
        """
        chosen = np.ones(len(self.pair_i), bool)
        if layers is not None:
            chosen = np.isin(self.layer[self.pair_i], layers) | np.isin(self.layer[self.pair_j], layers)
        chosen &= self.pore_length != 0.0
        before = self._spring_forces()
        self.pore_length[chosen] = 0.0
        self.pore_shear[chosen] = 0.0
        self._change_forces(before)
        return int(chosen.sum())

    def set_springs(self, layers: Sequence[LayerSprings]) -> None:
        """Other constants from now on, for the same layers in the same order; overlaps and slips stay as they are.

        So all spring forces, kept ones too, change with their stiffness. Masses stay those of the discs.
        """
        if len(layers) != len(self.springs.layers):
            raise ValueError(f"{len(layers)} layers given, the discs have {len(self.springs.layers)}")
        new = pair_table(layers, self.mean, self.law)
        before = self._spring_forces()
        kind = self.kind(self.pair_i, self.pair_j)
        line_kind = self.layer[self.line_disc]
        for names, row, columns, old_table, new_table in (
            (("shear", "rolled", "torque"), KS, kind, self.springs.pairs, new.pairs),
            (("pore_shear",), KPS, kind, self.springs.pairs, new.pairs),
            (("line_shear", "line_rolled", "line_torque"), KS, line_kind, self.springs.lines, new.lines),
        ):
            old, given = old_table[row, columns], new_table[row, columns]
            ratio = np.divide(given, old, out=np.zeros(len(old)), where=old > 0.0)
            for name in names:
                values = getattr(self, name)
                values *= ratio[: len(values)]  # no discs of the paper remember rolling
        self.springs = new
        self._change_forces(before)

    def _spring_forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Normal and tangential force of element and pore springs of all pairs, dashpots left out (N)."""
        constants = self.springs.pairs[:, self.kind(self.pair_i, self.pair_j)]
        distance = self.distance()
        radii = self.radius[self.pair_i] + self.radius[self.pair_j]
        over = radii - distance
        element = constants[KN] * np.maximum(over, 0.0)
        element += constants[STOP] * np.maximum(over - constants[DEPTH] * radii, 0.0)
        pore = constants[KPN] * (np.abs(self.pore_length) - distance)
        pore = np.where(self.pore_length > 0.0, pore, np.maximum(pore, 0.0))
        return element + pore, self.shear + self.pore_shear

    def _change_forces(self, before: tuple[np.ndarray, np.ndarray]) -> None:
        """Lets the forces of the last step be those of the springs as they now are, for the means of the ledger."""
        normal, tangential = (a - b for a, b in zip(self._spring_forces(), before, strict=True))
        distance = self.distance()
        nx = (self.x[self.pair_j] - self.x[self.pair_i]) / distance
        nz = (self.z[self.pair_j] - self.z[self.pair_i]) / distance
        self.force_x += normal * nx + tangential * nz
        self.force_z += normal * nz - tangential * nx

    def copy(self) -> "DiscModel":
        """The same discs once more, to go another way."""
        return copy.deepcopy(self)

    def save(self, path: Path | str) -> None:
        """Checkpoint: all of it into one HDF5 file, which is never half written."""
        arrays = {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        arrays |= {f"acceleration_{name}": value for name, value in vars(self.acceleration).items()}
        plain = {name: value for name, value in vars(self).items() if isinstance(value, int | float | str)}
        layers = [asdict(layer) for layer in self.springs.layers]
        checkpoint.write(Path(path), arrays, plain | {"gravity": self.gravity, "layers": layers})

    @classmethod
    def load(cls, path: Path | str) -> "DiscModel":
        """The model of a checkpoint. Raises OSError, KeyError or TypeError for a file that is none of this version."""
        arrays, plain = checkpoint.read(Path(path))
        series = Acceleration(*(arrays.pop(f"acceleration_{name}") for name in ("times", "x", "z")))
        layers = [LayerSprings(**layer) for layer in plain.pop("layers")]
        gx, gz = plain.pop("gravity")
        springs = pair_table(layers, plain["mean"], plain["law"])
        values: dict[str, Any] = arrays | plain
        return cls(**values, gravity=(gx, gz), springs=springs, acceleration=series)
