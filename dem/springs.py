"""Derives spring constants from soil, by equations 5 to 13 and 17 of the paper.

SI units, per metre out of plane: springs in N/m, damping in N s/m, densities in kg/m3, forces in N.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Literal

import numpy as np

from meshes.section.section import Stratum

PORE_SHARE = 0.1  # t_n = t_s in equation 13 of the paper, by Iwashita (1988)
VOID_RATIO = 2.0 * np.sqrt(3.0) / np.pi - 1.0  # equation 6 of the paper: discs on a triangular lattice

SHEAR_STIFFNESS = 0.5  # ks over kn of soil discs
ATTRACTION = 1.0  # of soil discs: tensile strength of a contact over its cohesion
# Of sqrt(m K), in soil discs: a tenth allows 4.8 times the stable time step of 1; ground at rest does not depend on it.
SOIL_DAMPING = 0.1
STOP_DEPTH = 0.25  # of the mean radius: from there on soil discs are as stiff as `LayerSprings.stop`
ROLLING = 5.0  # mu_r of discs of soil with friction: they turn, and hardly roll (`laboratory.strength_map`)
NOTHING_ROLLS = 1e6  # represents infinite rolling friction in the table

Mean = Literal["arithmetic", "harmonic"]
Law = Literal["paper", "soil"]


@dataclass(frozen=True)
class LayerSprings:
    """Holds the constants of one layer: a column of Table 2 of the paper, and further constants of soil discs.

    Attributes
    ----------
    kn, ks : normal and tangential stiffness of the springs of a contact (N/m)
    cn, ct : normal and tangential dashpot (N s/m)
    kpn, kps : normal and tangential stiffness of pore springs, the breakable springs between discs that stand for pore
        water in the paper (N/m)
    density : density of the discs by equation 5 of the paper, for inertia and horizontal force (kg/m3)
    effective_density : effective density of the discs, for weight (kg/m3)
    friction : Coulomb friction mu of contacts; negative for soil discs of clay, see `Strength`
    undisturbed_friction : the same of contacts of undisturbed ground, see `dem.undisturbed_contacts`; `friction` if
        None
    cohesion : cohesion of the pore springs: the force b C in equation 16 of the paper (N)
    alpha, beta : alpha: distance of the centres over the sum of the radii up to which a pore spring is set (equation 14
        of the paper); beta: length over initial length at which a pore spring cracks (equation 15 of the paper)
    pore_friction : friction coefficient of the pore springs: tan(theta) in equation 16 of the paper; `friction` if None
    allowed_overlap : largest overlap as a share of the mean radius of the pair; larger overlaps stop the run
    contact_cohesion : cohesion C of soil discs: tangential strength of a contact without normal force (N)
    attraction : tensile strength of a contact of soil discs over its contact cohesion
    rolling_friction : rolling friction mu_r of soil discs: largest rolling moment over Fn r_i r_j/(r_i + r_j); inf for
        discs that do not rotate
    stop : stiffness of contacts of soil discs at overlaps above `STOP_DEPTH` (N/m); no effect if kn is larger
    boundary : normal spring against boundary discs (N/m) if stiffer than kn: the spring of the layer before
        liquefaction
    undrained_strength : undrained strength s_u of clay (phi = 0), whose volume is constant during a slide (Pa); 0 for
        soil that is not undrained
    faded : lost share of the contacts of soil discs after liquefaction, see `dem.liquefied_ground`
    """

    name: str
    kn: float
    ks: float
    cn: float
    ct: float
    kpn: float
    kps: float
    density: float
    effective_density: float
    friction: float
    cohesion: float
    alpha: float = 1.2
    beta: float = 1.02
    pore_friction: float | None = None
    allowed_overlap: float = 0.5
    contact_cohesion: float = 0.0
    attraction: float = 0.0
    rolling_friction: float = 0.0
    stop: float = 0.0
    boundary: float = 0.0
    undrained_strength: float = 0.0
    faded: float = 0.0
    undisturbed_friction: float | None = None

    def __post_init__(self) -> None:
        for key in ("kn", "density"):
            if not getattr(self, key) > 0.0:
                raise ValueError(f"layer {self.name}: {key} must be positive, but is {getattr(self, key)}")
        for key in (
            "ks", "cn", "ct", "kpn", "kps", "effective_density", "cohesion", "contact_cohesion", "rolling_friction",
            "stop", "attraction", "undrained_strength",
        ):  # fmt: skip
            if not getattr(self, key) >= 0.0:
                raise ValueError(f"layer {self.name}: {key} must not be negative, but is {getattr(self, key)}")
        if self.friction < 0.0 and not self.contact_cohesion > 0.0:
            raise ValueError(f"layer {self.name}: friction may be negative only together with a contact cohesion")
        if not 0.0 <= self.faded <= 1.0:
            raise ValueError(f"layer {self.name}: faded must lie between 0 and 1, but is {self.faded}")
        if not (self.alpha >= 1.0 and self.beta > 1.0):
            raise ValueError(
                f"layer {self.name}: alpha (reach) must be at least 1, and beta (stretch at cracking) above 1"
            )

    def liquefied(self, stiffness: float, damping: float = 0.1, friction: float = 0.0) -> "LayerSprings":
        """Return the layer after liquefaction (Sec. 4(3) of the paper): factors on contact springs, dashpots and
        friction; no cohesion. The stiffening of soil discs at large overlap remains.

        The pore springs of the layer have to be cut separately in the model of the discs, see `cut_pore_springs`.
        """
        return replace(
            self, name=f"{self.name}, liquefied", kn=self.kn * stiffness, ks=self.ks * stiffness,
            cn=self.cn * damping, ct=self.ct * damping, kpn=0.0, kps=0.0, pore_friction=0.0, cohesion=0.0,
            friction=max(self.friction, 0.0) * friction, contact_cohesion=0.0, boundary=max(self.kn, self.boundary),
            undisturbed_friction=None,
        )  # fmt: skip


@dataclass(frozen=True)
class Strength:
    """Holds the strength of the contacts of soil discs.

    Attributes
    ----------
    friction : float
        Friction mu of slip. If negative, the tangential strength falls with the normal force, to compensate the
        geometric friction of a packing of discs, which clay does not have.
    cohesion : float
        Cohesion C: tangential strength without normal force (N).
    rolling_friction : float
        Rolling friction mu_r; inf for discs that do not rotate.
    """

    friction: float
    cohesion: float = 0.0
    rolling_friction: float = np.inf


SMOOTH = Strength(0.0, rolling_friction=0.0)  # of a rigid line that discs slide and roll along freely


def wave_speeds(youngs_modulus: float, poissons_ratio: float, density: float) -> tuple[float, float]:
    """Return the velocities of compression and shear waves in elastic soil.

    V_p = sqrt((1 - nu) E/(rho (1 - 2 nu) (1 + nu))) and V_s = sqrt(E/(2 rho (1 + nu))), equations 7 and 8 of the paper.

    Parameters
    ----------
    youngs_modulus : E (Pa), positive
    poissons_ratio : nu, at least 0 and less than 0.5
    density : rho (kg/m3), positive

    Returns
    -------
    V_p and V_s (m/s).

    Raises
    ------
    ValueError
        For constants out of these ranges.
    """
    e, nu, rho = youngs_modulus, poissons_ratio, density
    if not (e > 0.0 and 0.0 <= nu < 0.5 and rho > 0.0):
        raise ValueError(f"these are no constants of an elastic soil: E = {e} Pa, nu = {nu}, density = {rho} kg/m3")
    vp = np.sqrt((1.0 - nu) * e / (rho * (1.0 - 2.0 * nu) * (1.0 + nu)))
    return float(vp), float(np.sqrt(e / (2.0 * rho * (1.0 + nu))))


def from_stratum(
    stratum: Stratum,
    radius: float,
    *,
    stiffness_scale: float = 0.01,
    damping_ratio: float = 1.0,
    pore_share: float = PORE_SHARE,
    void_ratio: float = VOID_RATIO,
    alpha: float = 1.2,
    beta: float = 1.02,
) -> LayerSprings:
    """Return the constants of discs with the law "paper" in a stratum.

    The horizontal force acts on the seismic density, the weight on the ordinary one (buoyant below water). Seismic and
    ordinary density are the densities of the soil, not corrected for the voids between the discs. radius: mean radius
    of the discs (m), b in equation 17 of the paper. stiffness_scale: factor on the springs of equations 9 to 13 of the
    paper; its Table 2 was printed with the factor 0.01. damping_ratio: factor on sqrt(m K), which is half of critical
    for one disc on a fixed spring. A contact spring K_e and a pore spring K_p in series have the stiffness K of the
    soil (equations 11 to 13 of the paper): K_e = (1 + 1/t) K, K_p = t K_e. pore_share: t in these equations;
    void_ratio: void ratio of the soil (-); alpha: distance of the centres over the sum of the radii up to which a pore
    spring is set; beta: length over initial length at which a pore spring cracks (equation 15 of the paper).
    """
    density = stratum.density_seismic
    vp, vs = wave_speeds(stratum.youngs_modulus, stratum.poissons_ratio, density)
    series = (1.0 + 1.0 / pore_share) * np.pi / 4.0 * density * stiffness_scale
    kn, ks = float(series * vp**2), float(series * vs**2)
    disc_density = density * (1.0 + void_ratio)
    # what buoyancy takes away does not depend on the voids, which are full of water too
    disc_effective = disc_density - (density - stratum.density_ordinary)
    mass = np.pi * radius**2 * disc_density
    return LayerSprings(
        name=stratum.name, kn=kn, ks=ks,
        cn=float(damping_ratio * np.sqrt(mass * kn)), ct=float(damping_ratio * np.sqrt(mass * ks)),
        kpn=pore_share * kn, kps=pore_share * ks, density=disc_density, effective_density=disc_effective,
        friction=float(np.tan(stratum.friction_angle)), cohesion=radius * stratum.cohesion, alpha=alpha, beta=beta,
    )  # fmt: skip


def soil_discs(
    name: str,
    stiffness: float,
    strength: Strength,
    density: float,
    effective_density: float,
    radius: float,
    void_ratio: float,
    *,
    allowed_overlap: float = 0.5,
) -> LayerSprings:
    """Return the constants of a layer of soil discs (law "soil"), without pore springs.

    The saturated and buoyant densities of discs of void ratio e are 1 + e times the densities of the soil, so that the
    discs have the mass, the weight and the horizontal force of the soil. (Table 2 of the paper subtracts buoyancy once,
    not 1 + e times.)

    Parameters
    ----------
    name : str
        Name of the layer, for messages.
    stiffness : float
        kn, the normal stiffness of a contact (N/m).
    strength : Strength
        Friction, cohesion (N) and rolling friction of a contact.
    density, effective_density : float
        Densities of the soil: saturated, and buoyant below water (kg/m3).
    radius : float
        Mean radius of the discs (m).
    void_ratio : float
        Area of the voids over the area of the discs, as measured in the packing; not negative.
    allowed_overlap : float
        Overlap over the mean radius at which a run is stopped.

    Returns
    -------
    LayerSprings
        The constants, with kpn = kps = 0.

    Raises
    ------
    ValueError
        If the void ratio is negative.
    """
    if not void_ratio >= 0.0:
        raise ValueError(f"layer {name}: void ratio must not be negative, but is {void_ratio}")
    mass = np.pi * radius**2 * density * (1.0 + void_ratio)
    kn, ks = stiffness, SHEAR_STIFFNESS * stiffness
    return LayerSprings(
        name=name, kn=kn, ks=ks,
        cn=float(SOIL_DAMPING * np.sqrt(mass * kn)), ct=float(SOIL_DAMPING * np.sqrt(mass * ks)), kpn=0.0, kps=0.0,
        density=density * (1.0 + void_ratio), effective_density=effective_density * (1.0 + void_ratio),
        friction=strength.friction, cohesion=0.0, contact_cohesion=strength.cohesion,
        attraction=ATTRACTION, rolling_friction=strength.rolling_friction, stop=kn, allowed_overlap=allowed_overlap,
    )  # fmt: skip


def from_strata(strata: Sequence[Stratum], radius: float, **settings: float) -> list[LayerSprings]:
    """Return the constants of all strata of a Section, for discs of this mean radius (m); settings as in
    `from_stratum`."""
    return [from_stratum(stratum, radius, **settings) for stratum in strata]


def table2(states: Mapping[int, str] | None = None) -> list[LayerSprings]:
    """Return Table 2 of the paper as printed, layers 1 to 10. `states`: "case1", "case2" or "case3" for layers 4 and 6,
    else "normal"."""
    rows: dict[tuple[int, str], LayerSprings] = {}
    with (files("dem") / "table2_dem.csv").open(encoding="utf-8") as source:
        for row in csv.DictReader(source):
            key = int(row["layer"]), row["state"]
            rows[key] = LayerSprings(
                name=f"{key[0]}" if key[1] == "normal" else f"{key[0]}, {key[1]}",
                kn=float(row["Ken_N_m"]), ks=float(row["Kes_N_m"]),
                cn=float(row["eta_n_Ns_m"]), ct=float(row["eta_t_Ns_m"]),
                kpn=float(row["Kpn_N_m"] or 0.0), kps=float(row["Kps_N_m"] or 0.0),
                density=float(row["rho_d_kg_m3"]), effective_density=float(row["rho_w_kg_m3"]),
                friction=float(row["friction"]), cohesion=float(row["cohesion_N"]),
                alpha=float(row["alpha"] or 1.2), beta=float(row["beta"] or 1.02),
            )  # fmt: skip
    wanted = {n: "normal" for n in range(1, 11)} | dict(states or {})
    missing = [key for key in wanted.items() if key not in rows]
    if missing:
        raise KeyError(f"Table 2 of the paper has no layer and state {missing}; it has {sorted(rows)}")
    return [rows[key] for key in sorted(wanted.items())]
