"""The critical seismic coefficient on meshes made anew for the mechanism, until hardly anything of their error is left.

Plastic shear goes through a band as narrow as the cells allow, and the coefficient is too large in proportion to the
width of that band, which halves when twice the cells are spent along it: error ~ 1 / cells. From two meshes follows
what the last one still has (Richardson 1911). On each the limit load is found at once (``fem/direct_limit.py``), which
takes a tenth of the time of a path.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from fem.at_once import AtOnce, asked_again, critical_at_once
from fem.fields import State, touched_sides
from fem.loads import Direction
from fem.settings import FemSettings
from fem.skin import Skin, faces_at, strengthened, without_strips
from fem.strength import is_dilating_fully
from fem.strength_reduction import SafetyFactor, safety_at_once
from meshes.adaptation import adapted
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh
from meshes.quality import areas
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.strips import with_finer_strips

# The next mesh has this many times the cells of the last one.
MORE_CELLS = 2.0
# or fewer, if these are as many as are allowed, but not fewer than so many times.
FEWER_CELLS = 1.25
# The first adapted mesh has at least this many: fewer cannot follow a band.
FEWEST_CELLS = 500
# Meshes whose numbers of cells differ by less than this share are too alike to tell a limit apart.
LEAST_GAIN = 0.25
# A finer mesh bears less. Where it bears more, cells of the one before were cut by something that these follow, and so
# many times what the two tell may be left.
RISEN = 3.0
# A change is told as a share of kc, or of this Kh where kc is smaller.
SMALLEST_KH = 0.05
# What may be left of the error, as a share of kc, where it is asked whether a direction can matter: that of a first
# mesh, and of later ones as a multiple of what two meshes tell.
FIRST_REST, REST_TIMES = 0.3, 2.0


@dataclass(frozen=True)
class MeshRound:
    """One mesh of the sequence.

    Attributes
    ----------
    cells : int
        Number of quadrilaterals.
    value : float
        Critical Kh, or factor of safety, on it (-).
    change : float
        Difference from the mesh before as a share of ``value``; infinite for the first.
    rest : float
        What is left of the error, as a share of ``value``, as far as this and the mesh before can tell; infinite for
        the first.
    """

    cells: int
    value: float
    change: float
    rest: float


class Found(Protocol):
    """What is found on a mesh: a number, its mechanism, and what there is to say of it."""

    @property
    def value(self) -> float: ...

    @property
    def mechanism(self) -> State | None: ...

    @property
    def reason(self) -> str: ...


F = TypeVar("F", bound=Found)


@dataclass(frozen=True, eq=False)
class AdaptiveResult(Generic[F]):
    """The answer on the last mesh, and the sequence that led to it.

    Attributes
    ----------
    result : AtOnce, CriticalResult or SafetyFactor
        Answer and mechanism on ``mesh``.
    mesh : QuadMesh
        The last mesh.
    rounds : list of MeshRound
        The sequence, coarsest first.
    converged : bool
        Whether what is left of the error is within the accuracy that was asked for.
    reason : str
        Why there was no further mesh.
    other : AdaptiveResult or None
        The same for the opposite direction, where both were asked for.
    """

    result: F
    mesh: QuadMesh
    rounds: list[MeshRound] = field(default_factory=list)
    converged: bool = False
    reason: str = ""
    other: "AdaptiveResult[F] | None" = None

    @property
    def limit(self) -> float:
        """What the sequence tends to if the error goes with one over the number of cells (-); NaN after one mesh."""
        if len(self.rounds) < 2:
            return math.nan
        before, last = self.rounds[-2:]
        return last.value - left_of_error(before, last.cells, last.value)

    @property
    def leaves_through_sides(self) -> bool:
        """Whether the mechanism reaches a side."""
        return self.result.mechanism is not None and bool(touched_sides(self.mesh, self.result.mechanism))


def left_of_error(before: MeshRound, cells: int, value: float) -> float:
    """By how much ``value`` (-) on so many ``cells`` is still too large, by one mesh ``before``."""
    return (before.value - value) / max(cells / before.cells - 1.0, LEAST_GAIN)


def is_adapted(section: Section, meshing: MeshSettings, first: QuadMesh, settings: FemSettings) -> bool:
    """Whether meshes are made for the mechanism.

    They are not where no accuracy is asked for; where the flow is not associated, whose answer no mesh makes unique;
    where columns and rows, or the mesh itself, were given.
    """
    chosen = meshing.columns or meshing.rows or first.method == "given"
    associated = settings.flow != "section" or is_dilating_fully(section.strata)
    return settings.accuracy > 0.0 and not chosen and associated


def next_mesh(
    section: Section,
    meshing: MeshSettings,
    mesh: QuadMesh,
    strain: np.ndarray,
    cells: int,
    strong: Section | None = None,
) -> QuadMesh:
    """A mesh of about so many ``cells`` for a mechanism of plastic shear ``strain`` (len(mesh.cells),).

    Where a mapped mesh was asked for, that one with more columns and rows where the mechanism is; else a free one. Its
    cells go by the shear displacement of the cells before: along a band of shear that is the same however narrow they
    were, where strains would draw all new cells to the narrowest. They follow the strips of the ``strong`` section,
    too, which has its cohesionless faces strengthened: sand with half of its points in a strip would be neither.
    Raises what ``adapted`` does.
    """
    if meshing.method == "mapped":
        return with_finer_strips(mesh, strain, cells)
    moved = strain * np.sqrt(areas(mesh.points, mesh.cells))
    if strong is None:
        return adapted(section, meshing, mesh, moved, cells)
    return without_strips(adapted(strong, meshing, mesh, moved, cells), section)


def strong_below(section: Section, faces: Sequence[Skin], settings: FemSettings) -> Section | None:
    """The section with the ground below ``faces`` strengthened; None without any."""
    return strengthened(section, faces, settings) if faces else None


def adapted_answer(
    section: Section,
    meshing: MeshSettings,
    first: QuadMesh,
    settings: FemSettings,
    comm: Any,
    listener: Callable[[str], None],
) -> AdaptiveResult[AtOnce]:
    """The critical Kh on meshes made for it, in the direction in which it is smaller; ``first`` alone if none are made.

    A push uphill whose mechanism leaves through a side counts only if there is nothing else, as in
    ``critical_coefficient``. Raises what ``critical_at_once`` does on the first mesh.
    """

    def towards(direction: Direction, other: float) -> AdaptiveResult[AtOnce]:
        wish = settings.model_copy(update={"direction": direction})
        faces: list[Skin] | None = None

        def solve(mesh: QuadMesh) -> AtOnce:
            nonlocal faces
            listener(f"limit load of {len(mesh.cells)} cells, {direction}")
            found = critical_at_once(section, mesh, wish, comm, faces)
            faces = found.ground.faces
            return found

        def remade(mesh: QuadMesh, strain: np.ndarray, cells: int) -> QuadMesh:
            return next_mesh(section, meshing, mesh, strain, cells, strong_below(section, faces or (), wish))

        most = settings.max_cells if is_adapted(section, meshing, first, settings) else 0
        return solve_adaptively(first, remade, solve, Wish(settings.accuracy, most, other))

    if settings.direction != "both":
        return towards(settings.direction, math.inf)
    down = towards("downhill", math.inf)
    up = towards("uphill", down.result.kc)
    if up.result.kc < down.result.kc and not up.leaves_through_sides:
        return replace(up, other=down)
    return replace(down, other=up)


def answer_beside(
    section: Section,
    meshing: MeshSettings,
    found: AdaptiveResult[AtOnce],
    other: FemSettings,
    comm: Any,
    listener: Callable[[str], None],
) -> AdaptiveResult[AtOnce]:
    """What ``other`` settings, with ψ = φ or other sides, find on the mesh of ``found``, and on one with as many cells
    that is made for the mechanism of that.

    Both are in the sequence, the smaller one is the result. Raises NoAnswerError if the solver leaves none on the mesh
    of ``found``.
    """
    listener(f"limit load of {len(found.mesh.cells)} cells")
    same = asked_again(found.result, section, found.mesh, other)
    first = AdaptiveResult(same, found.mesh, [MeshRound(len(found.mesh.cells), same.kc, math.inf, math.inf)])
    if same.mechanism is None or len(found.rounds) < 2:  # there is one mesh for all
        return first
    faces, strain = found.result.ground.faces, same.mechanism.plastic_shear_strain
    try:
        strong = strong_below(section, faces, other)
        mesh = next_mesh(section, meshing, found.mesh, strain, len(found.mesh.cells), strong)
        listener(f"limit load of {len(mesh.cells)} cells")
        own = critical_at_once(section, mesh, other, comm, faces)
    except NoAnswerError:
        return first
    if own.kc > same.kc:
        return first
    change = (same.kc - own.kc) / max(own.kc, SMALLEST_KH)
    return AdaptiveResult(own, mesh, [*first.rounds, MeshRound(len(mesh.cells), own.kc, change, change)])


def beside_full_dilation(
    section: Section,
    meshing: MeshSettings,
    found: AdaptiveResult[AtOnce],
    settings: FemSettings,
    comm: Any,
    listener: Callable[[str], None],
) -> tuple[AdaptiveResult[AtOnce], AdaptiveResult[AtOnce]]:
    """``found``, and the answer with ψ = φ beside it.

    On one mesh Davis's substitute, the weaker ground, bears no more. So where the mesh made for ψ = φ shows less than
    that of ``found``, this one was the poorer, and the answer is found anew on the other; what contradicts the order
    afterwards is no matter of meshes. Raises what ``answer_beside`` does.
    """
    full = settings.model_copy(update={"flow": "associated"})
    beside = answer_beside(section, meshing, found, full, comm, listener)
    if beside.result.kc >= found.result.kc:
        return found, beside
    again = critical_at_once(section, beside.mesh, settings, comm, found.result.ground.faces)
    last = replace(found.rounds[-1], cells=len(beside.mesh.cells), value=again.kc)
    same = asked_again(again, section, beside.mesh, full)
    return (
        replace(found, result=again, mesh=beside.mesh, rounds=[*found.rounds[:-1], last]),
        replace(beside, result=same),
    )


def adapted_safety(
    section: Section,
    meshing: MeshSettings,
    first: QuadMesh,
    settings: FemSettings,
    kh: float,
    comm: Any,
    listener: Callable[[str], None],
) -> AdaptiveResult[SafetyFactor]:
    """The factor of safety at ``kh`` on meshes made for it; raises what ``safety_at_once`` does on the first mesh."""

    guess = 1.0
    strong = strong_below(section, faces_at(section, settings, kh), settings)

    def solve(mesh: QuadMesh) -> SafetyFactor:
        nonlocal guess
        listener(f"factor of safety at Kh = {kh:g}: {len(mesh.cells)} cells")
        found = safety_at_once(section, mesh, settings, kh, comm, guess)
        guess = found.factor
        return found

    def remade(mesh: QuadMesh, strain: np.ndarray, cells: int) -> QuadMesh:
        return next_mesh(section, meshing, mesh, strain, cells, strong)

    most = settings.max_cells if is_adapted(section, meshing, first, settings) else 0
    return solve_adaptively(first, remade, solve, Wish(settings.accuracy, most))


@dataclass(frozen=True)
class Wish:
    """When to stop making meshes.

    Attributes
    ----------
    accuracy : float
        What may be left of the error, as a share of the critical Kh (-).
    max_cells : int
        Cells of the finest mesh.
    other : float
        The Kh (-) of the other direction: it does not matter by how much this one is larger.
    """

    accuracy: float
    max_cells: int
    other: float = math.inf


def solve_adaptively(
    first: QuadMesh,
    remade: Callable[[QuadMesh, np.ndarray, int], QuadMesh],
    solve: Callable[[QuadMesh], F],
    wish: Wish,
) -> AdaptiveResult[F]:
    """Solve on ``first``, then on meshes ``remade`` for the plastic shear strain of the last answer, of so many cells.

    Ends when what is left of the error is within the accuracy, when the cells are used up, or when there is no answer
    on the next mesh; then the last answer counts. Every rank makes the same mesh. Raises what ``solve`` raises on the
    first mesh.
    """
    mesh, result = first, solve(first)
    rounds = [MeshRound(len(mesh.cells), result.value, math.inf, math.inf)]
    while True:
        cells = len(mesh.cells)
        wanted = max(math.ceil(MORE_CELLS * cells), FEWEST_CELLS)
        if wanted > wish.max_cells >= FEWER_CELLS * cells:
            wanted = wish.max_cells
        reason = _reason_to_stop(rounds, result, wanted, wish)
        if not reason:
            assert result.mechanism is not None
            try:
                finer = remade(mesh, result.mechanism.plastic_shear_strain, wanted)
                answer = solve(finer)
                if answer.mechanism is None:
                    reason = f"there is no answer on the next mesh: {answer.reason}"
            except NoAnswerError as error:
                reason = f"there is no answer on the next mesh: {error}"
        if reason:
            return AdaptiveResult(result, mesh, rounds, rounds[-1].rest <= wish.accuracy, reason)
        mesh, result, size = finer, answer, max(abs(answer.value), SMALLEST_KH)
        left = left_of_error(rounds[-1], len(mesh.cells), result.value)
        rest = (left if left >= 0.0 else -RISEN * left) / size
        rounds.append(MeshRound(len(mesh.cells), result.value, abs(result.value - rounds[-1].value) / size, rest))


def _reason_to_stop(rounds: list[MeshRound], result: Found, wanted: int, wish: Wish) -> str:
    """Why there is to be no next mesh, of so many cells as ``wanted``; empty if there is."""
    last = rounds[-1]
    if last.rest <= wish.accuracy:
        return f"the last mesh changed it by {100 * last.change:.1f} % and about {100 * last.rest:.1f} % are left"
    if result.mechanism is None:
        return f"there is no mechanism to refine: {result.reason}"
    rest = FIRST_REST if len(rounds) == 1 else REST_TIMES * last.rest
    if last.value * (1.0 - rest) > wish.other:
        return "the other direction governs"
    if wanted > wish.max_cells:
        return f"the next mesh would have {wanted} cells, {wish.max_cells} are allowed"
    return ""
