"""Stores the calibrated parameter of the discs, its factor, and all trials in dem/calibration.json."""

# ruff: noqa: N815 (units are written as they are)

from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import Field

from dem.laboratory.layer_check import LayerCheck
from dem.settings import SearchVerdict
from workflow.results.answer import Answer, Known, Part

if TYPE_CHECKING:
    from dem.search.calibration import Calibration
    from dem.search.critical import Search


class SearchBracket(Part):
    """Holds the final bracket of one search for the critical Kh."""

    kc: float | None = Field(description="critical Kh of the discs; null without a bracket")
    kc_lower: float = Field(description="lower end of the bracket, at which the discs stand")
    kc_upper: float | None = Field(
        description="upper end of the bracket, at which the discs do not stand; null if they stand at every Kh"
    )
    verdict: SearchVerdict = Field(description='"bracketed", or why there is no bracket')
    reason: str = Field(description="reason of the verdict, in words")
    seconds: float = Field(description="model time of all trials together (s)")


class FactorTrial(SearchBracket):
    """Holds the critical Kh with one value of the factor."""

    value: float = Field(description="factor on the parameter of the calibration")


class Sensitivity(FactorTrial):
    """Holds the critical Kh with a factor on one parameter and all other parameters unchanged."""

    parameter: str = Field(description="parameter that the factor multiplies")


class SoilProperties(Part):
    """Holds the parameters of a stratum in the section file."""

    E_Pa: float = Field(description="Young's modulus")
    nu: float = Field(description="Poisson's ratio")
    c_Pa: float = Field(description="cohesion")
    phi_deg: float = Field(description="friction angle")


class AssemblyProperties(Part):
    """Holds the results of element tests on a patch of discs, None if a result is missing."""

    E_Pa: Known = Field(description="Young's modulus of the soil in plane strain that the discs represent")
    nu: Known = Field(description="Poisson's ratio of this soil")
    c_Pa: Known = Field(description="cohesion from the peaks of the biaxial tests")
    phi_deg: Known = Field(description="friction angle from the peaks of the biaxial tests")
    c_last_Pa: Known = Field(description="cohesion from the last tenth of the biaxial tests, after the peak")
    phi_last_deg: Known = Field(description="friction angle from the last tenth of the biaxial tests")
    dilation_deg: Known = Field(description="mean dilation angle at the peaks of the biaxial tests")
    G_Pa: Known = Field(description="shear modulus from the tests in simple shear")
    c_shear_Pa: Known = Field(description="cohesion from the peaks of the tests in simple shear")
    phi_shear_deg: Known = Field(description="friction angle from the peaks of the tests in simple shear")
    E_2d_Pa: Known = Field(description="Young's modulus of the discs as a sheet in plane stress")
    nu_2d: Known = Field(description="Poisson's ratio of the discs as a sheet in plane stress")


class Biaxial(Part):
    """Holds the strength in biaxial compression at one pressure."""

    verdict: str = Field(
        description='"peak", "levels off", "still rising" (at the largest strain of the test), or "stopped"'
    )
    strain: Known = Field(description="strain at the largest resistance")
    sigma_1_Pa: Known = Field(description="larger principal stress at the largest resistance, compression positive")
    sigma_3_Pa: Known = Field(description="smaller principal stress there")


class SimpleShear(Part):
    """Holds the strength in simple shear at one pressure."""

    verdict: str = Field(description="as for biaxial compression")
    strain: Known = Field(description="shear strain at the largest resistance")
    tau_Pa: Known = Field(description="shear stress on the horizontal plane at the largest resistance")
    sigma_Pa: Known = Field(description="normal stress on the horizontal plane there, compression positive")


class PressureAnswer(Part):
    """Holds both tests at one confining pressure."""

    pressure_Pa: Known = Field(description="confining pressure")
    biaxial: Biaxial = Field(description="biaxial compression")
    simple_shear: SimpleShear = Field(description="simple shear")


class ElementTestQuality(Part):
    """Holds numbers that show how quasi-static the tests were up to their peaks."""

    unbalanced_largest: Known = Field(description="largest ratio of mean unbalanced force to mean contact force")
    unbalanced_median: Known = Field(description="median of this ratio")
    inertial_number_largest: Known = Field(
        description="largest inertial number: strain rate times diameter times √(density over pressure)"
    )
    rate_per_s_largest: Known = Field(description="largest strain rate of the biaxial tests (1/s)")
    pressure_error_rms: Known = Field(description="root mean square of the relative error of the confining pressure")


class LayerTest(Part):
    """Compares the discs of one stratum in one packing with the soil by element tests, if the test did not fail."""

    stratum: str = Field(description="name of the stratum")
    packing: str = Field(description='packing of the tested patch of discs: "lattice" or "random"')
    soil: SoilProperties | None = Field(description="parameters of the soil; null if the test failed")
    assembly: AssemblyProperties | None = Field(description="parameters of the discs; null if the test failed")
    tests: tuple[PressureAnswer, ...] | None = Field(
        default=None, description="strengths at each confining pressure, in rising order"
    )
    verdicts: tuple[str, ...] | None = Field(default=None, description="sentences on strengths that are not a peak")
    quality: ElementTestQuality | None = Field(default=None, description="how quasi-static the tests were")
    reason: str | None = Field(default=None, description="reason why the test could not be done")


class CalibrationAnswer(Answer):
    """Holds the factor with which the discs have the critical Kh of the continuum, or the factor that comes closest.

    Without a calibration the factor is 1, and the critical Kh is the uncalibrated one.
    """

    FILE: ClassVar[str] = "dem/calibration.json"

    target_kc: float | None = Field(
        description="the critical Kh to which the discs were calibrated; None without a target"
    )
    tolerance: float = Field(description="allowed difference of kc from the target")
    parameter: str = Field(
        description=(
            'constants of the discs that the factor multiplies: "stiffness", "friction", "pore_strength", '
            '"strength", "all", or "none"'
        )
    )
    value: float = Field(description="factor on these constants")
    range: tuple[float, float] | None = Field(
        description="least and largest factor that was allowed; null without a calibration"
    )
    kc: float | None = Field(description="critical Kh of the discs with this factor; null without a bracket")
    kc_lower: float = Field(description="lower end of the bracket, at which the discs with this factor stand")
    kc_upper: float | None = Field(
        description="upper end of the bracket, at which they do not stand; null if they stand at every Kh"
    )
    verdict: Literal["calibrated", "out of reach", "not asked for"] = Field(
        description=(
            '"calibrated"; "out of reach": no factor that was tried has a kc within the tolerance; "not asked for": no '
            "calibration"
        )
    )
    reason: str = Field(description="reason of the verdict, in words")
    sensitivity: tuple[Sensitivity, ...] = Field(
        description="critical Kh with each parameter halved, unchanged and doubled, by parameter and factor"
    )
    trials: tuple[FactorTrial, ...] = Field(
        description="critical Kh with every factor that was tried, sorted by factor"
    )
    element_tests: tuple[LayerTest, ...] = Field(
        default=(), description="discs of the paper: element tests of every stratum, if dem.element_tests = true"
    )
    layers: tuple[LayerCheck, ...] = Field(
        default=(), description="soil discs: comparison of every stratum with its discs"
    )
    predicted_kc: float | None = Field(default=None, description="soil discs: the uncalibrated critical Kh")
    predicted_ratio: float | None = Field(
        default=None,
        description="uncalibrated critical Kh over the critical Kh (lower end of its interval) of the FEM, same sides",
    )
    continuum_kc: tuple[float, float] | None = Field(
        default=None,
        description="soil discs: range of the critical Kh of the continuum; the target is the nearest value in it",
    )

    @property
    def leaves_open(self) -> bool:
        """Return whether the interval of the critical Kh of the continuum is wider than the tolerance of the
        calibration."""
        return self.continuum_kc is not None and self.continuum_kc[1] - self.continuum_kc[0] > self.tolerance

    @classmethod
    def of(cls, base: "Search", calibration: "Calibration | None", tolerance: float, **more: Any) -> Self:
        """Return the results of a calibration, with sensitivities sorted by parameter and factor. Without a
        calibration, return the results of uncalibrated discs, with the critical Kh of the search ``base``.
        ``tolerance`` is the largest difference from the target; ``more`` are further fields.
        """
        if calibration is None:
            return cls.taken(
                base,
                target_kc=None,
                tolerance=tolerance,
                parameter="none",
                value=1.0,
                range=None,
                verdict="not asked for",
                reason='dem.parameter = "none"',
                sensitivity=(),
                trials=(),
                **more,
            )
        parameters = dict.fromkeys(name for name, _, _ in calibration.sensitivity if name)
        by_factor = sorted(calibration.sensitivity, key=lambda row: row[1])
        return cls.taken(
            calibration,
            target_kc=calibration.target,
            kc=calibration.search.kc,
            kc_lower=calibration.search.kc_lower,
            kc_upper=calibration.search.kc_upper,
            sensitivity=tuple(
                Sensitivity.taken(search, value=factor, parameter=name)
                for name in parameters
                for changed, factor, search in by_factor
                if changed in ("", name)
            ),
            trials=tuple(FactorTrial.taken(search, value=factor) for factor, search in calibration.trials),
            **more,
        )
