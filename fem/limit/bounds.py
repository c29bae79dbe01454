"""Computes strict lower and upper bounds of the critical seismic coefficient of a section by limit analysis.

The flow rule is associated, ψ = φ; the upper bound holds for every smaller ψ, too (Radenkovic 1961). Where ψ < φ,
Davis's estimate (1968) multiplies c and tan φ by cos ψ cos φ / (1 - sin ψ sin φ) and takes associated flow. The bounds
of this weaker ground are strict, and check the finite elements with Davis's estimate.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem.continuum.face_reinforcement import strengthened
from fem.continuum.load_ends import with_cohesion_around, with_strengthened_load_ends
from fem.continuum.loads import Direction, direction_of, excess_pressure_advice, seismic_sign, soils, uplift_error
from fem.continuum.shallow_failure import ShallowFailure, failing_at_rest, has_uncounted_water, shallow_failures
from fem.continuum.strength import flow_of, is_dilating_fully
from fem.continuum.water_exits import exits_of_directions
from fem.errors import UnstableError
from fem.limit.adaptive_bounds import BoundSearch, proven_upper_bound
from fem.limit.bracket import Limits
from fem.limit.directions import DirectionSearch, KhObserver, SectionSide, SmallerKhBounds, search_all
from fem.limit.first_mesh import cells_of_first_search, first_mesh
from fem.limit.limit_problem import limit_problem, units_of
from fem.limit.section_body import body_of
from fem.settings import LEAST_KH, BoundsSettings, FemSettings
from meshes.errors import InputError
from meshes.section.least_strength import cut_at_least_strength
from meshes.section.section import Section
from meshes.triangles import TriMesh

# Number of meshes of the size of the first one that the allowed work suffices for.
WORK_IN_FIRST_MESHES = 6
# Largest number of cells where a rough upper bound suffices; the first mesh has a share of it.
COARSE_CELLS = 8000
# Largest share of the allowed work for each rough upper bound. Sand from which water seeps has no equilibrium before
# its face is strengthened, and the solver would search for one longer than for all bounds.
LARGEST_COARSE_SHARE = 0.1
# Gap between the bounds of Kh (absolute, and as a share of Kh) up to which the search for a factor of safety starts
# from their mesh.
LARGEST_FIRST_GAP, LARGEST_FIRST_GAP_SHARE = 0.02, 0.15
# A shallow failure governs if the Kh of the section is below this share of the Kh with strengthened faces. The
# strength of the faces changes the Kh of a deeper failure by some per cent only.
SHALLOW_FAILURE_SHARE = 0.5


@dataclass(frozen=True, eq=False)
class KhBounds(SmallerKhBounds):
    """Holds the bounds of the critical Kh with ψ = φ, and the bounds of both directions.

    Attributes
    ----------
    shallow_failures : cohesionless faces whose shallow failure has a smaller Kh than the bounds. If there is one, the
        ground below all these faces is strengthened down to the least depth, as in the finite elements, and the bounds
        are strict for the strengthened ground: they are bounds of the whole slope. Without shallow failures the bounds
        are strict for the ground of the section file, except at ends of loads on bare sand and at ``water_exits``.
    shallow : an upper bound of Kh of the ground without strengthening, if it is below the bounds and below the Kh of
        all ``shallow_failures``: ground above the least depth then slips where faces of different water or slope meet,
        or where water seeps out of a face or stands close below it. The ground of this slip is strengthened as well.
        None if the upper bound of the ground without strengthening is not smaller.
    water_exits : x (m) of the points where water comes out of bare sand, and the sand was strengthened; none where
        whole faces were strengthened
    section : the section that was analysed for the direction that fails first, with faces strengthened if necessary
    substitute : bounds of Davis's estimate if ψ < φ and the settings request them, computed on the last meshes for ψ =
        φ
    work : computing work of all bounds, in seconds on the reference machine of ``cone_program``
    """

    shallow_failures: tuple[ShallowFailure, ...] = ()
    shallow: float | None = None
    water_exits: tuple[float, ...] = ()
    section: Section | None = None
    substitute: SmallerKhBounds | None = None
    work: float = 0.0

    @property
    def mesh_for_factors(self) -> TriMesh | None:
        """Return the coarsest mesh of the direction that fails first on which both bounds are close enough to begin the
        search for a factor of safety there; None without such a mesh."""
        for mesh in self.directions[0].meshes:
            if mesh.lower is not None and mesh.upper is not None:
                widest_gap = max(LARGEST_FIRST_GAP, LARGEST_FIRST_GAP_SHARE * abs(mesh.upper))
                if mesh.upper - mesh.lower <= widest_gap:
                    return mesh.mesh
        return None


class ProvenUnstableError(UnstableError):
    """A mechanism proves that the ground fails without any seismic force.

    Attributes
    ----------
    reason, remedy : str
        As in ``UnstableError``.
    bounds : KhBounds
        The bounds of the critical Kh, whose upper bound is below 0.
    """

    def __init__(self, reason: str, remedy: str, bounds: KhBounds) -> None:
        super().__init__(reason, remedy)
        self.bounds = bounds

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the error in the form in which it is sent to another process, without its meshes."""
        return UnstableError, (self.reason, self.remedy)


@dataclass(frozen=True)
class DirectionGround:
    """Holds the ground that is analysed for one direction of the seismic force.

    ``shallow_failures`` are the faces that may fail at a smaller Kh than the whole slope. ``as_given`` is an upper
    bound, on coarse triangles, of Kh of the section without strengthening (inf if there are no such faces). ``section``
    is the ground with these faces strengthened. In the ground ``without_faces`` only the points at ``water_exits`` are
    strengthened, x (m) where water comes out of bare sand. ``work`` is the computing work of the coarse bounds (seconds
    on the reference machine of ``cone_program``).
    """

    fem: FemSettings
    max_cells: int
    shallow_failures: tuple[ShallowFailure, ...]
    as_given: float
    section: Section
    without_faces: Section
    water_exits: tuple[float, ...] = ()
    work: float = 0.0

    @classmethod
    def of(cls, section: Section, fem: FemSettings, max_cells: int, seconds: float = math.inf) -> "DirectionGround":
        """Return the ground that is analysed for the direction of the settings ``fem``, with a mesh of at most
        ``max_cells`` triangles; ``seconds``: computing work of the bound on the coarse mesh, at most.

        The critical Kh of each face is compared with an upper bound on one coarse mesh of the section with all its
        faces strengthened. The upper bound of the coarse mesh is larger than that of a fine mesh, so that a few faces
        too many may be listed, but no face is missing. Faces inclined against the force that fail by their weight are
        strengthened in any case: no stress field is in equilibrium there. The section without strengthening is not used
        for the comparison: where faces of different water meet, its mechanism may be shallow, too. Raises the errors of
        ``first_mesh``.
        """
        faces, faces_at_rest = shallow_failures(section, fem), failing_at_rest(section, fem)
        exits, opposite = exits_of_directions(section, fem)
        sound = with_cohesion_around(section, opposite, fem.least_depth)
        strengthened_section = strengthened(sound, faces + faces_at_rest, fem)
        most_work = LARGEST_COARSE_SHARE * seconds
        upper, work = _coarse_upper_bound(strengthened_section, fem, most_work) if faces else (-np.inf, 0.0)
        govern = [face for face in faces if face.kh < upper]
        bare, places = with_cohesion_around(section, exits | opposite, fem.least_depth), (*exits, *opposite)
        if not govern and not faces_at_rest:
            return cls(fem, max_cells, (), np.inf, bare, bare, places, work)
        ground = strengthened_section if govern else strengthened(bare, faces_at_rest, fem)
        as_given, more_work = _coarse_upper_bound(section, fem, most_work)
        return cls(fem, max_cells, (*govern, *faces_at_rest), as_given, ground, bare, places, work + more_work)

    def search(self, limits: Limits, after: BoundSearch | None = None) -> DirectionSearch:
        """Return the search for bounds. ``after``, the search for ψ = φ, is given if the search is for Davis's
        estimate: the new search begins on the last mesh of ``after`` if enough work is left.
        """
        ground = as_analysed(self.section, self.fem)
        if after is not None and 2.0 * after.bracket.meshes[-1].work < limits.seconds:
            mesh = after.bracket.mesh
        else:
            most_cells = cells_of_first_search(self.max_cells, limits.seconds / WORK_IN_FIRST_MESHES)
            mesh = first_mesh(ground, most_cells, self.fem.sides)
        towards: SectionSide = "right" if seismic_sign(self.section, self.fem) > 0 else "left"
        body = body_of(ground, mesh, self.fem, davis=after is not None)
        return DirectionSearch(mesh, body, limits, direction_of(self.fem), towards)


def kh_bounds(
    section: Section, fem: FemSettings, settings: BoundsSettings, observer: KhObserver | None = None
) -> KhBounds:
    """Find strict lower and upper bounds of the critical seismic coefficient (limit analysis).

    Parameters
    ----------
    section : Section
        The section.
    fem : FemSettings
        Sides, directions and vertical coefficient.
    settings : BoundsSettings
        Required gap, largest numbers of triangles and computing work.
    observer : callable, optional
        Called with the bounds on every mesh.

    Returns
    -------
    KhBounds

    Raises
    ------
    InputError
        If the section lacks what the analysis needs, or its sides are periodic and differ.
    ProvenUnstableError
        If the section is proven to fail at every Kh; with the bounds.
    BadMeshError
        If the section cannot be divided into triangles.
    """
    strata = soils(section)
    if all(s.density_seismic == 0.0 for s in strata):
        raise InputError(section.name, ["density_seismic is 0 in all strata, so that Kh causes no force"])
    davis = flow_of(section.strata, fem.flow) != "associated" if settings.davis == "auto" else settings.davis
    with_davis = davis and not is_dilating_fully(strata)
    grounds = {
        direction: DirectionGround.of(section, fem.changed(direction=direction), settings.max_cells, settings.seconds)
        for direction in directions_of(fem)
    }
    allowed = settings.seconds - sum(ground.work for ground in grounds.values())
    seconds = allowed / (2.0 if with_davis else 1.0)
    limits = Limits(settings.gap, settings.max_cells, seconds, sufficient_upper=0.0, smallest_mean=LEAST_KH)
    searches = {direction: ground.search(limits) for direction, ground in grounds.items()}
    bounds = search_all(section, fem.sides, tuple(searches.values()), limits, observer)
    strong = {direction: (ground, searches[direction]) for direction, ground in grounds.items()}
    # A shallow failure where water emerges from a face governs before the faces themselves; a rough bound may show it.
    wet = [
        way
        for way, ground in grounds.items()
        if ground.without_faces is section and _fails_shallow(section, fem, ground.as_given, *strong[way])
    ]
    others = {way: ground for way, ground in grounds.items() if way not in wet}
    dropped = _drop_needless_strength(others, searches, limits, bounds.upper)
    grounds |= others
    bounds = search_all(section, fem.sides, tuple(searches.values()), limits, observer)
    for way in others:
        upper = searches[way].bracket.upper
        if _fails_shallow(section, fem, upper, *strong[way]):
            dropped += searches[way].work - strong[way][1].work
            grounds[way], searches[way] = replace(strong[way][0], as_given=upper), strong[way][1]
            wet.append(way)
    if wet:
        bounds = search_all(section, fem.sides, tuple(searches.values()), limits, observer)
    substitute, spent = None, dropped + sum(search.work for search in searches.values())
    if with_davis and bounds.upper >= 0.0:
        left = replace(limits, seconds=allowed - spent)
        weaker = [ground.search(left, after=searches[direction]) for direction, ground in grounds.items()]
        substitute = search_all(section, fem.sides, weaker, left, observer)
        spent += sum(search.work for search in weaker)
    faces = dict.fromkeys(face for ground in grounds.values() for face in ground.shallow_failures)
    govern = tuple(face for face in faces if face.kh < bounds.upper)
    as_given = min(ground.as_given for ground in grounds.values())
    governed = bool(govern or wet)
    shallow = as_given if governed and as_given < min([bounds.upper, *(face.kh for face in govern)]) else None
    exits = () if governed else tuple(sorted({x for ground in grounds.values() for x in ground.water_exits}))
    answer = KhBounds(
        **vars(bounds),
        shallow_failures=govern,
        shallow=shallow,
        water_exits=exits,
        section=as_analysed(grounds[bounds.directions[0].direction].section, fem),
        substitute=substitute,
        work=settings.seconds - allowed + spent,
    )
    if answer.upper < 0.0:
        raise _unstable_error(section, answer)
    return answer


def _drop_needless_strength(
    grounds: dict[Direction, DirectionGround],
    searches: dict[Direction, DirectionSearch],
    limits: Limits,
    upper: float,
) -> float:
    """Replace grounds whose faces fail at no smaller Kh than ``upper`` by the ground without strengthened faces, with
    new searches; return the work of the replaced searches. The coarse triangles resisted too much.
    """
    dropped = 0.0
    for direction, ground in grounds.items():
        if ground.section is not ground.without_faces and not any(face.kh < upper for face in ground.shallow_failures):
            grounds[direction] = replace(ground, section=ground.without_faces, shallow_failures=())
            dropped += searches[direction].work
            remaining_limits = replace(limits, seconds=limits.seconds - dropped)
            searches[direction] = grounds[direction].search(remaining_limits)
    return dropped


def _fails_shallow(
    section: Section, fem: FemSettings, upper: float, ground: DirectionGround, strong: DirectionSearch
) -> bool:
    """Return whether shallow ground slips: the ``upper`` bound of the section without strengthened faces is far below
    the bounds of the ``strong`` search, whose ``ground`` has them, or below them with water at a face."""
    if upper < SHALLOW_FAILURE_SHARE * max(strong.bracket.lower, 0.0):
        return True
    water_emerges = any(has_uncounted_water(section, face, fem.least_depth) for face in ground.shallow_failures)
    return water_emerges and upper < strong.bracket.lower


def directions_of(fem: FemSettings) -> tuple[Direction, ...]:
    """Return the directions of the seismic force that the settings request."""
    return ("downhill", "uphill") if fem.direction == "both" else (fem.direction,)


def _unstable_error(section: Section, bounds: KhBounds) -> ProvenUnstableError:
    """Return the error for ground whose critical Kh is below zero. A number below -1 has no meaning and is left out of
    the message.
    """
    if section.uplift is not None:
        uplifted = uplift_error(section.uplift, "the section fails under its own weight")
        return ProvenUnstableError(uplifted.reason, uplifted.remedy, bounds)
    limit_words = (
        f"the critical Kh is at most {bounds.upper:.3g}"
        if bounds.upper > -1.0
        else "no horizontal force could stabilise it"
    )
    advice = excess_pressure_advice(section.strata)
    cause = "by excess pore pressure and its weight" if advice else "under its own weight"
    remedy = advice or "check strengths and densities"
    return ProvenUnstableError(f"the section fails {cause}: {limit_words}", remedy, bounds)


def as_analysed(section: Section, fem: FemSettings) -> Section:
    """Return the section in the form that is analysed: ends of loads on bare sand are strengthened. Strata are also
    divided at the water table where a part is too thin for elements, and at elevations where a strength begins to
    increase.
    """
    return cut_at_least_strength(with_strengthened_load_ends(section, fem.least_depth).cut_at_films)


def _coarse_upper_bound(section: Section, fem: FemSettings, most_work: float) -> tuple[float, float]:
    """Return an upper bound of Kh on one coarse mesh, inf if there is none after ``most_work``, and its computing work
    (seconds on the reference machine of ``cone_program``)."""
    ground = as_analysed(section, fem)
    mesh = first_mesh(ground, COARSE_CELLS, fem.sides)
    body = body_of(ground, mesh, fem)
    bound, _, mechanism = proven_upper_bound(limit_problem(mesh, body, units_of(mesh, body)), most_work)
    return mechanism.multiplier if mechanism else np.inf, bound.solution.work
