"""The law between two discs, or a disc and a rigid line: forces from overlap, speed, slip and memory.

Signs, once for everything in `dem`: an overlap and a pushing normal force are positive; `vn` is the speed of
separation; `vt` the slip speed of disc j's rim over disc i's along t = (-nz, nx), n pointing from i to j. The
tangential force opposes slip. Exchanging i and j changes neither overlap, vn, vt nor the stored forces, so a
contact does not know which disc was named first. Units are SI, forces per metre out of plane.
"""

from numba import njit

# Rows of the table of pair constants (see springs.PairTable), one column per kind of pair.
KN, KS, CN, CT, MU, KPN, KPS, TAN, BC, BETA, ALLOWED, FKS, FKPS = range(13)
CONSTANTS = 13


@njit(forceinline=True, error_model="numpy")
def clamp(value: float, limit: float) -> float:
    """`value` brought into [-limit, limit]."""
    value = value if value < limit else limit
    return value if value > -limit else -limit


@njit(forceinline=True, error_model="numpy")
def element(
    over: float,
    vn: float,
    vt: float,
    slip: float,
    shear: float,
    floor: float,
    kn: float,
    ks: float,
    cn: float,
    ct: float,
    mu: float,
) -> tuple[float, float, float, float]:
    """Element spring and dashpot, eqs. (1)-(4) with the Coulomb limit of Table 2's friction.

    over: overlap (m); vn, vt: speeds (m/s); slip: slip since the last step (m); shear: spring force kept (N).
    floor: least total normal force (N), 0 for contacts that never pull, -inf for dashpots that may.
    The spring's force is cut at the limit, and so is the sum of spring and dashpot: sliding then costs exactly
    mu Fn per metre, and neither part can feed energy back.
    Returns (normal force, tangential force, spring force before the limit, spring force kept).
    """
    normal = kn * over - cn * vn
    normal = normal if normal > floor else floor
    normal = normal if over > 0.0 else 0.0
    limit = mu * normal
    limit = limit if limit > 0.0 else 0.0
    trial = shear + ks * slip
    kept = clamp(trial, limit)
    return normal, clamp(kept + ct * vt, limit), trial, kept


@njit(forceinline=True, error_model="numpy")
def pore(
    length: float,
    distance: float,
    slip: float,
    shear: float,
    contact_normal: float,
    kpn: float,
    kps: float,
    tan: float,
    bc: float,
    beta: float,
) -> tuple[float, float, float, float]:
    """Pore spring, eqs. (11)-(17): state 1 pulls, pushes and shears; state 2 works only while compressed.

    length: distance L at which the spring was set (m), negative once cracked, 0 where there is none.
    contact_normal: what the element spring adds to Fn of eq. (16) (N); shear: tangential force kept (N).
    Cracks where D >= beta L (eq. 15) or |Ft| > max(Fn tan(theta) + bC, 0) (eq. 16), and obeys state 2 from that
    very step: no cohesion is left, so its shear is held by friction on its own compression.
    Returns (normal force, tangential force before the limit, tangential force kept, new length).
    """
    size = abs(length)
    normal = kpn * (size - distance)
    trial = shear + kps * slip
    hold = (normal + contact_normal) * tan + bc
    hold = hold if hold > 0.0 else 0.0
    whole = (length > 0.0) & (distance < beta * size) & (abs(trial) <= hold)
    push = normal if normal > 0.0 else 0.0
    kept = clamp(trial, tan * push)
    if whole:
        return normal, trial, trial, length
    return push, trial, kept, -size
