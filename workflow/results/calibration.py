"""dem/calibration.json: which parameter of the discs was changed, by how much, and every trial of it."""

# ruff: noqa: N815 (units are written as they are)

from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import Field

from dem.laboratory.layer_check import LayerCheck
from workflow.results.answer import Answer, Known, Part
from workflow.results.discs import SearchVerdict

if TYPE_CHECKING:
    from dem.search.calibration import Calibration
    from dem.search.critical import Search


class SearchBracket(Part):
    """The bracket that one search for the critical Kh ended with."""

    kc: float | None
    kc_lower: float
    kc_upper: float | None
    verdict: SearchVerdict
    reason: str
    seconds: float = Field(description="time of the model, all trials together")


class FactorTrial(SearchBracket):
    """The critical Kh with one value of the factor."""

    value: float


class Sensitivity(FactorTrial):
    """The critical Kh with a factor on one parameter, all others as they were."""

    parameter: str


class SoilProperties(Part):
    """The soil of a stratum as the section gives it."""

    E_Pa: float
    nu: float
    c_Pa: float
    phi_deg: float


class AssemblyProperties(Part):
    """A patch of discs tested as a soil sample is; None for what could not be had."""

    E_Pa: Known
    nu: Known
    c_Pa: Known
    phi_deg: Known
    c_last_Pa: Known = Field(description="at the end of the test, past the peak")
    phi_last_deg: Known
    dilation_deg: Known
    G_Pa: Known
    c_shear_Pa: Known = Field(description="in simple shear")
    phi_shear_deg: Known
    E_2d_Pa: Known
    nu_2d: Known


class Biaxial(Part):
    """The strength in biaxial compression at one pressure."""

    verdict: str
    strain: Known
    sigma_1_Pa: Known
    sigma_3_Pa: Known


class SimpleShear(Part):
    """The strength in simple shear at one pressure."""

    verdict: str
    strain: Known
    tau_Pa: Known
    sigma_Pa: Known


class PressureAnswer(Part):
    """Both tests at one confining pressure."""

    pressure_Pa: Known
    biaxial: Biaxial
    simple_shear: SimpleShear


class ElementTestQuality(Part):
    """How near to rest the tests were up to their peaks."""

    unbalanced_largest: Known
    unbalanced_median: Known
    inertial_number_largest: Known
    rate_per_s_largest: Known
    pressure_error_rms: Known = Field(description="error of the pressure that was kept, as a share")


class LayerTest(Part):
    """The discs of one stratum in one packing beside the soil; without numbers where the test could not be done."""

    stratum: str
    packing: str
    soil: SoilProperties | None
    assembly: AssemblyProperties | None
    tests: tuple[PressureAnswer, ...] | None = None
    verdicts: tuple[str, ...] | None = Field(default=None, description="what keeps a strength from being a peak")
    quality: ElementTestQuality | None = None
    reason: str | None = Field(default=None, description="why the test could not be done")


class CalibrationAnswer(Answer):
    """The factor that brings the discs to the critical Kh of the continuum, or the closest that there is."""

    FILE: ClassVar[str] = "dem/calibration.json"

    target_kc: float | None = Field(description="the critical Kh that was asked for; None where none was")
    tolerance: float
    parameter: str
    value: float
    range: tuple[float, float] | None
    kc: float | None
    kc_lower: float
    kc_upper: float | None
    verdict: Literal["calibrated", "out of reach", "not asked for"]
    reason: str
    sensitivity: tuple[Sensitivity, ...]
    trials: tuple[FactorTrial, ...]
    element_tests: tuple[LayerTest, ...] = ()
    layers: tuple[LayerCheck, ...] = Field(default=(), description="soil discs: every stratum beside its discs")
    predicted_kc: float | None = Field(default=None, description="soil discs: the critical Kh, uncalibrated")
    predicted_ratio: float | None = Field(
        default=None, description="uncalibrated critical Kh over the lower end of that of the FEM with the same sides"
    )
    continuum_kc: tuple[float, float] | None = Field(
        default=None, description="soil discs: between which the continuum's lies; what was asked for is the nearest"
    )

    @property
    def leaves_open(self) -> bool:
        """Whether the interval of the continuum's critical Kh is wider than the tolerance of the calibration."""
        return self.continuum_kc is not None and self.continuum_kc[1] - self.continuum_kc[0] > self.tolerance

    @classmethod
    def of(cls, base: "Search", calibration: "Calibration | None", tolerance: float, **more: Any) -> Self:
        """The calibration as an answer holds it, sensitivities by parameter, then by factor; without any the discs as
        they are, with the critical Kh of the search ``base``. ``more`` are further fields of the answer."""
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
