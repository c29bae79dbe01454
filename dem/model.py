"""Provides DiscModel: the discs, and operations on the discs between runs."""

import copy
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from dem.acceleration import Acceleration
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.chunked_map import Ranges, pairs_near, serial
from dem.kernels.arguments import ENERGY_COLUMNS
from dem.kernels.contact import ATTRACTION_REACH, KN, KPN, KPS, KS, STOP_OVERLAP, STOP_STIFFNESS
from dem.kernels.layout import LANES
from dem.kernels.neighbours import Near, find_lines, known_pairs, spatial_order
from dem.kernels.ownership import carry_over, reversal_signs, share_out
from dem.kernels.period import folded
from dem.liquefied_ground import change_areas, list_liquefied, match_strength
from dem.pair_table import PairTable, pair_table, with_line_strengths
from dem.springs import Law, LayerSprings, Mean, Strength
from dem.state import LINE_MEMORY, MEMORY, ROLLING_MEMORY, DiscState
from dem.undisturbed_contacts import still_undisturbed
from meshes.files import read_checkpoint, write_checkpoint

# what changes its sign when the two discs of a pair change places
SIGN_CHANGES = ("force_x", "force_z", "rolled", "torque")
ATTRACTION_GAP = 0.125  # largest gap, over the skin, across which discs of cohesive soil attract each other
SORTING_INTERVAL = 16  # neighbour lists between two sortings in space


class DiscModel(DiscState):
    """Holds the discs, with operations on them between runs. `DiscModel.create` makes a model.

    Call `make_list` after changing lines or skin directly; changed positions are detected when a run begins.
    """

    @classmethod
    def create(
        cls,
        geometry: DiscGeometry,
        materials: DiscMaterials,
        boundary: DiscBoundary | None = None,
        *,
        gravity: tuple[float, float] = (0.0, 0.0),
        acceleration: Acceleration | None = None,
        skin: float | None = None,
    ) -> "DiscModel":
        """Make a model of discs at rest.

        Parameters
        ----------
        geometry
            Positions, radii and layers of the discs.
        materials
            The constants of the layers, and the contact law.
        boundary
            Rigid lines and periodic sides; none if left out.
        gravity
            Gravity along x and z (m/s2).
        acceleration
            External acceleration as a function of time; no acceleration if left out.
        skin
            Margin of the neighbour list (m); 0.4 mean radii if left out.

        Returns
        -------
        DiscModel
            The model with its neighbour list, at time 0.

        Raises
        ------
        ValueError
            If layers, period or skin do not fit the discs.
        """
        boundary = boundary or DiscBoundary()
        x, z, radii, layer = geometry.x, geometry.z, geometry.radius, geometry.layer
        n, law, mean = len(x), materials.law, materials.mean
        materials.check_numbers(layer)
        boundary.check_period(law, float(radii.max()))
        margin = float(0.4 * radii.mean()) if skin is None else skin
        if not margin > 0.0:
            raise ValueError(f"discs: the margin of the neighbour list (skin) must be positive, but is {margin}")
        density, effective = materials.densities(layer)
        # what belongs to contacts is there once the list is made
        numbers = ("pair_i", "pair_j", "line_disc", "line_id")
        contacts: dict[str, Any] = {name: np.zeros(0) for name in MEMORY + ROLLING_MEMORY + LINE_MEMORY}
        contacts |= {name: np.zeros(0, np.int32) for name in numbers}
        motion: dict[str, Any] = {
            name: np.zeros(n) for name in ("roll", "vx", "vz", "vr", "vx_half", "vz_half", "vr_half")
        }
        model = cls(
            x=x.copy(), z=z.copy(), **motion, radius=radii.copy(), mass=np.pi * radii**2 * density,
            weight=effective / density, pore_acceleration_x=np.zeros(n), pore_acceleration_z=np.zeros(n),
            added_mass_x=np.zeros(n), added_mass_z=np.zeros(n),
            inertia_ratio=np.where(materials.rotates(layer), 2.0, 0.0), layer=layer.copy(),
            fixed=geometry.fixed.copy(), x_list=x.copy(), z_list=z.copy(), order=np.arange(n, dtype=np.int32),
            **contacts, lines=boundary.lines.copy(), line_strength=boundary.strengths,
            energy_sums=np.zeros((n // LANES + 1, ENERGY_COLUMNS)),
            springs=_table(materials.layers, mean, law, margin, boundary.strengths), mean=mean, law=law,
            period=boundary.period, gravity=(float(gravity[0]), float(gravity[1])),
            acceleration=acceleration or Acceleration(), skin=margin,
        )  # fmt: skip
        model.make_list()
        return model

    def set_velocity(
        self,
        vx: np.ndarray | float,
        vz: np.ndarray | float,
        spin: np.ndarray | float = 0.0,
        where: np.ndarray | None = None,
    ) -> None:
        """Set the velocities (m/s, 1/s) of all discs, or of those in the mask `where`.

        Fixed discs keep the given velocity, which moves a boundary. vx, vz: velocities (m/s); spin: angular velocity
        (1/s).
        """
        chosen = np.ones(len(self), bool) if where is None else where
        rim_speed = np.broadcast_to(spin, int(chosen.sum())) * self.radius[chosen]
        for value, name in ((vx, "vx"), (vz, "vz"), (rim_speed, "vr")):
            getattr(self, name)[chosen] = value
            getattr(self, name + "_half")[:] = getattr(self, name)
        self.last_dt = 0.0

    @property
    def leeway(self) -> float:
        """Return the largest displacement (m) of discs before the neighbour list must be renewed."""
        return 0.5 * (self.skin - float(self.springs.pairs[ATTRACTION_REACH].max()))

    def refresh_list(self) -> None:
        """Make the neighbour list if there is none, or if discs have moved by more than half its margin."""
        if self.lists_made == 0 or np.any(np.hypot(self.x - self.x_list, self.z - self.z_list) > self.leeway):
            self.make_list()

    def make_list(self, in_ranges: Ranges = serial) -> None:
        """Make the neighbour list for the present positions; the history of contacts is copied."""
        if self.lists_made % SORTING_INTERVAL == 0:
            x, z = folded(self.x, self.z, self.repeats)
            self.order = spatial_order(x, z, 2.0 * self.radius.mean())
        self.lists_made += 1
        self._list(1.0, self.skin, in_ranges)
        match_strength(self)
        list_liquefied(self, in_ranges)
        self.x_list, self.z_list = self.x.copy(), self.z.copy()

    def _list(self, factor: float, skin: float, in_ranges: Ranges = serial) -> None:
        order = self.order
        xs, zs, rs, still = self.x[order], self.z[order], self.radius[order], self.fixed[order]
        near = Near(xs, zs, rs, still, factor, skin, self.repeats)
        known = known_pairs(self.pair_i, self.pair_j, self.places)
        i, j, old = pairs_near(near, known, self.pore_length, in_ranges)
        if self._gone.any():  # contacts that liquefied ground has lost would be computed in vain
            remaining_pairs = ~self._gone[self.kind(order[i], order[j])]
            i, j, old = i[remaining_pairs], j[remaining_pairs], old[remaining_pairs]
        share_out(i, j, len(self))
        owner, other = order[i], order[j]
        # a pair may have changed its owner
        sign = reversal_signs(self.pair_i, other, old)
        self._carry(old, sign, in_ranges)
        self.pair_i, self.pair_j = owner, other
        self.undisturbed = still_undisturbed(self, old)
        disc, line = find_lines(xs, zs, rs, still, skin, self.lines, 4.0 * rs.max())
        places = {key: k for k, key in enumerate(zip(self.line_disc, self.line_id, strict=True))}
        self.line_disc, self.line_id = order[disc], line
        before = np.array([places.get(key, -1) for key in zip(self.line_disc, line, strict=True)], int)
        for name in LINE_MEMORY:
            setattr(self, name, np.append(getattr(self, name), 0.0)[before])

    @property
    def _gone(self) -> np.ndarray:
        """Return a mask of the kinds of pairs whose contacts have no spring at all."""
        return np.asarray((self.springs.pairs[KN] == 0.0) & (self.springs.pairs[KPN] == 0.0))

    def _carry(self, old: np.ndarray, sign: np.ndarray, in_ranges: Ranges) -> None:
        """Copy the history variables of the contacts to a new list; old, sign, in_ranges: see `carry_over`."""
        before = tuple(getattr(self, name) for name in self.memory)
        after = tuple(np.empty(len(old)) for _ in before)
        turns = np.array([name in SIGN_CHANGES for name in self.memory])
        in_ranges(lambda begin, end: carry_over(begin, end, before, old, sign, turns, after), len(old))
        for name, values in zip(self.memory, after, strict=True):
            setattr(self, name, values)

    def set_pore_springs(self) -> int:
        """Set a pore spring without force between all discs whose distance D is at most alpha (r_i + r_j), equation 14
        of the paper.

        Pairs that already have a pore spring, intact or cracked, keep it. Returns the number of new springs.
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
        """Remove the pore springs with one or both discs in these layers; without ``layers``, remove all pore springs.

        Removed springs, unlike cracked ones, do not resist compression. Returns the number of removed springs.
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
        """Replace the constants of the layers, in the same order; overlaps and slips are unchanged.

        All spring forces, including stored ones, therefore change with the stiffness. Masses are unchanged.
        """
        if len(layers) != len(self.springs.layers):
            raise ValueError(f"{len(layers)} layers were given; the discs have {len(self.springs.layers)} layers")
        new = _table(layers, self.mean, self.law, self.skin, self.line_strength)
        before = self._spring_forces()
        kind = self.pair_kind
        line_kind = self.line_kind
        for names, row, columns, old_table, new_table in (
            (("shear", "rolled", "torque"), KS, kind, self.springs.pairs, new.pairs),
            (("pore_shear",), KPS, kind, self.springs.pairs, new.pairs),
            (("line_shear", "line_rolled", "line_torque"), KS, line_kind, self.springs.lines, new.lines),
        ):
            old_value, new_value = old_table[row, columns], new_table[row, columns]
            ratio = np.divide(new_value, old_value, out=np.zeros(len(old_value)), where=old_value > 0.0)
            for name in names:
                values = getattr(self, name)
                values *= ratio[: len(values)]  # no discs of the paper remember rolling
        gone = self._gone
        self.springs = new
        self._change_forces(before)
        if not np.array_equal(gone, self._gone):
            self.make_list()

    def remove_lines(self, which: Sequence[int]) -> None:
        """Remove rigid lines by their numbers, as when a gate opens. Contacts with other lines keep their forces.

        Parameters
        ----------
        which
            Numbers of lines, from 0. The remaining lines are renumbered: line 2 becomes line 1 if line 1 is removed.

        Raises
        ------
        ValueError
            If there is no line of such a number.
        """
        count = len(self.lines)
        if any(not 0 <= k < count for k in which):
            raise ValueError(
                f"there is no rigid line {[k for k in which if not 0 <= k < count]}; there are {count} lines, from 0 on"
            )
        remaining = np.setdiff1d(np.arange(count), which)
        number = np.full(count, -1, np.int32)
        number[remaining] = np.arange(len(remaining), dtype=np.int32)
        remaining_contacts = number[self.line_id] >= 0
        for name in ("line_disc", *LINE_MEMORY):
            setattr(self, name, getattr(self, name)[remaining_contacts])
        self.line_id = number[self.line_id[remaining_contacts]]
        self.lines = self.lines[remaining].copy()
        if self.line_strength:
            self.line_strength = tuple(self.line_strength[k] for k in remaining)
            self.springs = replace(self.springs, line_block=tuple(self.springs.line_block[k] for k in remaining))

    def set_radius(self, radius: np.ndarray) -> None:
        """Replace the radii (m): discs swell, or shrink as in liquefied ground that loses volume.

        Mass, angle and spin are unchanged; forces change with the overlaps. The areas with voids, on which pore
        pressure acts, change in proportion.
        """
        if radius.shape != self.radius.shape or not (radius > 0.0).all():
            raise ValueError(
                f"discs: expected {len(self)} positive radii, not {radius.size} radii of which the smallest is "
                f"{radius.min()}"
            )
        before = self._spring_forces()
        for values in (self.roll, self.vr, self.vr_half):
            values *= radius / self.radius
        change_areas(self, (radius / self.radius) ** 2)
        self.radius = radius.copy()
        self._change_forces(before)
        self.make_list()

    def _spring_forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the normal and tangential force of contact and pore springs of all pairs, dashpots left out (N)."""
        constants = self.springs.pairs[:, self.pair_kind]
        distance = self.distance()
        radii = self.radius[self.pair_i] + self.radius[self.pair_j]
        over = radii - distance
        element = np.where(over > -constants[ATTRACTION_REACH], constants[KN] * over, 0.0)
        element += constants[STOP_STIFFNESS] * np.maximum(over - constants[STOP_OVERLAP] * radii, 0.0)
        pore = constants[KPN] * (np.abs(self.pore_length) - distance)
        pore = np.where(self.pore_length > 0.0, pore, np.maximum(pore, 0.0))
        return element + pore, self.shear + self.pore_shear

    def _change_forces(self, before: tuple[np.ndarray, np.ndarray]) -> None:
        """Replace the forces of the last step by the forces of the present springs; the energy balance takes means of
        both."""
        normal, tangential = (a - b for a, b in zip(self._spring_forces(), before, strict=True))
        nx, nz = self.branch() / self.distance()
        self.force_x += normal * nx + tangential * nz
        self.force_z += normal * nz - tangential * nx

    def copy(self) -> "DiscModel":
        """Return an independent copy of the discs."""
        return copy.deepcopy(self)

    def save(self, path: Path | str) -> None:
        """Write a checkpoint of the whole model to one file, completely or not at all."""
        arrays = {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        arrays |= {f"acceleration_{name}": value for name, value in vars(self.acceleration).items()}
        plain = {name: value for name, value in vars(self).items() if isinstance(value, int | float | str)}
        layers = [asdict(layer) for layer in self.springs.layers]
        strengths = [strength and asdict(strength) for strength in self.line_strength]
        more = {
            "gravity": self.gravity,
            "period": self.period,
            "place": self.place,
            "layers": layers,
            "line_strength": strengths,
        }
        write_checkpoint(Path(path), arrays, plain | more)

    @classmethod
    def load(cls, path: Path | str) -> "DiscModel":
        """Read the model of a checkpoint. Raises OSError, KeyError or TypeError for a file of another version."""
        arrays, plain = read_checkpoint(Path(path))
        series = Acceleration(*(arrays.pop(f"acceleration_{name}") for name in ("times", "x", "z")))
        layers = [LayerSprings(**layer) for layer in plain.pop("layers")]
        plain.setdefault("place", (0.0, 0.0))  # of discs that were stored in the axes of their section
        for name in ("gravity", "period", "place"):  # JSON knows no tuples
            plain[name] = tuple(plain[name]) if plain[name] is not None else None
        plain["line_strength"] = tuple(strength and Strength(**strength) for strength in plain["line_strength"])
        springs = _table(layers, plain["mean"], plain["law"], plain["skin"], plain["line_strength"])
        values: dict[str, Any] = arrays | plain
        return cls(**values, springs=springs, acceleration=series)


def _table(
    layers: Sequence[LayerSprings], mean: Mean, law: Law, skin: float, strengths: Sequence[Strength | None]
) -> PairTable:
    """Return the constants of all contacts, including those with rigid lines."""
    return with_line_strengths(pair_table(layers, mean, law, ATTRACTION_GAP * skin), strengths, law)
