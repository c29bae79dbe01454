"""Stores the critical seismic coefficient of the continuum, and the path to it, in fem/critical.json."""

from collections.abc import Sequence
from math import log
from typing import TYPE_CHECKING, ClassVar, Literal, Self

from pydantic import Field

from fem.continuum.loads import Direction
from fem.continuum.strength import Flow, davis_words
from fem.path.path_step import PathStep
from fem.search.result_warnings import ResultWarning
from fem.settings import YIELDED, Element, FemSettings, PathVerdict
from workflow.results.answer import Answer, Line, Part, SectionLabel

if TYPE_CHECKING:
    from meshes.quad_mesh import QuadMesh


class MeshCount(Part):
    """Holds the size of the mesh of an answer."""

    quadrilaterals: int = Field(description="number of quadrilateral cells")
    nodes: int = Field(description="number of corners of the cells")
    method: str = Field(description='method of the mesh: "mapped", "free", or "given" if the mesh was read from a file')

    @classmethod
    def of(cls, mesh: "QuadMesh") -> Self:
        """Return the size of a mesh."""
        return cls(quadrilaterals=len(mesh.cells), nodes=len(mesh.points), method=mesh.method)


class Gravity(Part):
    """Holds numbers of the equilibrium under gravity, before the seismic force acts."""

    iterations: int = Field(description="number of Newton iterations")
    plastic_share: float = Field(description="share of the quadrature points that yield under the weight alone, 0 to 1")


class StoredState(Part):
    """Holds one state of the continuum, at a Kh at which fields are stored."""

    label: str = Field(description="name of the state in legends")
    kh: float = Field(description="seismic coefficient")
    past_equilibrium: bool = Field(description="whether there is no equilibrium at this Kh")
    largest_displacement_m: float = Field(description="largest displacement since the equilibrium under gravity")
    failed_share_by_stratum: dict[str, float] = Field(
        description="share of the cells of each stratum at failure, 0 to 1"
    )
    slip_surface: Line = Field(description="points [x, elevation] of the slip surface (m)")


class FactorOfSafety(Part):
    """Holds the factor of safety at one Kh: the divisor of c and tan φ at which the section fails."""

    kh: float = Field(description="seismic coefficient at which the strength is divided")
    factor: float = Field(description="largest divisor of the strength at which an equilibrium was found")
    upper: float = Field(description="upper end of the bracket on this mesh")
    verdict: PathVerdict = Field(
        description=(
            'how the path ended: "plateau" or "peak" (the section fails), "no failure" (it does not up to the '
            'largest factor), or "undecided"'
        )
    )
    reason: str = Field(description="reason of the verdict, in words")
    curve: tuple[PathStep, ...] = Field(
        description=(
            "steps of the path: the factor over the control displacement; empty if limit analysis gave the factor"
        )
    )
    shallow_failure: float | None = Field(
        description="factor of safety against the shallow failure of a cohesionless face, if there is one"
    )
    davis: float | None = Field(
        default=None, description="Davis's estimate (low, no bound) if the factor is with ψ = φ"
    )
    associated: float | None = Field(
        default=None, description="factor of safety with ψ = φ, if the factor is Davis's estimate"
    )
    remaining_error: float | None = Field(
        default=None, description="remaining discretisation error of the factor, as a share of the factor"
    )
    slip_surface: Line = Field(default=(), description="points [x, elevation] of the slip surface (m)")
    slides_to: tuple[Literal["left", "right"], ...] = Field(
        default=(), description="sides to which the ground slides, both if it spreads"
    )
    extent_m: tuple[float, float] | None = Field(
        default=None, description="x of both ends of the ground surface that moves (m)"
    )
    after_shaking: bool = Field(
        default=False, description="whether the excess pore pressure of shaking acts, though Kh is 0"
    )


class OtherCriticalKh(Part):
    """Holds the critical Kh for the opposite direction, or with another flow rule."""

    kc: float = Field(
        description="critical Kh in this direction, or with this flow rule; 0 if the ground then fails by its weight"
    )
    kc_upper: float = Field(description="upper end of the bracket on this mesh; no bound of the section")
    verdict: PathVerdict = Field(description='how the path ended; there is a critical Kh for "plateau" and "peak" only')
    reason: str = Field(description="reason of the verdict, in words")
    direction: Direction = Field(description="direction of the seismic force, by the ends of the surface")
    at_sides: tuple[str, ...] = Field(description="sides, left or right, that the failing ground reaches")
    meshes: int = Field(default=1, description="number of meshes of the sequence that led to this critical Kh")


class OwnDilationPart(Part):
    """Holds an approximate critical Kh of ground that flows with the ψ of the strata.

    The critical Kh for these angles depends on element and mesh by 5 to 15 %.
    """

    kc: float | None = Field(description="critical Kh on the last of three meshes; null if the iteration has no answer")
    low: float | None = Field(description="smallest critical Kh of the three meshes")
    high: float | None = Field(description="largest critical Kh of the three meshes")
    cells: tuple[int, ...] = Field(description="number of cells of each mesh")
    reason: str = Field(description="reason why there is no critical Kh")


class ShallowFailurePart(Part):
    """Holds a cohesionless face that fails before the slope as a whole fails."""

    stratum: str = Field(description="stratum of the face")
    start_x_m: float = Field(description="x of the left end of the face")
    end_x_m: float = Field(description="x of the right end of the face")
    angle_deg: float = Field(description="slope of the face, positive")
    kh: float = Field(description="Kh at which the face fails; below 0 if it fails under its own weight")

    def is_edge(self, least_depth: float) -> bool:
        """Return whether the face is only the edge of an outcropping layer, narrower than the least depth (m) of
        failures."""
        return self.end_x_m - self.start_x_m < least_depth


class MeshStep(Part):
    """Holds one mesh of the sequence that was adapted to the mechanism."""

    cells: int = Field(description="number of cells of the mesh")
    kc: float = Field(description="critical Kh on this mesh")


def displacement_at(path: Sequence[PathStep], kc: float, share: float) -> float:
    """Return the displacement at which a path of rising Kh reaches a share of the critical Kh.

    If limit analysis gave the critical Kh, a path may end before it reaches the share. The path is then extrapolated:
    the difference to kc decays exponentially with displacement, at the rate of the last step. For S-13 in a rigid box,
    paths cut off at 0.8 and 0.95 of kc give the displacement at 0.99 of kc within 7 %.

    Parameters
    ----------
    path : steps of the path, at least one
    kc : critical Kh (-)
    share : share of kc that is to be reached, below 1 (-)

    Returns
    -------
    The control displacement (m).
    """
    near = [step.displacement for step in path if step.factor >= share * kc]
    if near or len(path) < 2:
        return min(near, default=path[-1].displacement)
    before, last = path[-2:]
    left = [1.0 - step.factor / kc for step in (before, last)]
    if left[1] >= left[0]:
        return last.displacement
    length = (last.displacement - before.displacement) / log(left[0] / left[1])
    return last.displacement + length * log(left[1] / (1.0 - share))


class FailureAnswer(Answer):
    """Holds the factor of safety of a section that fails without a seismic force, and so has no critical Kh."""

    FILE: ClassVar[str] = "fem/failure.json"

    section: SectionLabel = Field(description="section to which the factor belongs")
    factor: float = Field(description="factor of safety at Kh = 0, below 1")
    flow: Flow = Field(description='flow rule of the factor: "associated" is ψ = φ, "davis" is Davis\'s estimate')
    davis: float | None = Field(description="Davis's estimate (low, no bound) if the factor is with ψ = φ")
    associated: float | None = Field(description="factor of safety with ψ = φ, if the factor is Davis's estimate")
    slip_surface: Line = Field(description="points [x, elevation] of the slip surface (m)")


class Variant(Part):
    """Holds one change of the assumptions, and the critical Kh with this change."""

    name: str = Field(description='name of the assumption in [variants], such as "sides"')
    change: str = Field(description="changed assumption, in words")
    kc: float | None = Field(
        description="critical Kh with the change; null without an answer, 0 if the section then fails by its weight"
    )
    kc_upper: float | None = Field(description="upper end of the bracket on its mesh; null without an answer")
    verdict: PathVerdict | Literal["no answer"] = Field(
        description='how the path ended; there is a critical Kh for "plateau" and "peak" only'
    )
    reason: str = Field(description="reason of the verdict, in words")
    seconds: float = Field(description="computing time (s)")
    kc_without: float | None = Field(
        default=None,
        description="critical Kh without the change, if both were computed on a coarser mesh than the answer, or with "
        "another element",
    )

    def of(self, kc: float) -> float | None:
        """Return the critical Kh with one assumption changed; None without an answer.

        If the change was computed on a coarser mesh than the answer ``kc``, or with another element, the critical Kh is
        ``kc`` times the ratio of both critical Kh by that mesh or element.
        """
        if self.kc is None or self.kc_without is None:
            return self.kc
        return kc * self.kc / self.kc_without


class FemAnswer(Answer):
    """Holds the critical Kh, with its bracket, verdict and path."""

    FILE: ClassVar[str] = "fem/critical.json"
    VERSION: ClassVar[int] = 5

    section: SectionLabel = Field(description="section to which the critical Kh belongs")
    kc: float = Field(
        description="critical Kh: limit load of the mesh by finite element limit analysis, or else the largest Kh of "
        "the path in equilibrium"
    )
    kc_lower: float = Field(description="largest Kh in equilibrium on the path")
    kc_upper: float = Field(description="upper end of the bracket on this mesh; no bound of the section")
    verdict: PathVerdict = Field(
        description=(
            'how the path ended: "plateau" or "peak" (the section fails), "no failure" (it stands up to '
            'fem.kh_limit), or "undecided"'
        )
    )
    reason: str = Field(description="reason of the verdict, in words")
    remedy: str = Field(description="advice on how to get a better answer; empty if there is none")
    judgement: Literal["sound", "doubtful"] = Field(description='"doubtful" if a warning contradicts the answer')
    warnings: tuple[ResultWarning, ...] = Field(description="reasons not to trust the answer, and notes")
    direction: Direction = Field(description="direction of the seismic force at failure, by the ends of the surface")
    towards: Literal["left", "right"] = Field(description="side of the section towards which this seismic force acts")
    at_sides: tuple[str, ...] = Field(default=(), description="sides, left or right, that the failing ground reaches")
    opposite: OtherCriticalKh | None = Field(
        description="critical Kh for a seismic force in the opposite direction, if both were computed"
    )
    associated: OtherCriticalKh | None = Field(
        description="critical Kh with ψ = φ, if the answer has another flow rule"
    )
    davis: OtherCriticalKh | None = Field(
        default=None,
        description=(
            "Davis's estimate of the critical Kh (low, no bound), if the answer is with ψ = φ and ψ is smaller"
        ),
    )
    own_dilation: OwnDilationPart | None = Field(
        default=None, description="approximate critical Kh for the ψ of the strata, if fem.own_dilation = true"
    )
    without_tension: Variant | None = Field(
        default=None,
        description="critical Kh of the ground without tensile strength, on the first mesh that is adapted to the "
        "mechanism, if it was computed",
    )
    shallow_failures: tuple[ShallowFailurePart, ...] = Field(
        description="cohesionless faces that fail at a smaller Kh; kc is that of a deeper failure"
    )
    flow: Flow = Field(
        description=(
            'flow rule of kc: "associated" is ψ = φ, "davis" is Davis\'s estimate, "non-associated" a path with the '
            "given ψ"
        )
    )
    element: Element = Field(description="finite element of the path")
    settings: FemSettings = Field(description="settings of the finite elements, the table [fem]")
    dilation_deg: dict[str, float] = Field(description="dilation angle ψ by stratum (degrees), 0 if it is not given")
    mesh: MeshCount = Field(description="size of the mesh of kc")
    meshes: tuple[MeshStep, ...] = Field(
        description="answers on the sequence of meshes that were adapted to the mechanism; empty if there were none"
    )
    meshes_ended: str = Field(description="reason why there was no finer mesh")
    kc_limit: float | None = Field(
        description="limit of the critical Kh for infinitely small cells, extrapolated from two meshes"
    )
    gravity: Gravity = Field(description="the equilibrium under gravity, from which the path begins")
    linear_solves: int = Field(description="number of linear systems that were factorised along the path")
    curve: tuple[PathStep, ...] = Field(description="steps of the path: Kh over the mean horizontal displacement")
    states: tuple[StoredState, ...] = Field(description="states at the Kh of fem.kh and at the end of the path")
    safety_factors: tuple[FactorOfSafety, ...] = Field(
        description="factors of safety at the Kh of fem.safety_factor_at"
    )
    after_shaking: FactorOfSafety | None = Field(
        default=None,
        description="factor of safety at Kh = 0 with the excess pore pressure of shaking, which also acts with every "
        "other Kh, if there is any",
    )

    @property
    def factors(self) -> tuple[FactorOfSafety, ...]:
        """Return all factors of safety, the one after shaking last."""
        return (*self.safety_factors, *(() if self.after_shaking is None else (self.after_shaking,)))

    @property
    def at_rest(self) -> FactorOfSafety | None:
        """Return the factor of safety at Kh = 0 of the ground that has the critical Kh: after shaking if its excess
        pore pressure acts with Kh; None if it was not computed."""
        return self.after_shaking or next((factor for factor in self.safety_factors if factor.kh == 0.0), None)

    @property
    def estimate(self) -> str:
        """Return the name of Davis's estimate for these dilation angles."""
        return davis_words(self.dilation_deg.values())

    def is_rough(self, other: OtherCriticalKh) -> bool:
        """Return whether another critical Kh is that of one mesh, while this one is that of a sequence: with a seismic
        force in the direction that does not govern, whose Kh may be some per cent less on finer meshes."""
        return other.meshes == 1 and len(self.meshes) > 1 and other.verdict in ("plateau", "peak")

    @property
    def by_limit_analysis(self) -> bool:
        """Return whether the critical Kh is the limit load of the mesh by finite element limit analysis, not the
        largest Kh of an equilibrium path. The path is then followed to a smaller Kh."""
        return self.verdict == "plateau" and self.kc_lower < self.kc

    @property
    def own_angles(self) -> str:
        """Return the dilation angles of the strata in words."""
        return "the given ψ" if any(self.dilation_deg.values()) else "ψ = 0"

    @property
    def end_reason(self) -> str:
        """Return the verdict in words. The verdict is a plateau only if the path itself reached one: if the limit load
        is from limit analysis, the path may still rise at its end.
        """
        known_before = self.verdict == "plateau" and self.kc_lower < YIELDED * self.kc
        return "limit load" if known_before else self.verdict

    @property
    def has_kc(self) -> bool:
        """Return whether there is a critical Kh: the path reached a plateau or a peak."""
        return self.verdict in ("plateau", "peak")

    def state_at(self, kh: float) -> StoredState | None:
        """Return the stored state at a Kh; None if no state is stored at this Kh."""
        return next((state for state in self.states if abs(state.kh - kh) < 1e-9), None)

    def last_in_equilibrium(self) -> StoredState | None:
        """Return the last state of the path, which shows the failure mechanism."""
        return next((state for state in reversed(self.states) if not state.past_equilibrium), None)


class VariantsAnswer(Answer):
    """Holds all computed changes of assumptions."""

    FILE: ClassVar[str] = "fem/variants.json"

    variants: tuple[Variant, ...] = Field(description="one entry for each requested change")
