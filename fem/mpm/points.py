"""Holds mass, motion, stress and strength of the material points.

Lengths in m, z upwards; stress in Pa, tension positive, components [xx, zz, xz]; masses in kg per metre out of plane.
"""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from fem.kernels import point_stress as law

UNLIMITED_TENSION = 1e30  # Pa: tension without a cut-off


@dataclass(frozen=True, eq=False)
class PointSoil:
    """Holds the properties of the soil at the points; each is a number or an array (n,).

    Attributes
    ----------
    density : total density, which resists acceleration (kg/m³)
    youngs_modulus, poissons_ratio : elastic constants in plane strain (Pa, -)
    cohesion, friction : Mohr-Coulomb strength (Pa, rad); plastic flow is without dilation
    tension : largest tensile stress (Pa), a principal stress; with inf only the apex of the cone, c cot φ, limits it
    weight_ratio : density on which gravity acts over ``density`` (-); below 1 if the density for gravity includes
        buoyancy
    """

    density: float | np.ndarray
    youngs_modulus: float | np.ndarray
    poissons_ratio: float | np.ndarray
    cohesion: float | np.ndarray
    friction: float | np.ndarray
    tension: float | np.ndarray = np.inf
    weight_ratio: float | np.ndarray = 1.0


@dataclass(frozen=True, eq=False)
class MaterialPoints:
    """Holds material points; the engine changes the arrays in place.

    Attributes
    ----------
    x, v (n, 2) : position (m) and velocity (m/s)
    affine (n, 4) : velocity gradient [xx, xz, zx, zz] of the affine field of a point (1/s)
    stress (n, 3) : effective stress [xx, zz, xz] (Pa)
    state (n, 6) : volume (m²), mass (kg/m), volumetric strain by opening (-), plastic shear strain (-), viscous part of
        the stress (Pa), in the order of `fem.kernels.point_stress`
    properties (n, 14) : properties of the soil in the order of `fem.kernels.point_stress`
    start (n, 2) : position at the beginning (m)
    stratum (n,) : number of the stratum, -1 for rigid ground around the section
    side (n,) : horizontal force (N/m) on the points next to a free-field side, 0 elsewhere
    """

    x: np.ndarray
    v: np.ndarray
    affine: np.ndarray
    stress: np.ndarray
    state: np.ndarray
    properties: np.ndarray
    start: np.ndarray
    stratum: np.ndarray
    side: np.ndarray

    @classmethod
    def of(cls, x: np.ndarray, volume: np.ndarray, soil: PointSoil, stratum: np.ndarray | None = None) -> Self:
        """Make material points at rest without stress.

        Parameters
        ----------
        x (n, 2) : positions (m)
        volume (n,) : areas in the plane (m²)
        soil : soil of the points
        stratum (n,) : number of the stratum of each point; 0 by default
        """
        n = len(x)
        properties = np.zeros((n, law.PROPERTIES))
        shear = soil.youngs_modulus / (2.0 * (1.0 + np.asarray(soil.poissons_ratio)))
        properties[:, law.SHEAR] = shear
        properties[:, law.BULK] = shear / (1.0 - 2.0 * np.asarray(soil.poissons_ratio))
        properties[:, law.WEIGHT_RATIO] = soil.weight_ratio
        state = np.zeros((n, law.STATE))
        state[:, law.VOLUME] = volume
        state[:, law.MASS] = soil.density * state[:, law.VOLUME]
        points = cls(
            x=np.array(x, dtype=float),
            v=np.zeros((n, 2)),
            affine=np.zeros((n, 4)),
            stress=np.zeros((n, 3)),
            state=state,
            properties=properties,
            start=np.array(x, dtype=float),
            stratum=np.zeros(n, dtype=np.int64) if stratum is None else np.array(stratum, dtype=np.int64),
            side=np.zeros(n),
        )
        points.set_strength(soil.cohesion, soil.friction, soil.tension)
        return points

    def subset(self, which: np.ndarray) -> Self:
        """Return some of the points, by their numbers or a mask (n,), in that order."""
        return type(self)(**{field.name: getattr(self, field.name)[which] for field in fields(self)})

    def set_strength(
        self,
        cohesion: float | np.ndarray,
        friction: float | np.ndarray,
        tension: float | np.ndarray = np.inf,
        where: np.ndarray | slice = slice(None),
    ) -> None:
        """Set the strength of the points ``where``: cohesion (Pa), friction angle (rad), largest tension (Pa)."""
        c, phi, limit = (np.asarray(value, dtype=float) for value in (cohesion, friction, tension))
        with np.errstate(divide="ignore", invalid="ignore"):
            apex = np.where(np.tan(phi) > 0.0, c / np.tan(phi), UNLIMITED_TENSION)
        self.properties[where, law.STRENGTH] = c * np.cos(phi)
        self.properties[where, law.SIN_PHI] = np.sin(phi)
        self.properties[where, law.TENSION_LIMIT] = np.minimum(np.minimum(limit, apex), UNLIMITED_TENSION)

    def scale_shear(self, where: np.ndarray, factor: float) -> None:
        """Multiply the shear stress of points ``where``, without its viscous part, by a factor; the mean stress is
        unchanged.
        """
        half, cross = self._without_viscous_part(where)
        cos, sin, on_plane = self._planes(where)
        along = cross * cos - half * sin
        half, cross = np.where(on_plane, -along * sin, half), np.where(on_plane, along * cos, cross)
        self.stress[where] += (factor - 1.0) * np.column_stack([half, -half, cross])

    def _without_viscous_part(self, where: np.ndarray | slice) -> tuple[np.ndarray, np.ndarray]:
        """Return half the difference of the normal stresses and the shear stress (Pa) without their viscous parts."""
        late = self.state[where, law.VISCOUS_HALF_DIFFERENCE], self.state[where, law.VISCOUS_SHEAR]
        xx, zz, xz = self.stress[where].T
        return 0.5 * (xx - zz) - late[0], xz - late[1]

    def _planes(self, where: np.ndarray | slice) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return cosine and sine of twice the inclination of planes of weakness, and the mask of points with one."""
        angle = 2.0 * np.arctan(self.properties[where, law.PLANE_SLOPE])
        return np.cos(angle), np.sin(angle), self.properties[where, law.PLANE_SHEAR] > 0.0

    @property
    def mass(self) -> np.ndarray:
        """Return masses (n,) in kg/m."""
        return self.state[:, law.MASS]

    @property
    def displacement(self) -> np.ndarray:
        """Return the displacement (n, 2) since the beginning (m)."""
        return self.x - self.start

    @property
    def wave_speed(self) -> float:
        """Return the velocity of the fastest compression wave (m/s)."""
        modulus = self.properties[:, law.BULK] + self.properties[:, law.SHEAR]
        return float(np.sqrt(modulus * self.state[:, law.VOLUME] / self.mass).max())

    def kinetic(self, cell: float) -> float:
        """Return the kinetic energy (J/m), including that of the affine fields, on cells of size ``cell`` (m)."""
        squared_speed = (self.v**2).sum(axis=1) + 0.25 * cell**2 * (self.affine**2).sum(axis=1)
        return float(0.5 * np.sum(self.mass * squared_speed))

    def elastic(self) -> float:
        """Return the elastic energy (J/m) of the stress in the plane."""
        everywhere = slice(None)
        mean, (half, cross) = 0.5 * (self.stress[:, 0] + self.stress[:, 1]), self._without_viscous_part(everywhere)
        cos, sin, on_plane = self._planes(everywhere)
        radius = np.where(on_plane, np.abs(cross * cos - half * sin), np.hypot(half, cross))
        across = np.where(on_plane, half * cos + cross * sin, 0.0)
        bulk, shear, soft, knee = (
            self.properties[:, k] for k in (law.BULK, law.SHEAR, law.SOFT_SHEAR, law.SOFT_RADIUS)
        )
        stiff = np.where(on_plane, self.properties[:, law.PLANE_SHEAR], shear)
        below = np.minimum(radius, knee)
        softly = np.divide(below**2, soft, out=np.zeros(len(soft)), where=knee > 0.0)
        density = 0.5 * (mean**2 / bulk + softly + (radius**2 - below**2) / stiff + across**2 / shear)
        return float(np.sum(self.state[:, law.VOLUME] * density))
