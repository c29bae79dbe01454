"""Defines isotropic elasticity in the plane: constants of discs, and equivalent constants of soil in plane strain."""

from dataclasses import dataclass

import numpy as np

from dem.springs import LayerSprings


@dataclass(frozen=True)
class PlaneElastic:
    """Holds the elastic constants of a sheet: sigma_xx = M eps_xx + lame eps_zz, tau = G gamma, per metre out of plane.

    Attributes
    ----------
    M : constrained modulus (Pa)
    lame : Lame's first constant (Pa)
    G : shear modulus (Pa)

    Notes
    -----
    E and nu are the constants of a soil of this stiffness in plane strain, to be compared with those of a Stratum; a
    sheet of discs in plane stress has E_2d = E / (1 - nu^2) and nu_2d = nu / (1 - nu) = lame / M.
    """

    M: float
    lame: float
    G: float

    @property
    def nu_2d(self) -> float:
        """Return Poisson's ratio of the discs as a sheet in plane stress."""
        return self.lame / self.M

    @property
    def E_2d(self) -> float:
        """Return Young's modulus of the discs as a sheet in plane stress (Pa)."""
        return self.M * (1.0 - self.nu_2d**2)

    @property
    def nu(self) -> float:
        """Return Poisson's ratio of the soil in plane strain."""
        return self.lame / (self.M + self.lame)

    @property
    def E(self) -> float:
        """Return Young's modulus of the soil in plane strain (Pa)."""
        return self.E_2d * (1.0 - self.nu**2)


def lattice_elastic(layer: LayerSprings, pores: bool = True) -> PlaneElastic:
    """Return the elastic constants of a triangular lattice of discs without slip: M = sqrt(3)/4 (3 kn + ks), G =
    sqrt(3)/4 (kn + ks).

    If there are pore springs, they act in parallel with the contact springs: kn and ks are then the sums of both. The
    spacing is two radii. The moduli follow from the energy of the three bonds of a disc that rotates with the mean
    rotation, as in Griffiths and Mustoe (2001), Int. J. Numer. Meth. Engng 50, 1791.
    """
    kn = layer.kn + (layer.kpn if pores else 0.0)
    ks = layer.ks + (layer.kps if pores else 0.0)
    quarter = float(np.sqrt(3.0) / 4.0)
    return PlaneElastic(quarter * (3.0 * kn + ks), quarter * (kn - ks), quarter * (kn + ks))
