"""Groups the arguments of kernels: constants, contact law, loads, clock, threads, and one step."""

from typing import NamedTuple

import numpy as np

from dem.kernels.period import Period

# Columns of the energy balance, kept per slice: work of weight, external acceleration and moving boundaries; energy
# dissipated by dashpots, by sliding, by cracks, by rolling; in liquefied ground by the slip of bonds, and by viscosity;
# work of pore water that stands in for ground which has not liquefied. All in J per metre out of plane.
WORK_WEIGHT, WORK_EXTERNAL, WORK_BOUNDARY, DASHPOT, SLIDING, CRACKS, ROLLING, BONDS, VISCOSITY, STAND_IN = range(10)
ENERGY_COLUMNS = 10


class Springs(NamedTuple):
    """Holds the constants of all contacts.

    Attributes
    ----------
    pairs (CONSTANTS, kinds) : constants of contacts between discs, a column for each kind of pair
    records (kinds * CONSTANT_RECORD,) : the constants in ``pairs``, one record for each kind of pair
    lines (CONSTANTS, blocks * (layers + 1)) : constants of contacts with rigid lines, a column for each layer, in one
        block for the lines with the strength of the layers, and one for each other strength of lines
    walls (k, 6) : geometry of the rigid lines: see `LINE_X` and the names after it in `interaction`
    """

    pairs: np.ndarray
    records: np.ndarray
    lines: np.ndarray
    walls: np.ndarray


class State(NamedTuple):
    """Holds the arrays of `Layout` that the contact law reads and writes.

    Attributes
    ----------
    discs, links, rolling, shared, partner : as in `Layout`
    """

    discs: np.ndarray
    links: np.ndarray
    rolling: np.ndarray
    shared: np.ndarray
    partner: np.ndarray


class Law(NamedTuple):
    """Holds the contact law of a model.

    Attributes
    ----------
    soil : whether the law is that of soil discs (weaker of two strengths, cohesion, rolling resistance, stiffening at
        large overlap); otherwise the law is that of the paper on the section S-13
    pores : whether there are pore springs
    period : length and rise after which periodic ground repeats itself; for soil discs only
    """

    soil: bool
    pores: bool
    period: Period


class Loads(NamedTuple):
    """Holds the external acceleration of all discs, without gravity.

    Attributes
    ----------
    times (n,) : instants (s) at which the external acceleration is given
    acceleration (3, n) : components of the acceleration along x, along z, and horizontally (m/s2)
    """

    times: np.ndarray
    acceleration: np.ndarray


class Clock(NamedTuple):
    """Holds the time steps of one call of the kernel.

    Attributes
    ----------
    steps : largest number of steps
    dt : time step (s)
    last_dt : length of the step before (s); 0 after velocities were set
    time : time at the beginning (s)
    steps_before : number of steps taken before this call
    """

    steps: int
    dt: float
    last_dt: float
    time: float
    steps_before: int


class Team(NamedTuple):
    """Holds the threads that compute steps together.

    Attributes
    ----------
    thread, threads : number of this thread, and number of threads
    barrier : counters with which threads wait for each other, see `barrier.new_barrier`
    stops (2, threads) : reason why each thread stopped in a step, alternately for odd and even steps
    """

    thread: int
    threads: int
    barrier: np.ndarray
    stops: np.ndarray


class Entries(NamedTuple):
    """Holds the work and the losses of the energy balance, summed for every slice of discs.

    Attributes
    ----------
    summed : whether work and losses are summed
    sums (slices, ENERGY_COLUMNS) : work and losses of each slice's discs (J per metre)
    """

    summed: bool
    sums: np.ndarray


class Step(NamedTuple):
    """Holds one time step of all discs.

    Attributes
    ----------
    kick, dt, slip_time : durations (s): from the stored to the new velocities (``kick``), from the present to the new
        positions (``dt``), and from the last to the present positions (``slip_time``)
    ax, az, level : external acceleration at the beginning of the step: along x, along z, and horizontally (m/s2)
    mean_x, mean_z, mean_level : mean external acceleration over the step (m/s2), for the energy balance
    reach : square of the displacement (m2) after which a disc needs a new neighbour list
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
