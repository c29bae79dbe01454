"""Finds the critical seismic coefficient, and factors of safety, on meshes that are adapted to the mechanism.

On each mesh of the sequence (``mesh_sequence.py``) the limit load follows from limit analysis
(``conic_limit_load.py``), in a tenth of the time of a path.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from fem.continuum.face_reinforcement import strengthened, without_strips
from fem.continuum.loads import Direction, counting_directions
from fem.continuum.shallow_failure import ShallowFailure, faces_at
from fem.continuum.strength import is_associated
from fem.errors import UnstableError
from fem.limit_load.limit_load import LimitLoadResult, LoadedGround, critical_limit_load, in_order, with_other_flow
from fem.search.factor_estimates import factor_error, factor_like
from fem.search.mesh_sequence import (
    FEWEST_CELLS,
    LEAST_ERROR_CELLS,
    SMALLEST_KH,
    AdaptiveResult,
    MeshRound,
    MeshSequence,
    RefinementCriteria,
    no_other_kh,
)
from fem.search.strength_reduction import SafetyFactor, limit_load_safety_factor
from fem.settings import FACTOR_SHARE, LEAST_KH, FemSettings
from meshes.adaptation import adapted
from meshes.errors import InputError, NoAnswerError
from meshes.executor import SERIAL, Executor
from meshes.gmsh_model import generate
from meshes.quad_mesh import QuadMesh
from meshes.quality import areas
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.strips import with_finer_strips

# A first mesh of more than this multiple of ``FEWEST_CELLS`` is preceded by a mesh of ``FEWEST_CELLS``, which provides
# the first guess.
MANY_CELLS_RATIO = 4
# Why there is no critical Kh above 0.
FAILS_BY_ITSELF = "the ground fails under its own weight"


def next_mesh(
    section: Section,
    meshing: MeshSettings,
    mesh: QuadMesh,
    strain: np.ndarray,
    cells: int,
    strong: Section | None = None,
    repeats: bool = False,
) -> QuadMesh:
    """Make a mesh of about ``cells`` cells that is refined along a mechanism; ``strain`` (len(mesh.cells),) is the
    plastic shear strain of the mechanism.

    If the setting is a mapped mesh, columns and rows are added where the mechanism is; else the mesh is free. Cell
    sizes follow the shear displacement across the cells of the last mesh. Along a shear band this displacement does not
    depend on the width of the cells, while shear strains would concentrate all new cells where cells are narrowest.
    Cell sizes also follow the strips of the ``strong`` section, whose cohesionless faces are strengthened: a cell with
    half of its points in a strip would be neither strengthened nor unchanged. Both sides of a periodic section
    (``repeats``) get corresponding points. Raises the errors of ``adapted``. ``section``: the section of the ground;
    ``meshing``: settings of the meshes; ``mesh``: the last mesh.
    """
    if meshing.method == "mapped":
        return with_finer_strips(mesh, strain, cells)
    moved = strain * np.sqrt(areas(mesh.points, mesh.cells))
    if strong is None:
        return adapted(section, meshing, mesh, moved, cells, repeats=repeats)
    return without_strips(adapted(strong, meshing, mesh, moved, cells, repeats=repeats), section)


def first_adapted(like: AdaptiveResult[LimitLoadResult]) -> AdaptiveResult[LimitLoadResult] | None:
    """Return the first result in the sequence ``like`` on a mesh that is adapted to a mechanism; None if there is no
    such mesh.
    """
    first = next(iter([*like.earlier, *([like] if len(like.rounds) > 1 else [])]), None)
    return first if first is not None and first.result.mechanism is not None else None


def strengthens(result: LimitLoadResult, faces: Sequence[ShallowFailure]) -> bool:
    """Return whether the ground of a ``result`` is strengthened below the same faces as ``faces``."""
    strong, wanted = ({(face.stratum, face.start, face.end) for face in part} for part in (result.ground.faces, faces))
    return strong == wanted


def _ignore(_: str) -> None:
    """Ignore messages."""


@dataclass(frozen=True)
class AdaptiveSearch:
    """Searches critical Kh and factors of safety of a section, on meshes adapted to the mechanism.

    Attributes
    ----------
    section : the ground
    meshing : settings of the meshes
    first_mesh : the first mesh; the only mesh if meshes are not adapted
    comm : MPI communicator of the ranks; by default this process alone
    tell : function that is called with a message before each step
    executor : executor that computes both directions concurrently
    """

    section: Section
    meshing: MeshSettings
    first_mesh: QuadMesh
    comm: Any = None
    tell: Callable[[str], None] = _ignore
    executor: Executor = SERIAL

    def critical(self, settings: FemSettings) -> AdaptiveResult[LimitLoadResult]:
        """Find the critical Kh, in the direction in which it is smaller.

        Mechanisms that leave the section through a side count as in `counting_directions`. Raises the errors of
        ``critical_limit_load`` on the first mesh.
        """
        if settings.direction != "both":
            return self._towards(settings.direction, settings, no_other_kh)
        downhill = self.executor.submit(self._towards, "downhill", settings, no_other_kh)
        try:
            uphill_result = self._towards("uphill", settings, lambda: downhill.result().result.kc)
        except NoAnswerError:
            downhill.result()  # its error is raised first
            raise
        downhill_result = downhill.result()
        counting = counting_directions(
            self.section, settings.sides, {"downhill": downhill_result.at_sides, "uphill": uphill_result.at_sides}
        )
        if "downhill" not in counting:
            # Its meshes ended where the other direction was taken to govern.
            if uphill_result.result.kc > downhill_result.result.kc:
                uphill_result = self._towards("uphill", settings, no_other_kh)
            return replace(uphill_result, opposite=downhill_result)
        if "uphill" in counting and uphill_result.result.kc < downhill_result.result.kc:
            return replace(uphill_result, opposite=downhill_result)
        return replace(downhill_result, opposite=uphill_result)

    def _towards(
        self, direction: Direction, settings: FemSettings, other: Callable[[], float]
    ) -> AdaptiveResult[LimitLoadResult]:
        one_way = settings.changed(direction=direction)
        faces = self._rough_faces(one_way)
        request = RefinementCriteria(settings.accuracy, self._most_cells(settings), other, LEAST_KH)
        sequence = MeshSequence[LimitLoadResult](self.first_mesh, request)
        while (mesh := sequence.mesh) is not None:
            force = "downslope" if direction == "downhill" else "upslope"
            self.tell(f"mesh of {len(mesh.cells)} cells, seismic force {force}")
            answer: LimitLoadResult | NoAnswerError
            try:
                answer = critical_limit_load(self.section, mesh, one_way, self.comm, faces)
                faces = answer.ground.faces
            except NoAnswerError as error:
                answer = error
            sequence.take(answer, partial(self._next, faces=faces or (), settings=one_way))
        return sequence.result

    def _next(
        self, mesh: QuadMesh, strain: np.ndarray, cells: int, faces: Sequence[ShallowFailure], settings: FemSettings
    ) -> QuadMesh:
        """Return the mesh of `next_mesh` for ground that is strengthened below ``faces``."""
        strong = strengthened(self.section, faces, settings) if faces else None
        repeats = settings.sides == "periodic"
        return next_mesh(self.section, self.meshing, mesh, strain, cells, strong, repeats)

    def _most_cells(self, settings: FemSettings) -> int:
        """Return the largest number of cells; 0 if meshes are not adapted: if the settings require no accuracy, if the
        flow is not associated, so that the limit load is not unique, or if columns and rows or the mesh itself are
        given.
        """
        chosen = self.meshing.columns or self.meshing.rows or self.first_mesh.method == "given"
        unique = is_associated(self.section.strata, settings.flow)
        return settings.max_cells if settings.accuracy > 0.0 and not chosen and unique else 0

    def by_other_rule(
        self, base: AdaptiveResult[LimitLoadResult], other: FemSettings
    ) -> AdaptiveResult[LimitLoadResult]:
        """Find the limit load with ``other`` settings under the same forces, on the mesh of ``base``.

        Where the mesh of ``base`` does not resolve the mechanism, another mesh with as many cells is made that resolves
        it. The smaller limit load counts, and both are in the sequence of meshes. Raises NoAnswerError if the solver
        has no answer on the mesh of ``base``.
        """
        self.tell(f"mesh of {len(base.mesh.cells)} cells")
        limit_load = with_other_flow(base.result, self.section, base.mesh, other)
        first = AdaptiveResult(
            limit_load, base.mesh, [MeshRound(len(base.mesh.cells), limit_load.kc, math.inf, math.inf)]
        )
        if limit_load.mechanism is None or base.resolves(limit_load.mechanism):
            return first
        faces, strain = base.result.ground.faces, limit_load.mechanism.plastic_shear_strain
        try:
            mesh = self._next(base.mesh, strain, len(base.mesh.cells), faces, other)
            self.tell(f"mesh of {len(mesh.cells)} cells")
            separate = critical_limit_load(self.section, mesh, other, self.comm, faces)
        except NoAnswerError:
            return first
        if separate.kc > limit_load.kc:
            return first
        change = (limit_load.kc - separate.kc) / max(separate.kc, SMALLEST_KH)
        return AdaptiveResult(separate, mesh, [*first.rounds, MeshRound(len(mesh.cells), separate.kc, change, change)])

    def with_full_dilation(
        self, base: AdaptiveResult[LimitLoadResult], settings: FemSettings
    ) -> tuple[AdaptiveResult[LimitLoadResult], AdaptiveResult[LimitLoadResult]]:
        """Return ``base``, and the answer with ψ = φ for comparison.

        On one mesh the limit load by Davis's estimate is not above the limit load with ψ = φ. Where the limit load on
        the mesh for ψ = φ is below that of ``base``, the mesh of ``base`` is poorer, and its limit load is computed
        again on the other mesh. Raises the errors of `by_other_rule`.
        """
        full = settings.changed(flow="associated")
        compared = self.by_other_rule(base, full)
        if compared.mesh is base.mesh:
            return ordered(base, compared)
        if compared.result.kc >= base.result.kc:
            return base, compared
        recomputed = critical_limit_load(self.section, compared.mesh, settings, self.comm, base.result.ground.faces)
        last = replace(base.rounds[-1], cells=len(compared.mesh.cells), value=recomputed.kc)
        by_full_rule = with_other_flow(recomputed, self.section, compared.mesh, full)
        return ordered(
            replace(base, result=recomputed, mesh=compared.mesh, rounds=[*base.rounds[:-1], last]),
            replace(compared, result=by_full_rule),
        )

    def with_davis(
        self, base: AdaptiveResult[LimitLoadResult], settings: FemSettings
    ) -> tuple[AdaptiveResult[LimitLoadResult], AdaptiveResult[LimitLoadResult]]:
        """Return ``base``, whose flow has ψ = φ, and Davis's estimate of the critical Kh for comparison; 0 if such
        ground fails without a seismic force.

        On the mesh of ``base`` the estimate is not above ``base``. Raises the errors of `by_other_rule` except
        UnstableError.
        """
        try:
            compared = self.by_other_rule(base, settings.changed(flow="davis"))
        except UnstableError:
            compared = replace(base, result=replace(base.result, kc=-1.0, flow="davis"), opposite=None)
        if compared.result.kc <= 0.0:
            return base, failing_by_itself(compared)
        if compared.mesh is base.mesh:
            compared, base = ordered(compared, base)
        return base, compared

    def safety(
        self, settings: FemSettings, kh: float, like: AdaptiveResult[LimitLoadResult] | None = None
    ) -> AdaptiveResult[SafetyFactor]:
        """Find the factor of safety at ``kh``; raise the errors of ``limit_load_safety_factor`` on the first mesh.

        Where the critical Kh was computed (``like``), the first mesh is the first one that was adapted to its
        mechanism, unless this mesh follows the strips below other strengthened faces. The initial guess follows from
        the same mechanism.
        """
        faces = faces_at(self.section, settings, kh)
        known = first_adapted(like) if like is not None else None
        guess = self._rough_safety(settings, kh) if known is None else factor_like(known, kh)
        similar = known if known is not None and strengthens(known.result, faces) else None
        remade = partial(self._next, faces=faces, settings=settings)
        request = RefinementCriteria(
            FACTOR_SHARE * settings.accuracy,
            self._most_cells(settings),
            least_error_cells=FACTOR_SHARE * LEAST_ERROR_CELLS,
        )
        first, fits = (self.first_mesh, None) if similar is None else (similar.mesh, similar.is_as_fine_along)
        expected = None if like is None or similar is None else partial(factor_error, like, similar, kh)
        sequence = MeshSequence[SafetyFactor](first, request, fits, expected)
        while (mesh := sequence.mesh) is not None:
            self.tell(f"factor of safety at Kh = {kh:g}: {len(mesh.cells)} cells")
            answer: SafetyFactor | NoAnswerError
            try:
                answer = limit_load_safety_factor(self.section, mesh, settings, kh, self.comm, guess)
                guess = answer.factor
            except NoAnswerError as error:
                answer = error
            sequence.take(answer, remade)
        return sequence.result

    def safety_by_other_rule(self, base: AdaptiveResult[SafetyFactor], other: FemSettings, kh: float) -> float:
        """Find the factor of safety by the flow rule of ``other`` settings: the factor of ``base`` times the ratio of
        both factors on one mesh, in which errors of the mesh cancel. The ratio is computed on the mesh before the last
        one if the sequence of ``base`` converged, else on the last mesh; for ground that fails by itself, whose factor
        is reported to two digits, on the coarsest mesh that is adapted to its mechanism. If the mesh does not resolve
        the mechanism, another mesh with as many cells is made that resolves it, and the smaller factor counts. Davis's
        estimate is not above the factor with ψ = φ, since ground of higher strength resists every load that weaker
        ground resists.

        Raises the errors of ``limit_load_safety_factor``.
        """
        shared = base.earlier[-1] if base.converged and base.earlier else base
        if base.result.factor < 1.0 and base.earlier:
            shared = base.earlier[0]
        same = limit_load_safety_factor(
            self.section, shared.mesh, other, kh, self.comm, shared.result.factor, shared.result.start
        )
        factor, adapts = same.factor, len(base.rounds) > 1
        if adapts and same.mechanism is not None and not shared.is_as_fine_along(same.mechanism):
            strain = same.mechanism.plastic_shear_strain
            try:
                faces = faces_at(self.section, other, kh)
                mesh = self._next(shared.mesh, strain, len(shared.mesh.cells), faces, other)
                factor = min(factor, limit_load_safety_factor(self.section, mesh, other, kh, self.comm, factor).factor)
            except NoAnswerError:
                pass
        factor *= base.result.factor / shared.result.factor
        return (max if other.flow == "associated" else min)(factor, base.result.factor)

    def _rough_faces(self, settings: FemSettings) -> list[ShallowFailure] | None:
        """Return the cohesionless faces to strengthen on a first mesh of many cells, determined on a coarse mesh.
        Return None if they have to be determined on the first mesh, by one more limit load.
        """
        rough_mesh = self._rough_mesh()
        try:
            return (
                critical_limit_load(self.section, rough_mesh, settings, self.comm).ground.faces if rough_mesh else None
            )
        except NoAnswerError:
            return None

    def _rough_safety(self, settings: FemSettings, kh: float) -> float:
        """Return the initial guess of the factor of safety: 1, or the factor on a coarse mesh if the first mesh is
        fine."""
        rough_mesh = self._rough_mesh()
        try:
            return (
                limit_load_safety_factor(self.section, rough_mesh, settings, kh, self.comm).factor
                if rough_mesh
                else 1.0
            )
        except NoAnswerError:
            return 1.0

    def _rough_mesh(self) -> QuadMesh | None:
        """Return a coarse mesh; None if the first mesh is coarse itself."""
        if len(self.first_mesh.cells) <= MANY_CELLS_RATIO * FEWEST_CELLS:
            return None
        size = math.sqrt(float(areas(self.first_mesh.points, self.first_mesh.cells).sum()) / FEWEST_CELLS)
        try:
            return generate(self.section, MeshSettings(size=size))
        except (NoAnswerError, InputError):
            return None


def path_start(
    adapted: AdaptiveResult[LimitLoadResult], requested_kh: Sequence[float] = ()
) -> tuple[QuadMesh, LoadedGround]:
    """Return the coarsest mesh that is adapted to the mechanism, and its ground, from which an equilibrium path starts.
    Its limit load, up to which the path is followed, is the smaller one of this mesh and the last mesh. Return the last
    mesh if the ground does not fail on both, or if it stands at a ``requested_kh`` on the last mesh alone.
    """
    first = adapted.earlier[0] if adapted.earlier else adapted
    limits = first.result.ground.limit, adapted.result.ground.limit
    if limits[0] is None or limits[1] is None or {first.result.verdict, adapted.result.verdict} != {"plateau"}:
        return adapted.mesh, adapted.result.ground
    if any(limits[0].multiplier < kh <= limits[1].multiplier for kh in requested_kh):
        return adapted.mesh, adapted.result.ground
    smaller = min(limit.multiplier for limit in limits if limit is not None)
    return first.mesh, replace(first.result.ground, limit=replace(limits[0], multiplier=smaller))


def ordered(
    weak: AdaptiveResult[LimitLoadResult], strong: AdaptiveResult[LimitLoadResult]
) -> tuple[AdaptiveResult[LimitLoadResult], AdaptiveResult[LimitLoadResult]]:
    """Return Davis's estimate and the limit load with ψ = φ on one mesh, corrected to their proven order
    (`in_order`)."""
    low, high = in_order(weak.result, strong.result)
    return _with_last(weak, low), _with_last(strong, high)


def _with_last(base: AdaptiveResult[LimitLoadResult], result: LimitLoadResult) -> AdaptiveResult[LimitLoadResult]:
    """Return the results of all meshes, in which the result on the last mesh is replaced by ``result``."""
    return replace(base, result=result, rounds=[*base.rounds[:-1], replace(base.rounds[-1], value=result.kc)])


def failing_by_itself(base: AdaptiveResult[LimitLoadResult]) -> AdaptiveResult[LimitLoadResult]:
    """Return the answer for ground that fails under its own weight: a critical Kh of 0."""
    result = replace(base.result, kc=0.0, verdict="plateau", reason=FAILS_BY_ITSELF, mechanism=None)
    return replace(base, result=result)
