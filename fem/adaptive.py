"""The critical seismic coefficient on meshes made anew for the mechanism, until it no longer changes.

Plastic shear goes through a band as narrow as the cells allow, and the coefficient is too large in proportion to the
width of that band, which halves when twice the cells are spent along it: error ~ 1 / cells. From two meshes follows
what the last one still has (Richardson 1911).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from fem.critical import CriticalResult, critical_coefficient
from fem.path import EquilibriumPath
from fem.settings import FemSettings
from fem.strength import is_dilating_fully
from meshes.adaptation import adapted
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from meshes.settings import MeshSettings

# The next mesh has this many times the cells of the last one.
MORE_CELLS = 1.5
# The first adapted mesh has at least this many: fewer cannot follow a band.
FEWEST_CELLS = 500
# Meshes whose numbers of cells differ by less than this share are too alike to tell a limit apart.
LEAST_GAIN = 0.25
# A change is told as a share of kc, or of this Kh where kc is smaller.
SMALLEST_KH = 0.02
# Verdicts of a path that did not come to a mechanism.
WITHOUT_MECHANISM = ("no failure", "undecided")


@dataclass(frozen=True)
class MeshRound:
    """One mesh of the sequence.

    Attributes
    ----------
    cells : int
        Number of quadrilaterals.
    kc : float
        Critical Kh on it (-).
    change : float
        Difference from the mesh before as a share of ``kc``; infinite for the first.
    """

    cells: int
    kc: float
    change: float


@dataclass(frozen=True, eq=False)
class AdaptiveResult:
    """The answer on the last mesh, and the sequence that led to it.

    Attributes
    ----------
    result : CriticalResult
        Answer and fields on ``mesh``.
    mesh : QuadMesh
        The last mesh.
    start : CriticalResult
        The answer on the first mesh, with that of the opposite direction if both were asked for.
    rounds : list of MeshRound
        The sequence, coarsest first.
    converged : bool
        Whether the last change is within the accuracy that was asked for.
    reason : str
        Why there was no further mesh.
    """

    result: CriticalResult
    mesh: QuadMesh
    start: CriticalResult
    rounds: list[MeshRound] = field(default_factory=list)
    converged: bool = False
    reason: str = ""

    @property
    def limit(self) -> float:
        """What the sequence tends to if the error goes with one over the number of cells (-); NaN after one mesh."""
        if len(self.rounds) < 2:
            return math.nan
        before, last = self.rounds[-2:]
        return last.kc - (before.kc - last.kc) / max(last.cells / before.cells - 1.0, LEAST_GAIN)


def mesh_for_mechanism(
    section: Section,
    meshing: MeshSettings,
    first: QuadMesh,
    settings: FemSettings,
    comm: Any,
    listener: Callable[[str, EquilibriumPath], None],
) -> AdaptiveResult | None:
    """The mesh on which the critical Kh no longer changes by more than ``settings.accuracy``, and the sequence to it.

    The side to which the ground fails is found on the first mesh. None where there is nothing to be done: no accuracy
    is asked for; the flow is not associated, whose answer no mesh makes unique; columns and rows, or the mesh itself,
    were given. Raises what ``critical_coefficient`` does.
    """
    chosen = meshing.method == "mapped" or meshing.columns or meshing.rows or first.method == "given"
    associated = settings.flow != "section" or is_dilating_fully(section.strata)
    if settings.accuracy == 0.0 or chosen or not associated:
        return None
    # No fields are kept on the way: what is asked for is past the end of every path.
    plain = settings.model_copy(update={"kh": (settings.kh_limit,)})

    def solve(mesh: QuadMesh) -> CriticalResult:
        nonlocal plain
        words = f"Kh on {len(mesh.cells)} cells"
        result = critical_coefficient(section, mesh, plain, comm, lambda path: listener(words, path))
        plain = plain.model_copy(update={"direction": result.direction})
        return result

    return solve_adaptively(section, meshing, first, solve, settings.accuracy, settings.max_cells)


def solve_adaptively(
    section: Section,
    settings: MeshSettings,
    first: QuadMesh,
    solve: Callable[[QuadMesh], CriticalResult],
    accuracy: float,
    max_cells: int,
    listener: Callable[[MeshRound], None] | None = None,
) -> AdaptiveResult:
    """Solve on ``first``, then on meshes adapted to the plastic shear strain of the last answer.

    Ends when the critical Kh changes by no more than ``accuracy`` of itself, when the next mesh would have more than
    ``max_cells`` cells, or when there is no answer on it; then the last answer counts. Every rank makes the same mesh.

    Raises what ``solve`` raises on the first mesh.
    """
    mesh, result = first, solve(first)
    start = result
    rounds: list[MeshRound] = []
    while True:
        change = math.inf
        if rounds:
            change = abs(result.kc - rounds[-1].kc) / max(abs(result.kc), SMALLEST_KH)
        rounds.append(MeshRound(len(mesh.cells), result.kc, change))
        if listener is not None:
            listener(rounds[-1])
        reason, converged = "", change <= accuracy
        wanted = max(math.ceil(MORE_CELLS * len(mesh.cells)), FEWEST_CELLS)
        if converged:
            reason = f"the last mesh changed it by {100 * change:.1f} %"
        elif result.verdict in WITHOUT_MECHANISM:
            reason = f"there is no mechanism to refine: {result.reason}"
        elif wanted > max_cells:
            reason = f"the next mesh would have {wanted} cells, {max_cells} are allowed"
        if not reason:
            try:
                finer = adapted(section, settings, mesh, result.mechanism.plastic_shear_strain, wanted)
                answer = solve(finer)
                if answer.verdict in WITHOUT_MECHANISM:
                    reason = f"there is no answer on the next mesh: {answer.reason}"
            except NoAnswerError as error:
                reason = f"there is no answer on the next mesh: {error}"
        if reason:
            return AdaptiveResult(result, mesh, start, rounds, converged, reason)
        mesh, result = finer, answer
