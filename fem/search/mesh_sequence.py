"""Makes a sequence of meshes adapted to the mechanism, until the discretisation error of the answer is small.

Plastic shear is concentrated in a band that is as narrow as the cells allow. The error of the answer is proportional to
the width of the band, which halves when the number of cells along it is doubled: error ~ 1 / cells. Two meshes give the
remaining error of the last one (Richardson 1911).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

import numpy as np

from fem.continuum.fields import FieldState, touched_sides
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh
from meshes.quality import areas

# The first mesh adapted to a mechanism has as many cells as the mesh before; every later mesh has this multiple. The
# change of the answer by a better distribution of cells says nothing about the change by more cells.
CELL_RATIO = 2.0
# Smallest multiple, if the number of cells is limited; also the multiple of the first mesh after one that was adapted
# to a similar mechanism.
SMALLEST_CELL_RATIO = 1.25
# Smallest number of cells of an adapted mesh; fewer cannot resolve a shear band.
FEWEST_CELLS = 500
# Meshes whose numbers of cells differ by less than this share are too similar to extrapolate from.
SMALLEST_CELL_GAIN = 0.25
# A finer mesh normally has a smaller limit load. If it is larger, the estimated error is multiplied by this number.
RISE_RATIO = 3.0
# Number of meshes with the largest number of cells: a second one may be better adapted to the mechanism.
MOST_LARGEST_MESHES = 2
# A change is reported as a share of kc, or of this Kh where kc is smaller.
SMALLEST_KH = 0.05
# Error that is assumed when the search decides whether a direction can govern: of a first mesh, as a share of kc; of
# later meshes, as a multiple of the error estimated from two meshes.
FIRST_ERROR_SHARE, LATER_ERROR_RATIO = 0.3, 2.0
# Least error of a mesh of N cells, as a share of the critical Kh: this number over N. Meshes whose answers agree by
# chance have at least this error, by strict bounds of sections with a thin weak seam.
LEAST_ERROR_CELLS = 9.0
# Ratio of cell sizes in two shear bands up to which the errors of both meshes are comparable.
SIMILAR_SIZE_RATIO = 1.25


@dataclass(frozen=True)
class MeshRound:
    """Holds the critical Kh, or factor of safety, on one mesh of the sequence, with its estimated error.

    Attributes
    ----------
    cells : number of quadrilaterals
    value : critical Kh, or factor of safety, on this mesh (-)
    change : difference from the mesh before as a share of ``value``; infinite for the first mesh
    remaining_error : estimated remaining error as a share of ``value``, from this mesh and the previous mesh; infinite
        for the first mesh
    meaningful : whether the estimate of the error is meaningful; it is not if ``value`` rose on a mesh with about as
        many cells as before
    """

    cells: int
    value: float
    change: float
    remaining_error: float
    meaningful: bool = True


class MeshResult(Protocol):
    """Holds the result on a mesh: a number, its mechanism, and the reason if there is no answer."""

    @property
    def value(self) -> float: ...

    @property
    def mechanism(self) -> FieldState | None: ...

    @property
    def reason(self) -> str: ...


F = TypeVar("F", bound=MeshResult)


@dataclass(frozen=True, eq=False)
class AdaptiveResult(Generic[F]):
    """Holds the answer on the last mesh, and the sequence that led to it.

    Attributes
    ----------
    result : answer and mechanism on ``mesh``
    mesh : the last mesh
    rounds : the sequence, coarsest first
    converged : whether the remaining error is within the required accuracy
    reason : reason why there was no further mesh
    opposite : the result for the opposite direction, where both directions were analysed
    earlier : the answers on those earlier meshes of the sequence that are adapted to a mechanism, coarsest first
    """

    result: F
    mesh: QuadMesh
    rounds: list[MeshRound] = field(default_factory=list)
    converged: bool = False
    reason: str = ""
    opposite: "AdaptiveResult[F] | None" = None
    earlier: "list[AdaptiveResult[F]]" = field(default_factory=list)

    @property
    def limit(self) -> float:
        """Return the limit of the sequence if the error is proportional to one over the number of cells (-), at least
        the remaining error of the last mesh below the value of this mesh if the value fell; NaN after one mesh.
        """
        if len(self.rounds) < 2:
            return math.nan
        before, last = self.rounds[-2:]
        error = remaining_error(before, last.cells, last.value)
        possible = last.remaining_error * max(abs(last.value), SMALLEST_KH)
        return last.value - (max(error, possible) if error >= 0.0 else error)

    @property
    def at_sides(self) -> tuple[str, ...]:
        """Return the sides of the section, "left" and "right", that the mechanism reaches."""
        return () if self.result.mechanism is None else touched_sides(self.mesh, self.result.mechanism)

    def resolves(self, other: FieldState) -> bool:
        """Return whether the cells of ``mesh`` are as small along another mechanism as along the mechanism of
        ``mesh``; True for a mesh that is adapted to no mechanism."""
        return len(self.rounds) < 2 or self.is_as_fine_along(other)

    def is_as_fine_along(self, other: FieldState) -> bool:
        """Return whether the cells of ``mesh`` are as small along another mechanism as along the mechanism of
        ``mesh``."""
        mechanism = self.result.mechanism
        return mechanism is not None and self._band(other) <= SIMILAR_SIZE_RATIO * self._band(mechanism)

    def _band(self, mechanism: FieldState) -> float:
        """Return the mean size (m) of the cells, weighted by the shear displacement of a mechanism across them."""
        area = areas(self.mesh.points, self.mesh.cells)
        shear = area * mechanism.plastic_shear_strain
        return float(shear @ np.sqrt(area)) / max(float(shear.sum()), 1e-300)


def remaining_error(before: MeshRound, cells: int, value: float) -> float:
    """Return the discretisation error of ``value`` (-) on a mesh of ``cells``, extrapolated from the mesh
    ``before``."""
    return (before.value - value) / max(cells / before.cells - 1.0, SMALLEST_CELL_GAIN)


def no_other_kh() -> float:
    """Return infinity, as the Kh of a direction that is not analysed."""
    return math.inf


@dataclass(frozen=True)
class RefinementCriteria:
    """Holds the criteria that end the sequence of meshes.

    Attributes
    ----------
    accuracy : largest remaining error, as a share of the answer (-)
    max_cells : cells of the finest mesh
    opposite_kh : function that returns the Kh (-) of the other direction; the sequence ends once this direction
        certainly has a larger critical Kh
    smallest_answer : answer (-) below which ``accuracy`` is a share of this constant instead of the answer
    least_error_cells : least remaining error of a mesh as a share of the answer, times its number of cells (-)
    """

    accuracy: float
    max_cells: int
    opposite_kh: Callable[[], float] = no_other_kh
    smallest_answer: float = 0.0
    least_error_cells: float = LEAST_ERROR_CELLS

    def is_met(self, last: MeshRound) -> bool:
        """Return whether the remaining error of a mesh is within the accuracy."""
        size = max(abs(last.value), SMALLEST_KH)
        return last.meaningful and last.remaining_error * size <= self.accuracy * max(size, self.smallest_answer)


class MeshSequence(Generic[F]):
    """Makes meshes one after the other for an answer, until the remaining error is within the accuracy, the largest
    number of cells is reached, or a mesh has no answer; then the last answer counts.

    Parameters
    ----------
    first : the first mesh
    wish : accuracy and largest number of cells
    fits : function that returns whether the first mesh is adapted to a mechanism; without it the first mesh is adapted
        to none
    first_error : function of the answer on the first mesh that returns the least error expected there, as a share of
        the answer (-); it falls with the number of cells, and two meshes whose answers agree by chance have at least
        what remains of it

    Attributes
    ----------
    mesh : QuadMesh or None
        The mesh on which the next answer is to be computed, for `take`; None at the end.
    """

    def __init__(
        self,
        first: QuadMesh,
        wish: RefinementCriteria,
        fits: Callable[[FieldState], bool] | None = None,
        first_error: Callable[[float], float] | None = None,
    ) -> None:
        self.mesh: QuadMesh | None = first
        self._first_error = first_error
        self._wish, self._rounds = wish, list[MeshRound]()
        self._fits, self._is_adapted, self._earlier = fits, False, list[AdaptiveResult[F]]()
        self._last: tuple[F, QuadMesh] | None = None
        self._reason, self._largest = "", 0

    def take(self, answer: F | NoAnswerError, remade: Callable[[QuadMesh, np.ndarray, int], QuadMesh]) -> None:
        """Store the answer on the mesh, or the reason if it has none, and make the next mesh if one is needed.

        ``remade`` makes the next mesh from a mesh, the plastic shear strain of its answer, and a number of cells. Every
        rank makes the same mesh. Raises the error of the first mesh.
        """
        mesh, self.mesh = self.mesh, None
        assert mesh is not None
        if isinstance(answer, NoAnswerError):
            return self._end(answer)
        if self._rounds and answer.mechanism is None:
            return self._end(NoAnswerError(answer.reason, ""))
        if self._last is not None and self._is_adapted:
            self._earlier.append(AdaptiveResult(*self._last))
        self._last = answer, mesh
        self._rounds.append(self._round(answer.value, len(mesh.cells)))
        mechanism = answer.mechanism
        self._is_adapted = len(self._rounds) > 1 or (
            self._fits is not None and mechanism is not None and self._fits(mechanism)
        )
        cells = len(mesh.cells)
        cell_ratio = CELL_RATIO if len(self._rounds) > 1 else SMALLEST_CELL_RATIO if self._is_adapted else 1.0
        requested_cells = max(math.ceil(cell_ratio * cells), FEWEST_CELLS)
        if (
            requested_cells > self._wish.max_cells >= SMALLEST_CELL_RATIO * cells
            and self._largest < MOST_LARGEST_MESHES
        ):
            requested_cells, self._largest = self._wish.max_cells, self._largest + 1
        self._reason = _reason_to_stop(self._rounds, answer, requested_cells, self._wish)
        if not self._reason:
            assert answer.mechanism is not None
            try:
                self.mesh = remade(mesh, answer.mechanism.plastic_shear_strain, requested_cells)
            except NoAnswerError as error:
                self._end(error)
        return None

    @property
    def result(self) -> AdaptiveResult[F]:
        """Return the last answer, and the sequence that led to it."""
        assert self._last is not None
        return AdaptiveResult(
            *self._last, self._rounds, self._wish.is_met(self._rounds[-1]), self._reason, earlier=self._earlier
        )

    def _end(self, error: NoAnswerError) -> None:
        if self._last is None:
            raise error
        self._reason = f"there is no answer on the next mesh: {error}"

    def _round(self, value: float, cells: int) -> MeshRound:
        """Return the value on a mesh of the sequence, its difference from the mesh before, and its remaining error."""
        if not self._rounds:
            return MeshRound(cells, value, math.inf, math.inf)
        previous, size = self._rounds[-1], max(abs(value), SMALLEST_KH)
        error = remaining_error(previous, cells, value)
        rest = (error if error >= 0.0 else -RISE_RATIO * error) / size
        if value > min(mesh.value for mesh in self._rounds) and math.isfinite(previous.remaining_error):
            # After a rise, an answer that stays above an earlier one has at least the error of before, on more cells.
            rest = max(rest, previous.remaining_error * previous.cells / cells)
        rest = max(rest, self._wish.least_error_cells / cells)
        if self._first_error is not None:
            first = self._rounds[0]
            rest = max(rest, self._first_error(first.value) * first.cells / cells)
        reliable = self._is_adapted and (error >= 0.0 or cells >= (1.0 + SMALLEST_CELL_GAIN) * previous.cells)
        return MeshRound(cells, value, abs(value - previous.value) / size, rest, reliable)


def _reason_to_stop(rounds: list[MeshRound], result: MeshResult, wanted: int, wish: RefinementCriteria) -> str:
    """Return the reason why no further mesh of ``wanted`` cells is made; empty if one is made."""
    last = rounds[-1]
    if wish.is_met(last):
        return (
            f"the last refinement changed the result by {100 * last.change:.1f} %, and the remaining error is about "
            f"{100 * last.remaining_error:.1f} %"
        )
    if result.mechanism is None:
        return f"there is no mechanism to refine: {result.reason}"
    rest = min(FIRST_ERROR_SHARE, LATER_ERROR_RATIO * last.remaining_error)
    if last.value * (1.0 - rest) > wish.opposite_kh():
        return "the other direction governs"
    if wanted > wish.max_cells:
        return f"the next mesh would have {wanted} cells, {wish.max_cells} are allowed"
    return ""
