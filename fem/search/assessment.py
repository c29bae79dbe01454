"""Assesses a section: critical Kh in both directions, with ψ = φ and by Davis's estimate, factors of safety, and
warnings.
"""

from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from fem.continuum.loads import ADVICE_ON_UPLIFT, uplift_error
from fem.continuum.strength import flow_of, is_associated, is_dilating_fully
from fem.errors import NoEquilibriumError, UnstableError, accepting_no_answer
from fem.limit_load.limit_load import LimitLoadResult
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.gravity import element_for
from fem.search.adaptive import AdaptiveSearch, failing_by_itself, path_start
from fem.search.checks import SOLVER_ACCURACY, of_uplift, warnings_of
from fem.search.critical import CriticalResult, critical_coefficient
from fem.search.mesh_sequence import AdaptiveResult
from fem.search.own_dilation import OwnDilation, own_dilation
from fem.search.result_warnings import ResultWarning
from fem.search.strength_reduction import SafetyFactor, safety_factor
from fem.search.unstable_ground import by, with_factors
from fem.settings import FemSettings
from fem.solvers.blas_threads import one_more_thread
from meshes.errors import NoAnswerError
from meshes.executor import Executor, check_cancelled
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from meshes.settings import MeshSettings

# Is called with the present task and, on an equilibrium path, with the path.
AssessmentListener = Callable[[str, EquilibriumPath | None], None]

# A factor of safety that is being computed, or the reason why there is none.
Safety = Future[AdaptiveResult[SafetyFactor] | ResultWarning]


@dataclass(frozen=True)
class Assessment:
    """Holds the answers for a section, compared with each other.

    Attributes
    ----------
    critical : the critical Kh, with the path to it
    mesh : mesh on which the critical Kh was computed
    path_mesh : mesh on which the equilibrium path was followed, and of the states on it
    adapted : the limit loads of the sequence of meshes that ends with ``mesh``; None if the flow is not associated
    opposite : the result for the opposite direction, where both directions were analysed
    associated : the result for the same direction with ψ = φ, on its own meshes; None if ``critical`` has ψ = φ
    davis : Davis's estimate for the same direction, 0 where such ground fails under its weight; None if ``critical`` is
        Davis's estimate or follows from a path, or where the section file has ψ = φ
    safety : factors of safety at the Kh of the settings, the first one without shaking, each on its own meshes
    warnings : warnings: contradictions and notes on the answer
    own_dilation : the critical Kh for the dilation angles of the strata, if it was computed
    after_shaking : factor of safety without a seismic force, with the excess pore pressure that shaking leaves behind;
        None without such pressure
    """

    critical: CriticalResult
    mesh: QuadMesh
    path_mesh: QuadMesh
    adapted: AdaptiveResult[LimitLoadResult] | None
    opposite: AdaptiveResult[LimitLoadResult] | AdaptiveResult[CriticalResult] | None
    associated: AdaptiveResult[LimitLoadResult] | None
    davis: AdaptiveResult[LimitLoadResult] | None
    safety: list[AdaptiveResult[SafetyFactor]]
    warnings: list[ResultWarning]
    own_dilation: OwnDilation | None = None
    after_shaking: AdaptiveResult[SafetyFactor] | None = None


def assess(
    section: Section,
    meshing: MeshSettings,
    first: QuadMesh,
    settings: FemSettings,
    comm: Any,
    listener: AssessmentListener,
) -> Assessment:
    """Find the critical Kh and the answers that it is compared with.

    Parameters
    ----------
    section : the ground
    meshing : settings of the meshes
    first : the first mesh, after which meshes are adapted
    settings : settings of the finite elements
    comm : MPI communicator of the ranks that share the elements
    listener : called with the present task and, on an equilibrium path, with the path

    Returns
    -------
    All answers, with their meshes and warnings.

    Raises
    ------
    InputError
        If the section cannot be analysed.
    NoEquilibriumError
        If no state on the path is in equilibrium, where the limit load is not unique.
    UnstableError
        If the ground fails under its weight; with the factor of safety, if there is one.
    """
    settings = settings.changed(flow=flow_of(section.strata, settings.flow))
    with one_more_thread(comm.size == 1) as executor:
        search = _Search(section, meshing, first, comm, listener, executor)
        # All answers; those that do not depend on each other are computed concurrently.
        adapted, safety = None, None
        try:
            if is_associated(section.strata, settings.flow):
                if settings.direction != "both":
                    safety = search.begin_safety(settings)
                with accepting_no_answer():
                    adapted = search.on_meshes("critical Kh").critical(settings)
            if adapted is None:
                assessment = search.by_path(settings, safety)
            else:
                assessment = search.with_limit_loads(adapted, settings, safety)
        except UnstableError as error:
            raise search.fails(settings, error) from error
        except NoEquilibriumError as error:
            if section.uplift is None:
                raise
            raise NoEquilibriumError(f"{error.reason}: {section.uplift.description}", ADVICE_ON_UPLIFT) from error
        if section.water_pressure.rises_by_shaking and 0.0 in settings.safety_factor_at:
            one_way = settings.changed(direction=assessment.critical.direction)
            assessment = with_after_shaking(assessment, search.after_shaking.or_warning(one_way, 0.0, adapted))
        of_kh = [assessment.after_shaking] if assessment.after_shaking else assessment.safety
        below_one = [factor for factor in of_kh if factor.result.kh == 0.0 and _is_unsafe(factor.result.factor)]
        if adapted is not None and below_one:  # what little Kh there is, is the error of its mesh
            unstable = UnstableError("the section fails under its own weight")
            raise search.fails(settings, unstable, below_one[0])
        return replace(assessment, warnings=[*assessment.warnings, *of_uplift(section.uplift)])


def _collected(
    critical: CriticalResult,
    mesh: QuadMesh,
    path_mesh: QuadMesh,
    adapted: AdaptiveResult[LimitLoadResult] | None,
    opposite: AdaptiveResult[LimitLoadResult] | AdaptiveResult[CriticalResult] | None,
    compared: AdaptiveResult[LimitLoadResult] | None,
    safety: list[Safety],
) -> Assessment:
    """Collect all results, after the factors of safety that are still being computed.

    ``compared`` is the critical Kh for the same direction by the flow rule that ``critical`` does not have: Davis's
    estimate if ``critical`` has ψ = φ, otherwise ψ = φ.
    """
    outcomes = [future.result() for future in safety]
    factors = [future for future in outcomes if not isinstance(future, ResultWarning)]
    associated, davis = (None, compared) if critical.flow == "associated" else (compared, None)
    if davis is not None and any(f.result.kh == 0.0 and _is_unsafe(f.result.by_other_flow) for f in factors):
        davis = failing_by_itself(davis)
    warnings = warnings_of(critical, mesh, associated.result if associated else None)
    warnings += [future for future in outcomes if isinstance(future, ResultWarning)]
    return Assessment(critical, mesh, path_mesh, adapted, opposite, associated, davis, factors, warnings)


def with_after_shaking(assessment: Assessment, outcome: AdaptiveResult[SafetyFactor] | ResultWarning) -> Assessment:
    """Return an assessment with the factor of safety after shaking, or with the warning why there is none."""
    if isinstance(outcome, ResultWarning):
        return replace(assessment, warnings=[*assessment.warnings, outcome])
    davis = assessment.davis
    if davis is not None and _is_unsafe(outcome.result.by_other_flow):
        davis = failing_by_itself(davis)
    return replace(assessment, after_shaking=outcome, davis=davis)


def _is_unsafe(factor: float | None) -> bool:
    """Return whether a factor of safety shows that the ground fails."""
    return factor is not None and factor < 1.0 - SOLVER_ACCURACY


@dataclass(frozen=True)
class _Search:
    """Holds the section, mesh and settings that the searches of an assessment share, and runs these searches."""

    section: Section
    meshing: MeshSettings
    first_mesh: QuadMesh
    comm: Any
    listener: AssessmentListener
    executor: Executor

    def with_limit_loads(
        self, adapted: AdaptiveResult[LimitLoadResult], settings: FemSettings, safety: list[Safety] | None
    ) -> Assessment:
        """Return the critical Kh by the path, the other direction and the factors of safety, compared with limit loads.

        ``safety`` are the factors of safety that are already being computed, or None. Raises UnstableError.

        The equilibrium path is followed on the coarsest mesh that is adapted to the mechanism, while limit loads on the
        last mesh are still being computed: displacements and stresses below failure need no finer mesh, and an
        iteration takes as long as one of the limit load. The critical Kh and its mechanism are those of the last mesh.
        """
        one_way = settings.changed(direction=adapted.result.direction)
        safety = self.begin_safety(one_way, adapted) if safety is None else safety
        limits = self.executor.submit(partial(self.limit_loads_by_both_rules, adapted, one_way))
        third = self.executor.submit(lambda: self.by_own_dilation(*limits.result(), one_way))
        reduced = element_for(self.section, one_way) == "reduced"  # of the limit loads, whose ground the path takes on
        listener = self.path_listener("Kh")
        follow = partial(critical_coefficient, self.section, settings=one_way, comm=self.comm, listener=listener)
        if reduced:
            mesh, ground = path_start(adapted, settings.kh)
            critical = follow(mesh=mesh, ground=ground)
            better, other = limits.result()
            of_path, critical = critical.kc, critical.at_limit_load(better.result)
            no_failure = critical.limit_mechanism is None and better.mesh is not mesh  # up to kh_limit on this mesh
            low, high = sorted((of_path, critical.kc))
            if no_failure or any(low < kh <= high for kh in settings.kh):  # that stands on one of both meshes alone
                mesh = better.mesh
                critical = follow(mesh=mesh, ground=better.result.ground)
        else:
            critical = follow(mesh=adapted.mesh)
            better, other = limits.result()
            if better.mesh is not adapted.mesh:  # whose limit load is smaller, which is rare
                critical = follow(mesh=better.mesh)
            mesh = better.mesh
        assessment = _collected(critical, better.mesh, mesh, better, better.opposite, other, safety)
        return replace(assessment, own_dilation=third.result())

    def by_path(self, settings: FemSettings, safety: list[Safety] | None) -> Assessment:
        """Return the results from equilibrium paths alone; raise UnstableError."""
        mesh, other_flow = self.first_mesh, None
        critical = critical_coefficient(self.section, mesh, settings, self.comm, self.path_listener("Kh"))
        one_way = settings.changed(direction=critical.direction)
        opposite = AdaptiveResult(critical.opposite, mesh) if critical.opposite is not None else None
        if not is_dilating_fully(self.section.strata):
            other_flow = self.by_other_flow(one_way)
        safety = self.begin_safety(one_way) if safety is None else safety
        return _collected(critical, mesh, mesh, None, opposite, other_flow, safety)

    def begin_safety(self, settings: FemSettings, like: AdaptiveResult[LimitLoadResult] | None = None) -> list[Safety]:
        """Start the searches for the factors of safety at the Kh of the settings, on meshes ``like`` those of the
        critical Kh if it is known."""
        return [self.executor.submit(partial(self.or_warning, settings, kh, like)) for kh in settings.safety_factor_at]

    def path_listener(self, what: str) -> Callable[[EquilibriumPath], None]:
        """Return a listener to the progress of a path."""
        return lambda path: self.tell(what, path)

    def is_substituted(self, settings: FemSettings) -> bool:
        """Return whether flow rule and strength differ from those of ψ = φ."""
        return settings.flow != "associated" and not is_dilating_fully(self.section.strata)

    def dilates_more(self, settings: FemSettings) -> bool:
        """Return whether the flow rule has a larger dilation angle than the section file (0 if the file gives none)."""
        return settings.flow == "associated" and not is_dilating_fully(self.section.strata)

    def limit_loads_by_both_rules(
        self, adapted: AdaptiveResult[LimitLoadResult], settings: FemSettings
    ) -> tuple[AdaptiveResult[LimitLoadResult], AdaptiveResult[LimitLoadResult] | None]:
        """Return the limit loads ``adapted``, and the limit loads by the other flow rule: ψ = φ, or Davis's estimate if
        the flow rule is ψ = φ. The limit load by the other flow rule is None if it was not found, or if the section
        file has ψ = φ in all strata.
        """
        with accepting_no_answer():
            if self.dilates_more(settings):
                return self.on_meshes("Kh by Davis's estimate").with_davis(adapted, settings)
            if self.is_substituted(settings):
                return self.on_meshes("Kh with ψ = φ").with_full_dilation(adapted, settings)
        return adapted, None

    def by_own_dilation(
        self,
        adapted: AdaptiveResult[LimitLoadResult],
        other: AdaptiveResult[LimitLoadResult] | None,
        settings: FemSettings,
    ) -> OwnDilation | None:
        """Return the critical Kh for the ψ of the strata if the settings ask for it, and if it differs from ``adapted``
        and from the limit load by the ``other`` flow rule; otherwise None.
        """
        if other is None or self.comm.size > 1 or not settings.own_dilation:
            return None
        full = adapted if settings.flow == "associated" else other
        self.tell("Kh for the dilation angles of the strata", None)
        return own_dilation(self.section, settings, full.result)

    def by_other_flow(self, settings: FemSettings) -> AdaptiveResult[LimitLoadResult] | None:
        """Return the limit load by the other flow rule, if the flow rule of the settings has only an equilibrium path;
        None if Davis's estimate has no answer.
        """
        if not self.dilates_more(settings):
            return self.on_meshes("Kh with ψ = φ").critical(settings.changed(flow="associated"))
        try:
            return self.on_meshes("Kh by Davis's estimate").critical(settings.changed(flow="davis"))
        except NoAnswerError:
            return None

    def on_meshes(self, what: str = "") -> AdaptiveSearch:
        """Return a search on adapted meshes. The messages of the search begin with ``what``, the name of the searched
        quantity."""

        def prefixed(words: str) -> None:
            self.tell(f"{what}: {words}" if what else words, None)

        return AdaptiveSearch(self.section, self.meshing, self.first_mesh, self.comm, prefixed, self.executor)

    def safety(
        self, settings: FemSettings, kh: float, like: AdaptiveResult[LimitLoadResult] | None = None
    ) -> AdaptiveResult[SafetyFactor]:
        """Return the factor of safety on adapted meshes, or on the first mesh if the flow is not associated. Meshes
        begin ``like`` those of the critical Kh if it is known."""
        if is_associated(self.section.strata, settings.flow):
            with accepting_no_answer():
                return self.with_other_factor(self.on_meshes().safety(settings, kh, like), settings, kh)
        result = safety_factor(
            self.section, self.first_mesh, settings, kh, self.comm, self.path_listener("factor of safety")
        )
        return AdaptiveResult(result, self.first_mesh)

    def with_other_factor(
        self, adapted: AdaptiveResult[SafetyFactor], settings: FemSettings, kh: float
    ) -> AdaptiveResult[SafetyFactor]:
        """Return the factor of safety by the chosen flow rule, and by the other flow rule if both apply."""
        if is_dilating_fully(self.section.strata):
            return adapted
        other = settings.changed(flow="davis" if settings.flow == "associated" else "associated")
        self.tell(f"factor of safety at Kh = {kh:g} {by(self.section.strata, other.flow)}", None)
        try:
            other_factor = self.on_meshes().safety_by_other_rule(adapted, other, kh)
        except UnstableError:  # Davis's strength has a largest value, however small the factor is
            other_factor = 0.0
        except NoAnswerError:
            return adapted
        return replace(adapted, result=replace(adapted.result, by_other_flow=other_factor))

    def fails(
        self, settings: FemSettings, error: UnstableError, known: AdaptiveResult[SafetyFactor] | None = None
    ) -> UnstableError:
        """Return the ``error`` with the factor of safety in its message, by both flow rules if ψ < φ, and the place
        where the ground slips. If pore pressure exceeds the weight above it, the message has the factor of safety
        against uplift instead. ``known`` is the factor of safety if it is already computed: after shaking if the
        ground has excess pore pressure.
        """
        if self.section.uplift is not None:
            described = self.section.uplift.description in error.reason
            return error if described else uplift_error(self.section.uplift, error.reason)
        rises = self.section.water_pressure.rises_by_shaking
        before = self.safety(settings, 0.0) if rises or known is None else known
        after = None
        if rises and before.result.factor > 1.0:
            search = self.after_shaking  # a path would look for minutes for the equilibrium of ground that flows
            find = search.on_meshes().safety if is_associated(self.section.strata, settings.flow) else search.safety
            with suppress(NoAnswerError):
                after = (known or find(settings, 0.0)).result.factor

        def full() -> float:
            return self.safety(settings.changed(flow="associated"), 0.0).result.factor

        return with_factors(self.section, settings, error, before, after, full)

    @property
    def after_shaking(self) -> "_Search":
        """Return the search in the ground at rest with the excess pore pressure that shaking leaves behind."""
        return replace(self, section=self.section.after_shaking())

    def or_warning(
        self, settings: FemSettings, kh: float, like: AdaptiveResult[LimitLoadResult] | None = None
    ) -> AdaptiveResult[SafetyFactor] | ResultWarning:
        """Return the factor of safety at ``kh`` as ``safety`` does, or a warning with the reason why it could not be
        computed."""
        try:
            return self.safety(settings, kh, like)
        except NoAnswerError as error:
            warning = f"There is no factor of safety at Kh = {kh:g}: {error}."
            return ResultWarning(warning, "use a smaller Kh", False)

    def tell(self, what: str, path: EquilibriumPath | None) -> None:
        """Report progress to the listener; raise an error if the task was cancelled."""
        check_cancelled()
        self.listener(what, path)
