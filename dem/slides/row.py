"""Stores one row of the history of a slide."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """Holds the state of a slide at one time, a line of history.csv.

    Attributes
    ----------
    time_s : time since Kh began to rise (s)
    settlement_uphill_m, settlement_middle_m, settlement_downhill_m : median settlement of each third of the surface (m)
    slide_uphill_m, slide_middle_m, slide_downhill_m : median slide of each third, horizontally downhill (m)
    slide_max_m : largest slide of the surface, smoothed (m)
    kinetic_J, stored_J, dissipated_J : kinetic energy, energy stored in springs and bonds, and energy dissipated by
        friction, dashpots and cracks (J per metre)
    work_J, shaking_J : work of weight, Kh and boundaries together; work of Kh alone (J per metre)
    cracked : number of cracked pore springs
    crack_opening_m : widest gap between discs of the surface (m)
    surface_speed_m_s : largest speed of the surface, smoothed (m/s)
    """

    time_s: float
    settlement_uphill_m: float
    settlement_middle_m: float
    settlement_downhill_m: float
    slide_uphill_m: float
    slide_middle_m: float
    slide_downhill_m: float
    slide_max_m: float
    kinetic_J: float  # noqa: N815
    stored_J: float  # noqa: N815
    dissipated_J: float  # noqa: N815
    work_J: float  # noqa: N815
    shaking_J: float  # noqa: N815
    cracked: int
    crack_opening_m: float
    surface_speed_m_s: float
