"""Runs element tests of a layer's discs: stiffness and strength of the soil that they represent.

A patch of one layer, without gravity, is confined at several pressures, then its pore springs are set, as in the slope
after settling. Small strains of the confined patch give its stiffness; a biaxial test (plane strain) and a simple-shear
test give its strength. Conventions of the patch and its loading are described in `patch.py` and `loading.py`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dem.laboratory.loading import Curve, confine, load, probe
from dem.laboratory.patch import Patch, PatchSample
from dem.laboratory.plane_elastic import PlaneElastic
from dem.laboratory.strength import MeasuredStrength, from_plane, from_principal, known, strength
from meshes.section.section import Stratum

LARGEST_STRAIN = 0.2
STRAIN_RATE = 2e-4  # strain per sqrt(m / kn)
INERTIAL_NUMBER = 3e-3  # at most: weakly confined samples are tested more slowly


@dataclass(frozen=True)
class PressureTest:
    """Holds the tests at one pressure.

    Attributes
    ----------
    pressure : confining pressure (Pa)
    stiffness : stiffness from small strains
    skewness : anisotropy of the stiffness: M_xx / M_zz - 1
    biaxial, shear : curves of the two tests
    biaxial_strength, shear_strength : strengths from the two tests
    inertial_number : inertial number: strain rate times diameter times sqrt(density / pressure)
    pore_springs : number of pore springs per free disc after they are set
    """

    pressure: float
    stiffness: PlaneElastic
    skewness: float
    biaxial: Curve
    biaxial_strength: MeasuredStrength
    shear: Curve
    shear_strength: MeasuredStrength
    inertial_number: float
    pore_springs: float


@dataclass(frozen=True)
class ElementTest:
    """Describes the soil that the discs of a layer represent.

    Attributes
    ----------
    sample : the tested discs
    stiffness : initial tangent stiffness, mean over the pressures
    G : shear modulus from the simple-shear part of the tests (Pa)
    c, phi : Mohr-Coulomb parameters from the peaks of the biaxial tests (Pa, rad)
    c_last, phi_last : Mohr-Coulomb parameters from the last tenth of the biaxial tests (Pa, rad)
    c_shear, phi_shear : Mohr-Coulomb parameters from the peaks of the simple-shear tests (Pa, rad)
    dilation : mean dilation angle at the peaks of the biaxial tests (rad)
    tests : the tests, in the order of rising pressure
    """

    sample: PatchSample
    stiffness: PlaneElastic
    G: float
    c: float
    phi: float
    c_last: float
    phi_last: float
    c_shear: float
    phi_shear: float
    dilation: float
    tests: tuple[PressureTest, ...]

    @property
    def E(self) -> float:
        """Return Young's modulus of the soil (Pa)."""
        return self.stiffness.E

    @property
    def nu(self) -> float:
        """Return Poisson's ratio of the soil."""
        return self.stiffness.nu

    @property
    def verdicts(self) -> tuple[str, ...]:
        """Return sentences on measured strengths that are neither a peak nor a plateau."""
        verdicts = []
        for test in self.tests:
            for curve, result in ((test.biaxial, test.biaxial_strength), (test.shear, test.shear_strength)):
                if result.verdict == "still rising":
                    verdicts.append(
                        f"{curve.kind} at {test.pressure:.4g} Pa: no peak up to a strain of "
                        f"{curve.strain[-1]:.3g}; the strength is the largest stress up to this strain"
                    )
                elif curve.stopped:
                    verdicts.append(
                        f"{curve.kind} at {test.pressure:.4g} Pa: stopped at a strain of {curve.strain[-1]:.3g}"
                        + (
                            "; the strength is the largest stress up to this strain"
                            if result.verdict == "stopped"
                            else ""
                        )
                        + f" ({curve.stopped})"
                    )
        if np.isnan(self.phi):
            verdicts.append("biaxial: the strength falls as the pressure grows, so there is neither c nor phi")
        return tuple(verdicts)

    @property
    def quality(self) -> dict[str, float]:
        """Return how quasi-static the tests were up to their peaks: unbalanced force ratio, inertial number, error of
        the servo control.

        The error is the relative error of the confining pressure.
        """
        unbalanced, errors = [], []
        for test in self.tests:
            for curve, axis in ((test.biaxial, 0), (test.shear, 1)):
                until_peak = slice(int(np.argmax(curve.resistance)) + 1)
                unbalanced.append(curve.unbalanced[until_peak])
                errors.append(-curve.stress[until_peak, axis, axis] / curve.pressure - 1.0)
        return {
            "unbalanced_largest": float(np.concatenate(unbalanced).max()),
            "unbalanced_median": float(np.median(np.concatenate(unbalanced))),
            "inertial_number_largest": max(test.inertial_number for test in self.tests),
            "rate_per_s_largest": max(test.biaxial.rate for test in self.tests),
            "pressure_error_rms": float(np.sqrt(np.mean(np.square(np.concatenate(errors))))),
        }

    def as_json(self, stratum: Stratum) -> dict[str, Any]:
        """Return the comparison of the discs with their soil as data for JSON; None for missing numbers."""
        return {
            "stratum": stratum.name,
            "packing": self.sample.packing,
            "soil": {
                "E_Pa": float(stratum.youngs_modulus),
                "nu": float(stratum.poissons_ratio),
                "c_Pa": float(stratum.cohesion),
                "phi_deg": float(np.degrees(stratum.friction_angle)),
            },
            "assembly": {
                "E_Pa": self.E,
                "nu": self.nu,
                "c_Pa": known(self.c),
                "phi_deg": known(np.degrees(self.phi)),
                "c_last_Pa": known(self.c_last),
                "phi_last_deg": known(np.degrees(self.phi_last)),
                "dilation_deg": float(np.degrees(self.dilation)),
                "G_Pa": self.G,
                "c_shear_Pa": self.c_shear,
                "phi_shear_deg": float(np.degrees(self.phi_shear)),
                "E_2d_Pa": self.stiffness.E_2d,
                "nu_2d": self.stiffness.nu_2d,
            },
            "tests": [
                {
                    "pressure_Pa": test.pressure,
                    "biaxial": {"verdict": test.biaxial_strength.verdict, "strain": test.biaxial_strength.strain,
                                "sigma_1_Pa": test.biaxial_strength.major, "sigma_3_Pa": test.biaxial_strength.minor},
                    "simple_shear": {"verdict": test.shear_strength.verdict, "strain": test.shear_strength.strain,
                                     "tau_Pa": test.shear_strength.shear, "sigma_Pa": test.shear_strength.normal},
                }
                for test in self.tests
            ],
            "verdicts": list(self.verdicts),
            "quality": self.quality,
        }  # fmt: skip


def element_test(
    sample: PatchSample,
    pressures: Sequence[float],
    *,
    strain: float = LARGEST_STRAIN,
    rate: float = STRAIN_RATE,
    threads: int = 1,
) -> ElementTest:
    """Test a sample at two or more confining pressures (Pa).

    Parameters
    ----------
    sample : discs of one layer
    pressures : confining pressures (Pa)
    strain : largest strain of both tests
    rate : strain per time sqrt(m / kn), so that all layers are tested equally slowly; it is reduced where the inertial
        number would exceed `INERTIAL_NUMBER`
    threads : threads of the engine; the result does not depend on their number

    Raises
    ------
    ValueError : if the pressures, the strain or the rate are not valid
    DemError : if a patch does not come to rest under its pressure
    """
    if len(set(pressures)) < 2 or not all(np.isfinite(p) and p > 0.0 for p in pressures):
        raise ValueError(f"pressures: expected two or more different pressures above 0 Pa, not {list(pressures)}")
    if not (0.0 < strain <= 0.5 and 0.0 < rate <= 1e-2):
        raise ValueError(f"strain = {strain}, rate = {rate}: expected a strain up to 0.5 and a rate up to 0.01")
    tests = tuple(_at_pressure(sample.patch(threads), p, strain, rate) for p in sorted(pressures))
    biaxial, shear = [t.biaxial_strength for t in tests], [t.shear_strength for t in tests]
    c, phi = from_principal([s.major for s in biaxial], [s.minor for s in biaxial])
    c_last, phi_last = from_principal([s.major_last for s in biaxial], [s.minor_last for s in biaxial])
    c_shear, phi_shear = from_plane([s.normal for s in shear], [s.shear for s in shear])
    stiffness = PlaneElastic(*(float(np.mean([getattr(t.stiffness, k) for t in tests])) for k in ("M", "lame", "G")))
    return ElementTest(
        sample=sample, stiffness=stiffness, G=stiffness.G, c=c, phi=phi, c_last=c_last, phi_last=phi_last,
        c_shear=c_shear, phi_shear=phi_shear, dilation=float(np.mean([s.dilation for s in biaxial])), tests=tests,
    )  # fmt: skip


def _at_pressure(patch: Patch, pressure: float, strain: float, rate: float) -> PressureTest:
    confine(patch, pressure)
    bonds = patch.model.set_pore_springs()
    stiffness, skewness = probe(patch, pressure)
    rate = min(rate, INERTIAL_NUMBER / patch.inertia(pressure))
    biaxial = load(patch.copy(), "biaxial", pressure, strain, rate, stiffness)
    shear = load(patch.copy(), "simple shear", pressure, strain, rate, stiffness)
    return PressureTest(
        pressure=pressure, stiffness=stiffness, skewness=skewness, biaxial=biaxial, biaxial_strength=strength(biaxial),
        shear=shear, shear_strength=strength(shear),
        inertial_number=rate * patch.inertia(pressure),
        pore_springs=bonds / float((~patch.frame).sum()),
    )  # fmt: skip
