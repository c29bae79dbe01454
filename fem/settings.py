"""Defines the settings of the search for the critical seismic coefficient."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, StrictBool

from meshes.section.polyline import downhill
from meshes.section.quantity import Length, Quantity
from meshes.section.recorded_kh import LARGEST_KH, RecordedKh
from meshes.section.section import Model, Section
from meshes.section.sides import liquefies_at_both_sides

Element = Literal["quadratic", "reduced", "bilinear"]
Sides = Literal["free-field", "smooth", "fixed", "periodic"]
DirectionSetting = Literal["both", "downhill", "uphill"]
FlowSetting = Literal["auto", "davis", "associated", "non-associated"]
DavisForm = Literal["A", "B", "C"]

# Accuracies are shares of Kh, or of this Kh where Kh is smaller: nobody designs by the fourth decimal. In the factor of
# safety they are half as large a share: where Kh changes by 0.002, that changes by some 0.5 %.
LEAST_KH, FACTOR_SHARE = 0.2, 0.5

YIELDED = 0.99  # of the critical Kh: its last per cent is a matter of the mesh and the step

# Settings of [fem] that change nothing in the critical Kh and the path to it: factors of safety are found beside that.
WITHOUT_EFFECT = ("fem.threads", "fem.safety_factor_at")


# How a path of equilibrium ends.
PathVerdict = Literal["plateau", "peak", "no failure", "undecided"]


# Ground is level at an end if its slope is below LEVEL (-) over a distance of STRETCH mean heights of the section.
LEVEL, STRETCH = 0.02, 0.5
PLATEAU = 0.1  # of the steepest stretch: ends that fall by less count as level, too


def usual_sides(section: Section) -> Sides:
    """Return the default sides of a section file: "smooth" if the ground is level at both ends, else "free-field".

    Level ground that continues beyond the section stands under any Kh below about tan φ' times buoyant over saturated
    unit weight. Free-field sides resist with the K0 stress only. Free-field sides let level ground slide out of the
    section at about half of this Kh (0.15 in sand below water), long before a slope in the middle may fail. Where the
    ground slopes at an end, smooth or fixed sides would support the slope.

    Parameters
    ----------
    section : Section
        The ground.

    Returns
    -------
    str
        "smooth" or "free-field".
    """
    return "smooth" if all(_level_ends(section)) else "free-field"


def usual_sides_of_slides(section: Section) -> Sides | None:
    """Return the default sides for slides of a section file, if they differ from those of the finite elements.

    The sides are free-field where a stratum liquefies at both: such a side slides with the endless slope beyond it, and
    resists other motion, so that the slide hardly depends on where the section ends. Smooth sides would hold back
    ground that slides on a gentle slope. A free-field side at which nothing liquefies keeps the pressure at rest, and
    pushes the level ground behind a face downslope. The sides are then "smooth" if the ground is level at its higher
    end and slopes at the other end.

    Parameters
    ----------
    section : the ground

    Returns
    -------
    "free-field", "smooth", or None for the sides of the elements.
    """
    if liquefies_at_both_sides(section):
        return "free-field"
    left, right = _level_ends(section)
    higher, lower = (left, right) if downhill(section.ground) > 0 else (right, left)
    return "smooth" if higher and not lower else None


def _level_ends(section: Section) -> tuple[bool, bool]:
    """Return whether the ground is level at the left and at the right end, over half of the mean height of the section.

    Ground also counts as level where it falls by less than a tenth of the fall of the steepest stretch of the same
    length: a plateau of 1:40 behind a cut is no slope that continues. Longer level stretches are not required: an
    embankment on soft ground that is deeper than the level ground beside it is wide would then get free-field sides,
    with which its critical Kh is ten times too small.
    """
    ground, (left, right) = section.ground, section.extent
    stretch = STRETCH * float(section.layering.areas().sum()) / (right - left)
    ends = np.interp([[left, left + stretch], [right - stretch, right]], ground[:, 0], ground[:, 1])
    begins = np.clip(np.concatenate([ground[:, 0], ground[:, 0] - stretch]), left, right - stretch)
    falls = np.interp(begins, *ground.T) - np.interp(begins + stretch, *ground.T)
    least = max(LEVEL * stretch, PLATEAU * float(np.abs(falls).max()))
    at_left, at_right = (bool(abs(end[1] - end[0]) <= least) for end in ends)
    return at_left, at_right


class FemSettings(Model):
    """Holds the settings of the finite element analysis, the table [fem] of the input file."""

    element: Literal["auto", "quadratic", "reduced", "bilinear"] = Field(
        default="auto",
        description='"quadratic" (9 nodes), "reduced" (9 nodes, for associated flow), "bilinear" (4 nodes), or "auto": '
        "reduced where the flow is associated (the default), quadratic elsewhere",
    )
    sides: Sides = Field(
        default="free-field",
        description='"free-field" (free horizontally under the K0 stress, held vertically), "smooth" (held '
        'horizontally, free vertically, as in slope programs), "fixed" (held in both) or "periodic" (both sides have '
        'equal displacements); a section file that does not say has "smooth" where its ground is level at both ends, '
        '"free-field" '
        "where it slopes there, since held sides support a slope that continues",
    )
    rigid_box: StrictBool = Field(
        default=True,
        description=(
            "true to calibrate the discs to the critical Kh between fixed sides, false to calibrate them "
            "to the critical Kh with the sides of this table"
        ),
    )
    direction: DirectionSetting = Field(
        default="both",
        description='direction of the seismic force, by the ends of the surface; "both": the smaller Kh counts',
    )
    least_depth: Length = Field(
        default=Quantity(0.5, "0.5 m"),
        description="least depth of failures that count; shallower failures of cohesionless faces are reported "
        "as shallow failures",
    )
    accuracy: float = Field(
        default=0.01,
        ge=0.0,
        le=0.5,
        description=(
            "largest remaining discretisation error, such as 0.01; finer meshes are made until the error is smaller. "
            "The error is a share of the critical Kh, or of 0.2 if the critical Kh is smaller; a factor of safety has "
            "half of this error. With 0, or with given columns and rows, the first mesh is the only one"
        ),
    )
    max_cells: int = Field(default=6000, ge=100, le=500_000, description="largest number of cells of a mesh")
    vertical: float = Field(default=0.0, gt=-1.0, lt=1.0, description="vertical seismic coefficient, positive upwards")
    flow: FlowSetting = Field(
        default="auto",
        description=(
            '"associated" (ψ = φ), "davis" (Davis\'s estimate where ψ < φ: less strength, associated flow), '
            '"non-associated" (equilibrium path with the ψ of the strata) or "auto" ("davis" where the strata give a '
            'dilation angle below φ, "associated" elsewhere). Results with "associated" and "davis" each state the '
            "result by the other one"
        ),
    )
    davis: DavisForm = Field(
        default="B", description="form of Davis's reduced strength in the factor of safety: A, B or C"
    )
    own_dilation: StrictBool = Field(
        default=False,
        description=(
            "true to compute, where ψ < φ, also the approximate critical Kh of ground that flows with the "
            "ψ of its strata, which takes some 20 s"
        ),
    )
    kh: RecordedKh = Field(
        default=(),
        description="seismic coefficients whose fields are stored, such as [0.2, 0.3]; by default 0.5 and 0.8 "
        "of the critical Kh; the fields at the critical Kh are always stored",
    )
    kh_limit: float = Field(default=1.5, gt=0.0, description="largest Kh: the search for the critical Kh ends there")
    first_step: float = Field(default=0.02, gt=0.0, le=0.1, description="first step of Kh along the path")
    tolerance: float = Field(
        default=1e-6,
        ge=1e-12,
        le=1e-3,
        description="largest unbalanced force, over the weight, of a state in equilibrium",
    )
    relaxation: float = Field(
        default=0.002,
        ge=0.0,
        le=0.1,
        description=(
            "displacement over which the viscous overstress decays, over the elastic displacement; it is "
            'used with flow = "non-associated"'
        ),
    )
    safety_factor_at: tuple[Annotated[float, Field(ge=-LARGEST_KH, le=LARGEST_KH)], ...] = Field(
        default=(0.0,), description="seismic coefficients at which the factor of safety is computed, such as [0.0, 0.1]"
    )
    threads: int = Field(default=1, ge=1, le=256, description="number of threads that update the stress")


class BoundsSettings(Model):
    """Holds the settings of limit analysis, the table [bounds] of the input file."""

    run: StrictBool | Literal["auto"] = Field(
        default="auto",
        description=(
            "true if `noshiro run`, and `noshiro fem` with factors of safety, compute strict bounds, "
            'false if not; "auto" is true'
        ),
    )
    gap: float = Field(
        default=0.01,
        ge=1e-4,
        le=1.0,
        description="gap (upper - lower) at which the search for bounds ends, such as 0.01: as a share of the "
        "mean of both, or of a Kh of 0.2 if the mean is smaller; half of this gap for a factor of safety",
    )
    max_cells: int = Field(default=20_000, ge=100, le=500_000, description="largest number of triangles")
    seconds: float = Field(
        default=60.0,
        gt=0.0,
        le=86_400.0,
        description=(
            "largest computing work, such as 20, in seconds of a reference machine; the work is computed from "
            "the number of iterations, not measured, so that a busy machine finds the same bounds"
        ),
    )
    safety_factor: StrictBool = Field(
        default=False,
        description="true to find bounds of the factor of safety, too, at every safety_factor_at of [fem]",
    )
    davis: StrictBool | Literal["auto"] = Field(
        default="auto",
        description="true to find bounds of Davis's estimate, too, if ψ < φ (c and tan φ reduced), false not to; "
        '"auto": if Davis\'s estimate is the flow rule of [fem]',
    )

    @property
    def of_factors(self) -> "BoundsSettings":
        """Return the settings for bounds of factors of safety, whose required gap is smaller."""
        return self.model_copy(update={"gap": FACTOR_SHARE * self.gap})
