"""Defines DiscState: the whole state of the discs as plain arrays, in the order in which the user numbered them.

x to the right, z up (m); angles and spins positive counter-clockwise. Rotation is stored as radius times spin and
radius times angle, in the form in which contacts use it. The state is complete, so that a checkpoint holds nothing
else, and a run from a checkpoint has the same bits as an uninterrupted one.
"""

from dataclasses import dataclass, field

import numpy as np

from dem.acceleration import Acceleration
from dem.kernels.liquefied_pairs import FIELDS, FORCE_X, FORCE_Z
from dem.kernels.liquefied_pairs import MEMORY as BOND_MEMORY
from dem.kernels.period import NO_PERIOD, Period
from dem.pair_table import PairTable
from dem.springs import Law, Mean, Strength

# what a pair remembers, of the paper's discs and of soil discs besides; a new one starts with nothing
MEMORY = ("pore_length", "shear", "pore_shear", "force_x", "force_z")
ROLLING_MEMORY = ("rolled", "torque")
LINE_MEMORY = ("line_shear", "line_force_x", "line_force_z", "line_rolled", "line_torque")


@dataclass(eq=False)
class DiscState:
    """Holds n discs, their contacts and the table of springs.

    Attributes
    ----------
    x, z, roll (n,) : position of each disc, and radius times angle of rotation (m)
    vx, vz, vr (n,) : velocity of each disc, and radius times angular velocity, at `time` (m/s)
    vx_half, vz_half, vr_half (n,) : the same velocities half a step before (m/s)
    radius (n,) : radius of each disc (m)
    mass (n,) : mass of each disc with the full density (kg/m)
    weight (n,) : effective density over full density
    pore_acceleration_x, pore_acceleration_z (n,) : acceleration by pore pressure and by loads on the ground, which
        moves with the disc (m/s2)
    added_mass_x, added_mass_z (n,) : acceleration by the inertia of surcharges and free water, over the horizontal
        acceleration
    inertia_ratio (n,) : m r^2/I: 2 for a disc, 0 for one that cannot rotate
    layer (n,) : number of each disc's layer in the table of springs, -1 for boundary discs
    fixed (n,) : whether the velocity of a disc is prescribed
    x_list, z_list (n,) : position of each disc when the neighbour list was made (m)
    order (n,) : numbers of the discs in spatial order
    pair_i, pair_j (pairs,) : numbers of the two discs of each pair in the neighbour list
    shear, pore_shear (pairs,) : stored tangential forces of contact and pore spring (N)
    pore_length (pairs,) : distance at which the pore spring was set (m); negative once cracked, 0 without a pore spring
    force_x, force_z (pairs,) : force on the disc pair_j in the last step (N), for the energy balance
    rolled, torque (pairs,) : rolling moment over r_i r_j/(r_i + r_j): stored in the spring, and of spring and dashpot
        in the last step (N); empty for discs with the law "paper"
    lines (k, 6) : point (m), inward normal, reach (m) along (-nz, nx) of rigid lines
    line_strength : strength of contacts with each rigid line, None for the strength of the disc's layer; empty if it is
        None for all
    line_disc, line_id (contacts with lines,) : numbers of discs near rigid lines, and numbers of these lines
    line_shear, line_force_x, line_force_z, line_rolled, line_torque (contacts with lines,) : history variables of
        contacts with lines, as for pairs (N)
    energy_sums (slices, ENERGY_COLUMNS) : work and losses so far (J/m), columns as in `kernels.arguments`
    springs : constants by kind of pair
    liquefied (n, FIELDS) : fields of liquefied discs, see `kernels.liquefied_pairs`; (0, FIELDS) before liquefaction
    liquefied_i, liquefied_j (wide pairs,) : numbers of the discs of pairs with a liquefied disc within the reach of its
        pore water, sorted in space
    bonds (wide pairs, MEMORY) : history variables of the bonds of these pairs
    strength_factor (n,) : strength of the bonds of liquefied discs over the prescribed strength; empty before
        liquefaction
    reach : reach of the kernel of the pore water (m), 0 before liquefaction
    steps_between_looks : number of steps for which forces of liquefied ground are constant
    undisturbed (pairs,) : whether each pair has been in contact since the ground came to rest; empty where this does
        not matter, see `dem.undisturbed_contacts`
    undisturbed_x, undisturbed_z (n,) : position of each disc when the ground came to rest (m)
    mean, law : kind of mean of the constants of two layers, and contact law
    period : length along x and rise along z of a period (m); None without periodic sides
    place : position in the section of the origin of the section's axes in which the discs lie (m), see
        `dem.ground.Ground`
    gravity : gravity (m/s2)
    acceleration : external acceleration as a function of time
    skin : margin of the neighbour list (m)
    time, steps, last_dt : time (s), number of steps, and the step of the half-step velocities (s), 0 after velocities
        were set
    rough_base : whether the fixed discs are a random packing like the other discs; otherwise they lie in straight rows
    base_impedance, base_velocity, base_rate, base_next : state of a compliant base (`dem.engine.compliant_base`):
        impedance times length (kg/s per metre), 0 for a rigid base; velocity (m/s), acceleration now and at the next
        update (m/s2)
    lists_made : number of neighbour lists made so far
    energy_known, energy_edited, turnover : energy at the end of the last run, energy added by changes between runs, and
        total energy exchanged (J/m)
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
    pore_acceleration_x: np.ndarray
    pore_acceleration_z: np.ndarray
    added_mass_x: np.ndarray
    added_mass_z: np.ndarray
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
    period: tuple[float, float] | None
    gravity: tuple[float, float]
    acceleration: Acceleration
    skin: float
    line_strength: tuple[Strength | None, ...] = ()
    place: tuple[float, float] = (0.0, 0.0)
    time: float = 0.0
    steps: int = 0
    last_dt: float = 0.0
    rough_base: bool = False
    base_impedance: float = 0.0
    base_velocity: float = 0.0
    base_rate: float = 0.0
    base_next: float = 0.0
    lists_made: int = 0
    energy_known: float = float("nan")
    energy_edited: float = 0.0
    turnover: float = 0.0
    liquefied: np.ndarray = field(default_factory=lambda: np.zeros((0, FIELDS)))
    liquefied_i: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))
    liquefied_j: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))
    bonds: np.ndarray = field(default_factory=lambda: np.zeros((0, BOND_MEMORY)))
    strength_factor: np.ndarray = field(default_factory=lambda: np.zeros(0))
    reach: float = 0.0
    steps_between_looks: int = 1
    undisturbed: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))
    undisturbed_x: np.ndarray = field(default_factory=lambda: np.zeros(0))
    undisturbed_z: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __len__(self) -> int:
        return len(self.x)

    @property
    def places(self) -> np.ndarray:
        """Return the place (n,) of every disc in the spatial order."""
        places = np.empty(len(self), np.int32)
        places[self.order] = np.arange(len(self), dtype=np.int32)
        return places

    @property
    def memory(self) -> tuple[str, ...]:
        """Return the names of the history variables of a pair."""
        return MEMORY + (ROLLING_MEMORY if self.law == "soil" else ())

    @property
    def pull(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the acceleration of every disc by its weight and by water, along x and z (m/s2)."""
        x, z = self.gravity
        return self.weight * x + self.pore_acceleration_x, self.weight * z + self.pore_acceleration_z

    @property
    def liquefied_forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the force of liquefied ground on every disc, along x and z (N), at the last evaluation."""
        if not len(self.liquefied):
            return np.zeros(len(self)), np.zeros(len(self))
        return self.liquefied[:, FORCE_X], self.liquefied[:, FORCE_Z]

    @property
    def fading(self) -> np.ndarray:
        """Return a mask of the listed pairs (pairs,) whose contact is fading or lost, since one of their layers
        liquefies."""
        faded = np.array([*(layer.faded > 0.0 for layer in self.springs.layers), False])
        return np.asarray(faded[self.layer[self.pair_i]] | faded[self.layer[self.pair_j]])

    @property
    def spin(self) -> np.ndarray:
        """Return the angular velocity of each disc (1/s), counter-clockwise."""
        return self.vr / self.radius

    @property
    def angle(self) -> np.ndarray:
        """Return the angle of rotation of each disc (rad), counter-clockwise."""
        return self.roll / self.radius

    def kind(self, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """Return the column of the table of springs for pairs of discs."""
        code = np.where(self.layer < 0, self.springs.size - 1, self.layer).astype(np.uint16)
        return code[i] * np.uint16(self.springs.size) + code[j]

    @property
    def pair_kind(self) -> np.ndarray:
        """Return the column of the table of springs of every listed pair (pairs,)."""
        kind = self.kind(self.pair_i, self.pair_j)
        if len(self.undisturbed):
            kind[self.undisturbed] += np.uint16(self.springs.size**2)
        return kind

    @property
    def line_kind(self) -> np.ndarray:
        """Return the column of the table of lines for every disc near a line."""
        block = np.array([0, *self.springs.line_block], np.int64)
        which = self.line_id + 1 if self.springs.line_block else np.zeros(len(self.line_id), np.int64)
        return np.asarray(block[which] * self.springs.size + self.layer[self.line_disc])

    @property
    def repeats(self) -> Period:
        """Return the period of ground with periodic sides."""
        return NO_PERIOD if self.period is None else Period(*self.period)

    def branch(self) -> np.ndarray:
        """Return the vector from pair_i to the nearest image of pair_j, of all listed pairs (2, pairs) (m)."""
        i, j = self.pair_i, self.pair_j
        return np.array(nearest_image(self.x[j] - self.x[i], self.z[j] - self.z[i], self.repeats))

    def distance(self) -> np.ndarray:
        """Return the distance of the centres of all listed pairs (m), to the nearest image."""
        return np.hypot(*self.branch())


def nearest_image(dx: np.ndarray, dz: np.ndarray, period: Period) -> tuple[np.ndarray, np.ndarray]:
    """Return the vectors (m) to the images that are nearest along x, of vectors (dx, dz) in periodic ground."""
    images = np.floor(dx / period.length + 0.5)
    return dx - images * period.length, dz - images * period.rise
