"""Arguments of kernels, in groups: constants, law, loads, the run's clock, its threads, and one step."""

from typing import NamedTuple

import numpy as np

from dem.kernels.period import Period

# Columns of the energy balance, kept per slice: work of weight, external acceleration and moving boundaries; energy
# dissipated by dashpots, by sliding, by cracks, by rolling; in liquefied ground by the slip of bonds, and by viscosity;
# work of pore water that stands in for ground which has not liquefied. All in J per metre out of plane.
WORK_WEIGHT, WORK_EXTERNAL, WORK_BOUNDARY, DASHPOT, SLIDING, CRACKS, ROLLING, BONDS, VISCOSITY, STAND_IN = range(10)
ENERGY_COLUMNS = 10


class Springs(NamedTuple):
    """Constants of all contacts.

    Attributes
    ----------
    pairs : (CONSTANTS, kinds)
        Between discs, a column for each kind of pair.
    records : (kinds * CONSTANT_RECORD,)
        The same, kind by kind.
    lines : (CONSTANTS, layers + 1)
        Against rigid lines, a column for each layer.
    walls : (k, 6)
        The rigid lines themselves: see `LINE_X` and what follows in `interaction`.
    """

    pairs: np.ndarray
    records: np.ndarray
    lines: np.ndarray
    walls: np.ndarray


class State(NamedTuple):
    """The arrays of `Layout` that the contact law reads and writes.

    Attributes
    ----------
    discs, links, rolling, shared, partner : arrays
        As in `Layout`.
    """

    discs: np.ndarray
    links: np.ndarray
    rolling: np.ndarray
    shared: np.ndarray
    partner: np.ndarray


class Law(NamedTuple):
    """Which law holds.

    Attributes
    ----------
    soil : bool
        The law of soil discs (weaker of two strengths, cohesion, rolling resistance, a stop); else the paper's.
    pores : bool
        Whether there are pore springs at all.
    floor : float
        Least normal force of an element contact (N): 0, or -inf where its dashpot may pull.
    share : float
        Share of the element's normal force in Fn of eq. (16).
    period : Period
        Length and rise after which periodic ground repeats itself; for soil discs only.
    """

    soil: bool
    pores: bool
    floor: float
    share: float
    period: Period


class Loads(NamedTuple):
    """The acceleration of all discs beside their weight.

    Attributes
    ----------
    times : (n,)
        Instants (s) at which the external acceleration is given.
    acceleration : (3, n)
        x and z components there, and the one across gravity (m/s2).
    """

    times: np.ndarray
    acceleration: np.ndarray


class Clock(NamedTuple):
    """Number of time steps, their length (s), and the time at which they begin (s).

    Attributes
    ----------
    steps : int
        At most so many.
    dt : float
        Time step (s).
    last_dt : float
        The step before (s); 0 after velocities were set.
    time : float
        At the beginning (s).
    before : int
        Steps that have been taken before.
    """

    steps: int
    dt: float
    last_dt: float
    time: float
    before: int


class Team(NamedTuple):
    """The threads that step together.

    Attributes
    ----------
    thread, threads : int
        The number of this one, and how many there are.
    barrier : array of int64
        Where they meet, see `barrier.new_barrier`.
    stops : (2, threads)
        What each of them found in a step, in turn for odd and even steps.
    """

    thread: int
    threads: int
    barrier: np.ndarray
    stops: np.ndarray


class Entries(NamedTuple):
    """The entries of the energy balance.

    Attributes
    ----------
    kept : bool
        Whether work and losses are summed at all.
    sums : (slices, ENERGY_COLUMNS)
        Work and losses of each slice's discs (J per metre).
    """

    kept: bool
    sums: np.ndarray


class Step(NamedTuple):
    """One step, as all discs take it.

    Attributes
    ----------
    kick, dt, slip_time : float
        Time between the velocities kept and the new ones; to the new positions; since the last positions (s).
    ax, az, level : float
        External acceleration at the beginning of the step: along x, along z, across gravity (m/s2).
    mean_x, mean_z, mean_level : float
        Its mean over the step (m/s2), for the energy balance.
    reach : float
        Square of the way (m2) after which a disc wants a new neighbour list.
    """

    kick: float
    dt: float
    slip_time: float
    ax: float
    az: float
    level: float
    mean_x: float
    mean_z: float
    mean_level: float
    reach: float
