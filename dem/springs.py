"""From soil to spring constants, eqs. (5)-(13) and (17) of the paper, and the table of constants by pair of layers.

SI units, per metre out of plane: springs in N/m, damping in N s/m, densities in kg/m3, forces in N.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Literal

import numpy as np

from dem.kernels.contact import (
    ALLOWED,
    BC,
    BETA,
    CN,
    CONSTANTS,
    CT,
    FKPS,
    FKS,
    KN,
    KPN,
    KPS,
    KS,
    MU,
    TAN,
)
from meshes.section.section import Stratum

TABLE2_RADIUS = 0.75  # m
PORE_SHARE = 0.1  # t_n = t_s of eq. (13), Iwashita (1988)
VOID_RATIO = 2.0 * np.sqrt(3.0) / np.pi - 1.0  # eq. (6): discs on a triangular lattice
WATER_DENSITY = 1000.0  # kg/m3

Mean = Literal["arithmetic", "harmonic"]


@dataclass(frozen=True)
class LayerSprings:
    """The constants of one layer, as a column of Table 2 gives them.

    kn, ks: element springs (N/m); cn, ct: their dashpots (N s/m); kpn, kps: pore springs (N/m); alpha: reach of a
    pore spring when set, eq. (14); beta: stretch at which it breaks, eq. (15); density: of the discs, eq. (5), for
    inertia and horizontal force; effective_density: for weight (kg/m3); friction: Coulomb's, of the elements;
    cohesion: b C of eq. (16) (N); pore_friction: tan(theta) of eq. (16), the friction if not given;
    allowed_overlap: as a share of the mean radius of the pair, deeper ones stop the run.
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

    def __post_init__(self) -> None:
        for key in ("kn", "density"):
            if not getattr(self, key) > 0.0:
                raise ValueError(f"layer {self.name}: {key} must be positive, is {getattr(self, key)}")
        for key in ("ks", "cn", "ct", "kpn", "kps", "effective_density", "friction", "cohesion"):
            if not getattr(self, key) >= 0.0:
                raise ValueError(f"layer {self.name}: {key} must not be negative, is {getattr(self, key)}")
        if not (self.alpha >= 1.0 and self.beta > 1.0):
            raise ValueError(f"layer {self.name}: alpha must be at least 1 and beta above 1")

    def liquefied(self, stiffness: float, damping: float = 0.1, friction: float = 0.0) -> "LayerSprings":
        """Sec. 4(3): factors on element springs, dashpots and friction; no cohesion.

        The pore springs of the layer are to be cut as well; they stand in the discs' model, see `cut_pore_springs`.
        """
        return replace(
            self, name=f"{self.name}, liquefied", kn=self.kn * stiffness, ks=self.ks * stiffness,
            cn=self.cn * damping, ct=self.ct * damping, kpn=0.0, kps=0.0, friction=self.friction * friction,
            pore_friction=0.0, cohesion=0.0,
        )  # fmt: skip


def wave_speeds(youngs_modulus: float, poissons_ratio: float, density: float) -> tuple[float, float]:
    """V_p and V_s (m/s), eqs. (7) and (8); modulus in Pa, density in kg/m3."""
    e, nu, rho = youngs_modulus, poissons_ratio, density
    if not (e > 0.0 and 0.0 <= nu < 0.5 and rho > 0.0):
        raise ValueError(f"no elastic soil: E = {e} Pa, nu = {nu}, density = {rho} kg/m3")
    vp = np.sqrt((1.0 - nu) * e / (rho * (1.0 - 2.0 * nu) * (1.0 + nu)))
    return float(vp), float(np.sqrt(e / (2.0 * rho * (1.0 + nu))))


def from_soil(
    name: str,
    youngs_modulus: float,
    poissons_ratio: float,
    density: float,
    effective_density: float,
    cohesion: float,
    friction_angle: float,
    radius: float,
    *,
    stiffness_scale: float = 0.01,
    damping_ratio: float = 1.0,
    pore_share: float = PORE_SHARE,
    void_ratio: float = VOID_RATIO,
    alpha: float = 1.2,
    beta: float = 1.02,
) -> LayerSprings:
    """The constants of a layer from its soil.

    youngs_modulus, cohesion in Pa; friction_angle in rad; density: saturated, it carries the horizontal force;
    effective_density: buoyant below water, it carries the weight (kg/m3 of soil, voids between the discs not yet
    counted); radius: of the discs (m), b of eq. (17).
    stiffness_scale: factor on the springs of eqs. (9)-(13); Table 2 was printed with 0.01.
    damping_ratio: factor on sqrt(m K), which is half of critical for one disc on a fixed spring.
    Element and pore spring in series make the spring of the soil, eqs. (11)-(13): K_e = (1 + 1/t) K, K_p = t K_e.
    """
    vp, vs = wave_speeds(youngs_modulus, poissons_ratio, density)
    series = (1.0 + 1.0 / pore_share) * np.pi / 4.0 * density * stiffness_scale
    kn, ks = float(series * vp**2), float(series * vs**2)
    disc_density = density * (1.0 + void_ratio)
    # what buoyancy takes away does not depend on the voids, which are full of water too
    disc_effective = disc_density - (density - effective_density)
    mass = np.pi * radius**2 * disc_density
    return LayerSprings(
        name=name, kn=kn, ks=ks,
        cn=float(damping_ratio * np.sqrt(mass * kn)), ct=float(damping_ratio * np.sqrt(mass * ks)),
        kpn=pore_share * kn, kps=pore_share * ks, density=disc_density, effective_density=disc_effective,
        friction=float(np.tan(friction_angle)), cohesion=radius * cohesion, alpha=alpha, beta=beta,
    )  # fmt: skip


def from_strata(strata: Sequence[Stratum], radius: float, **settings: float) -> list[LayerSprings]:
    """The constants of all strata of a Section, for discs of this (mean) radius; settings as in `from_soil`."""
    return [
        from_soil(
            s.name, s.youngs_modulus, s.poissons_ratio, s.density_seismic, s.density_ordinary, s.cohesion,
            s.friction_angle, radius, **settings,
        )
        for s in strata
    ]  # fmt: skip


def table2(states: Mapping[int, str] | None = None) -> list[LayerSprings]:
    """Table 2 as printed, layers 1 to 10. `states`: "case1", "case2" or "case3" for layers 4 and 6, else "normal"."""
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
        raise KeyError(f"Table 2 has no layer and state {missing}; it has {sorted(rows)}")
    return [rows[key] for key in sorted(wanted.items())]


@dataclass(frozen=True)
class PairTable:
    """Constants by kind of pair: column a * (n + 1) + b for layers a and b; index n stands for the boundary.

    pairs (CONSTANTS, (n + 1)**2) between discs; lines (CONSTANTS, n + 1) against rigid lines;
    alpha ((n + 1)**2,): reach of new pore springs.
    """

    layers: tuple[LayerSprings, ...]
    pairs: np.ndarray
    lines: np.ndarray
    alpha: np.ndarray

    @property
    def size(self) -> int:
        """Rows of the square of pairs: the layers and the boundary."""
        return len(self.layers) + 1


def pair_table(layers: Sequence[LayerSprings], mean: Mean = "arithmetic") -> PairTable:
    """The table for contacts within and between layers.

    Between layers: the mean of stiffness, damping, friction, cohesion, alpha, beta and allowed overlap. A boundary
    disc takes its partner's values. A rigid line does so too, but with the stiffest normal spring of all layers and a
    dashpot of the same damping ratio: it must hold however soft the disc is.
    """
    if not layers:
        raise ValueError("no layers: the table of springs needs at least one")
    if mean not in ("arithmetic", "harmonic"):
        raise ValueError(f"mean is 'arithmetic' or 'harmonic', not {mean!r}")
    values = np.zeros((CONSTANTS, len(layers)))
    for k, layer in enumerate(layers):
        tan = layer.friction if layer.pore_friction is None else layer.pore_friction
        for row, value in (
            (KN, layer.kn), (KS, layer.ks), (CN, layer.cn), (CT, layer.ct), (MU, layer.friction),
            (KPN, layer.kpn), (KPS, layer.kps), (TAN, tan), (BC, layer.cohesion), (BETA, layer.beta),
            (ALLOWED, 0.5 * layer.allowed_overlap),
        ):  # fmt: skip
            values[row, k] = value
    n = len(layers)
    pairs = np.zeros((CONSTANTS, n + 1, n + 1))
    pairs[:, :n, :n] = _mean(values[:, :, None], values[:, None, :], mean)
    pairs[:, :n, n] = pairs[:, n, :n] = values
    reach = np.array([layer.alpha for layer in layers])
    alpha = np.ones((n + 1, n + 1))
    alpha[:n, :n] = _mean(reach[:, None], reach[None, :], mean)
    alpha[:n, n] = alpha[n, :n] = reach
    lines = np.zeros((CONSTANTS, n + 1))
    lines[:, :n] = values
    lines[KN] = values[KN].max()
    lines[CN, :n] *= np.sqrt(lines[KN, :n] / values[KN])
    for table in (pairs, lines):
        for spring, flexibility in ((KS, FKS), (KPS, FKPS)):
            np.divide(1.0, table[spring], out=table[flexibility], where=table[spring] > 0.0)
    return PairTable(tuple(layers), pairs.reshape(CONSTANTS, -1), lines, alpha.ravel())


def _mean(a: np.ndarray, b: np.ndarray, mean: Mean) -> np.ndarray:
    a, b = np.broadcast_arrays(a, b)
    if mean == "arithmetic":
        return 0.5 * (a + b)
    return np.divide(2.0 * a * b, a + b, out=np.zeros(a.shape), where=a + b > 0.0)
