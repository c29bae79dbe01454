"""Computes the forces of a contact between two discs, or a disc and a rigid line, from overlap, speed, slip and history
variables (kernel).

Signs everywhere in `dem`: an overlap and a compressive normal force are positive; `vn` is the speed of separation; `vt`
is the speed at which the circumference of disc j slips over that of disc i along t = (-nz, nx), n pointing from i to j.
The tangential force opposes slip. Exchanging i and j changes neither overlap, vn, vt nor the stored forces, so the
order of the two discs does not matter; only rolling changes its sign. Units are SI, forces per metre out of plane.
"""

from dem.kernels.device_function import device_function

# Rows of the table of pair constants (see pair_table.PairTable), one column per kind of pair: those of pore springs,
# those of all discs, then those that soil discs have besides.
FKPS, KPN, KPS, TAN, BC, BETA = range(6)
KN, KS, CN, CT, MU, ALLOWED, FKS = range(6, 13)
COHESION, MU_OTHER, COHESION_OTHER, MU_ROLLING, STOP_STIFFNESS, STOP_OVERLAP, ATTRACTION_REACH = range(13, 20)
CONSTANTS = 20


@device_function(forceinline=True)
def clamp(value: float, limit: float) -> float:
    """Return `value`, limited to the interval [-limit, limit]."""
    value = value if value < limit else limit
    return value if value > -limit else -limit


@device_function(forceinline=True)
def spring(over: float, kn: float, gap: float) -> float:
    """Return the force (N) of the normal spring of a contact at an overlap (m), positive in compression.

    gap: largest gap across which discs of cohesive soil attract each other (m), 0 for all other discs. The spring pulls
    up to kn times the gap; there is no force across a larger gap. The spring has no history variable, so that shearing
    does not reduce the attraction between discs.
    """
    return kn * over if over > -gap else 0.0


@device_function(forceinline=True)
def spring_energy(over: float, kn: float, gap: float) -> tuple[float, float]:
    """Return the energy (J) of the normal spring whose force `spring` returns, and the energy of the bond. The energy
    of the bond is negative: minus the work that separates attracting discs from the state without spring force.
    """
    touch = over > -gap
    return 0.5 * kn * over * over if touch else 0.0, -0.5 * kn * gap * gap if touch else 0.0


@device_function(forceinline=True)
def stop(over: float, stiffness: float, depth: float) -> float:
    """Return the additional repulsion (N) of two soil discs whose overlap exceeds `depth` (m).

    The repulsion stiffens the contact, so that discs do not pass through each other, however soft their layer becomes
    by liquefaction.
    """
    deep = over - depth
    return stiffness * deep if deep > 0.0 else 0.0


@device_function(forceinline=True)
def normal_force(over: float, vn: float, kn: float, spring: float, cn: float, gap: float) -> float:
    """Return the normal force (N) of spring and dashpot of a contact, equations 1 and 2 of the paper; zero if the discs
    do not touch. Contacts pull by their attraction kn times gap at most, and others not at all.

    over: overlap (m); vn: speed of separation (m/s); spring: force of the spring (N); cn: dashpot (N s/m); kn, gap: see
    `spring` (m).
    """
    least, normal = 0.0 - kn * gap, spring - cn * vn
    normal = normal if normal > least else least
    return normal if over > -gap else 0.0


@device_function(forceinline=True)
def friction_limit(normal: float, mu: float) -> float:
    """Return the largest tangential force (N) of a contact of discs with the law "paper": Coulomb friction, with the
    coefficient in Table 2 of the paper.
    """
    limit = mu * normal
    return limit if limit > 0.0 else 0.0


@device_function(forceinline=True)
def strength(over: float, normal: float, mu: float, c: float, mu_other: float, c_other: float, gap: float) -> float:
    """Return the largest tangential force of a contact of soil discs (N) while they touch: mu Fn + C of the weaker
    material.

    over: overlap (m); normal: normal force (N); mu, c, mu_other, c_other: friction (-) and cohesion (N) of both
    materials; gap: see `spring` (m). A contact that opens and closes again has its whole cohesion: shearing does not
    destroy the cohesion of clay. Friction may be negative, see `dem.springs.Strength`.
    """
    limit = mu * normal + c
    other = mu_other * normal + c_other
    limit = other if other < limit else limit
    limit = limit if limit > 0.0 else 0.0
    return limit if over > -gap else 0.0


@device_function(forceinline=True)
def friction_spring(
    force: float, way: float, speed: float, stiffness: float, dashpot: float, limit: float
) -> tuple[float, float, float]:
    """Compute the force of a spring and a dashpot in parallel with a common limit, equations 3 and 4 of the paper, for
    slip or for rolling.

    force: force of the spring in the last step (N); way: slip since the last step (m); speed: speed of slip (m/s);
    stiffness: stiffness of the spring (N/m); dashpot: coefficient of the dashpot (N s/m); limit: limit of the force
    (N). The force of the spring is limited, and so is the sum of spring and dashpot: sliding then dissipates exactly
    the limit per metre, and neither part can add energy. Returns (force, force of the spring before the limit, stored
    force of the spring).
    """
    trial = force + stiffness * way
    cut = clamp(trial, limit)
    return clamp(cut + dashpot * speed, limit), trial, cut


@device_function(forceinline=True)
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
    """Compute the forces of a pore spring, equations 11 to 17 of the paper. An intact spring pulls, pushes and shears;
    a cracked one works only while compressed.

    A pore spring cracks where D >= beta L (equation 15) or |Ft| > max(Fn tan(theta) + bC, 0) (equation 16). A cracked
    spring has no cohesion, and friction under its own compression limits its shear force (state 2 of the paper).

    length: distance L of the centres at which the spring was set (m), negative once cracked, 0 if there is none;
    distance: distance D of the centres (m); slip: tangential displacement since the last step (m); shear: tangential
    force kept from the last step (N); contact_normal: normal force of the contact spring as far as it is part of Fn in
    equation 16 (N); kpn, kps: normal and tangential stiffness (N/m); tan: tan(theta); bc: cohesion bC (N); beta: ratio
    of lengths. Returns (normal force, tangential force before the limit, tangential force kept, new length).
    """
    size = abs(length)
    normal = kpn * (size - distance)
    trial = shear + kps * slip
    resistance = (normal + contact_normal) * tan + bc
    resistance = resistance if resistance > 0.0 else 0.0
    whole = (length > 0.0) & (distance < beta * size) & (abs(trial) <= resistance)
    compression = normal if normal > 0.0 else 0.0
    tangential = clamp(trial, tan * compression)
    if whole:
        return normal, trial, trial, length
    return compression, trial, tangential, -size
