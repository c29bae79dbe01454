"""Computes strict lower and upper bounds of the factor of safety of a section at a given Kh, by limit analysis.

The factor divides c and tan φ of all strata (Zienkiewicz, Humpheson & Lewis 1975); the flow rule is associated. For a
trial factor F, limit analysis bounds the critical Kh of the weakened ground. F is a lower bound if one stress field is
in equilibrium with more than the given Kh, and another one with more than this Kh in the opposite direction: since
yield surfaces are convex, the ground then resists every Kh in between. F is an upper bound if a mechanism in either
direction fails at less than the given Kh. The bounds of Kh fall smoothly as F rises, so that F is found by a few secant
steps on coarse triangles, then on finer ones.

Where the weight or a surcharge causes failure, as below a footing, no Kh is in equilibrium; where thin slices of
cracked ground topple from an upright face at any Kh, the ground resists none, whatever its strength. There the share of
all loads that the ground resists is bounded in place of Kh, and F is a lower bound if this share is at least 1.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

from fem.continuum.face_reinforcement import strengthened
from fem.continuum.loads import Direction, direction_of
from fem.continuum.shallow_failure import faces_at, has_uncounted_water, least_rolling_factor
from fem.continuum.strength import strengths
from fem.limit.bounds import COARSE_CELLS, KhBounds, as_analysed
from fem.limit.factor_search import LARGEST_FACTOR, SMALLEST_FACTOR, FactorSearch
from fem.limit.factor_trial import BoundsTrial, FactorWork, TrialStart, gap_of_factors
from fem.limit.first_mesh import cells_of_first_search, first_mesh
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from meshes.triangles import TriMesh

# Number of bisections for the factor of a shallow failure, between half of a known factor and this factor: to 4 %.
HALVINGS = 4
# Share of the computing work for a slope as a whole where its bare faces meet; the rest is for the ground as given.
WORK_SHARE_OF_WHOLE = 0.6
# Share of the computing work for the first direction of the force; the rest is for the proof that the factor of the
# other direction is not smaller. Under seepage this proof requires the triangles of the first direction.
WORK_SHARE_OF_FIRST, WORK_SHARE_OF_FIRST_UNDER_SEEPAGE = 0.92, 0.75
# Largest ratio of the gap of the bounds of the ground as given to that of the slope as a whole with which they count.
GAP_RATIO_OF_GIVEN = 3.0
# Largest ratio of the upper bound on coarse triangles to the factor of safety.
COARSE_BOUND_RATIO = 1.06
# Number of trials on the first mesh that the allowed work suffices for.
TRIALS_ON_FIRST_MESH = 12

# Why no finer triangles were made: the factor is close enough, or beyond those looked for; no more triangles or work
# are allowed; the solver fails.
FactorEnd = Literal["gap", "range", "triangles", "time", "solver"]


@dataclass(frozen=True)
class SafetyBounds:
    """Holds bounds of the factor of safety: the ground stands at ``lower`` and fails at ``upper``.

    With a shallow failure the ground down to the least depth below the faces is strengthened, as in the finite
    elements, and the bounds are strict for this strengthened ground: they are bounds of the whole slope. Without one
    they are strict for the ground of the section file, except at ends of loads on bare sand (``load_ends.py``).

    Attributes
    ----------
    kh : seismic coefficient (-)
    lower, upper : bounds (-); 0 and inf if no bound was proven
    cells : triangles of the finest mesh
    trials : bounds at each factor that was tried
    shallow_failure : factor at which a cohesionless face fails, or shallow ground slips where two faces meet or water
        stands close below a face; None if it is not below ``upper``. It equals ``upper`` if no admissible stress was
        found in the ground without strengthening, or only at factors far below.
    direction : direction of the seismic force at failure; None without force
    end_reason : reason why the bounds are not closer
    """

    kh: float
    lower: float
    upper: float
    cells: int
    trials: list[BoundsTrial]
    shallow_failure: float | None = None
    direction: Direction | None = None
    end_reason: FactorEnd = "gap"

    @property
    def gap(self) -> float:
        """Return the upper less lower bound over their mean, inf if a bound is missing."""
        return gap_of_factors(self.lower, self.upper)


def safety_bounds(
    section: Section,
    fem: FemSettings,
    settings: BoundsSettings,
    kh: float = 0.0,
    guess: float = 1.0,
    smooth_sides: bool = False,
    known: KhBounds | None = None,
) -> SafetyBounds:
    """Find lower and upper bounds of the factor of safety at ``kh``.

    Both directions of the seismic force are analysed, at factors from 0.02 to 20.

    Parameters
    ----------
    section : the ground
    fem : settings of the elements, of which sides, direction and least depth matter here
    settings : required gap, largest number of triangles and largest computing work
    kh : seismic coefficient (-)
    guess : first factor that is tried; a poor one costs time only (-)
    smooth_sides : whether the sides move only vertically, as in strength reduction without shaking; else free-field
        sides carry the K0 stress
    known : bounds of the critical Kh of the section, which lend a mesh to begin on

    Returns
    -------
    The bounds; they may be 0 and inf.

    Raises
    ------
    InputError
        As ``kh_bounds``.
    BadMeshError
        If the section cannot be divided into triangles.
    """
    start, work = TrialStart(kh, guess, smooth_sides, kh_bounds=known), FactorWork(settings.seconds)
    faces = faces_at(section, fem, kh)
    shallow = least_rolling_factor(section, faces, kh, strengths(section.strata)[1])
    if shallow is None or shallow >= LARGEST_FACTOR:
        return _bounds_of(section, fem, settings, start, work)
    strengthened_section = strengthened(section, faces, fem)
    # Where bare faces of unlike water meet, or water stands shortly below a face, shallow ground may slip before the
    # faces and before the slope as a whole, by less than coarse triangles tell apart: work is left for the ground as it
    # is given.
    meet = any(face.end == other.start for face in faces for other in faces)
    meet = meet or any(has_uncounted_water(section, face, fem.least_depth) for face in faces)
    deeper: SafetyBounds | None = None
    coarse = _coarse(strengthened_section, fem, settings, start, work)
    if not coarse.fails_at(shallow):
        share = WORK_SHARE_OF_WHOLE if meet and coarse.fails_at(COARSE_BOUND_RATIO * shallow) else 1.0
        deeper = _bounds_of(strengthened_section, fem, settings, start, work.part(share))
        if shallow < deeper.upper:
            return replace(deeper, shallow_failure=_coarse(section, fem, settings, start, work).least_failing(shallow))
    if not meet:
        return _bounds_of(section, fem, settings, start, work)
    deeper = deeper or _bounds_of(strengthened_section, fem, settings, start, work.part(WORK_SHARE_OF_WHOLE))
    work.spent += sum(trial.work for trial in deeper.trials)
    return _with_given_ground(section, deeper, fem, settings, start, work)


def _with_given_ground(
    section: Section,
    deeper: SafetyBounds,
    fem: FemSettings,
    settings: BoundsSettings,
    start: TrialStart,
    work: FactorWork,
) -> SafetyBounds:
    """Return the bounds of a section whose strengthened faces meet. If the ground without strengthening resists as much
    as the strengthened ground, whose bounds are ``deeper``, the result has no shallow failure. Otherwise the result is
    ``deeper`` with the factor at which shallow ground slips.
    """
    if deeper.lower > 0.0:
        start = replace(start, factor=deeper.lower, lower_suffices=deeper.lower, upper_suffices=deeper.lower)
    unchanged = _bounds_of(section, fem, settings, start, work.part(1.0))
    trials = [*deeper.trials, *unchanged.trials]
    if unchanged.upper < (deeper.lower if unchanged.lower > 0.0 else deeper.upper):
        return replace(deeper, shallow_failure=unchanged.upper, trials=trials)
    if 0.0 < deeper.lower <= unchanged.lower:
        return replace(deeper, trials=trials)  # a mechanism of the stronger ground is one of this ground, too
    # A mechanism of the stronger ground fails this one, too, whatever work was left for its own.
    unchanged = replace(unchanged, upper=min(unchanged.upper, deeper.upper), trials=trials)
    if unchanged.gap <= GAP_RATIO_OF_GIVEN * deeper.gap or deeper.lower == 0.0:
        return unchanged
    # Without a close stress field for the ground as given, the bounds of the slope as a whole are still valid.
    least = _coarse(section, fem, settings, start, work).least_failing(deeper.upper)
    return replace(deeper, shallow_failure=least, trials=trials)


@dataclass(frozen=True)
class _CoarseBounds:
    """Holds the coarse triangles of a section and its upper bounds on them, with the seismic force to either side."""

    searches: tuple[FactorSearch, FactorSearch]

    def fails_at(self, factor: float) -> bool:
        """Return whether a mechanism fails when the strength is divided by ``factor``."""
        return any(_is_unsafe(search, factor) for search in self.searches)

    def least_failing(self, factor: float) -> float:
        """Return ``factor``, or a smaller factor at which a mechanism fails: where faces of different water or slope
        meet, shallow ground slips before the face fails.
        """
        weak = [search for search in self.searches if _is_unsafe(search, factor)]
        if not weak:
            return factor
        stands, fails = 0.5 * factor, factor
        for _ in range(HALVINGS):
            middle = math.sqrt(stands * fails)
            still = [
                search for search in weak if _is_unsafe(search, middle)
            ]  # what stands does so at smaller factors, too
            weak, stands, fails = (still, stands, middle) if still else (weak, middle, fails)
        return fails


def _is_unsafe(search: FactorSearch, factor: float) -> bool:
    """Return whether a mechanism in the direction of a search fails when the strength is divided by ``factor``."""
    search.measure(factor, lower=False)
    return search.upper <= factor


def _coarse(
    section: Section, fem: FemSettings, settings: BoundsSettings, start: TrialStart, work: FactorWork
) -> _CoarseBounds:
    section = as_analysed(section, fem)
    mesh = first_mesh(section, COARSE_CELLS, fem.sides)
    downslope, upslope = (FactorSearch(section, mesh, fem, settings, sign, start, work) for sign in (1, -1))
    return _CoarseBounds((downslope, upslope))


def _first_mesh(
    section: Section, fem: FemSettings, settings: BoundsSettings, start: TrialStart, work: FactorWork
) -> TriMesh:
    """Return a mesh of the known bounds of Kh if these bounds are of the same section, else a coarse mesh."""
    known = start.kh_bounds
    mesh = known.mesh_for_factors if known is not None and known.section == section else None
    return mesh or first_mesh(
        section, cells_of_first_search(settings.max_cells, work.left / TRIALS_ON_FIRST_MESH), fem.sides
    )


def _bounds_of(
    section: Section, fem: FemSettings, settings: BoundsSettings, start: TrialStart, work: FactorWork
) -> SafetyBounds:
    """Return the bounds of a section whose faces are already strengthened, if necessary."""
    section = as_analysed(section, fem)

    def search(mesh: TriMesh, sign: int, start: TrialStart) -> FactorSearch:
        return FactorSearch(section, mesh, fem, settings, sign, start, work)

    first = _first_mesh(section, fem, settings, start, work)
    seeps = section.water_pressure.flow is not None
    shared, work = work, work.part(WORK_SHARE_OF_FIRST_UNDER_SEEPAGE if seeps else WORK_SHARE_OF_FIRST)
    searches = [search(first, 1, start)]
    searches[0].find()
    shared.spent += work.spent
    work = shared
    # Under seepage pressures are linear in each triangle: other triangles are other ground, and prove nothing here.
    known = [searches[0].mesh_of_lower] if seeps else searches[0].meshes
    searches.append(search(known[(len(known) - 1) // 2], -1, start))
    if not searches[1].confirms(searches[0]) and work.left > 0.0:
        start = replace(start, factor=searches[0].lower or start.factor, lower_suffices=searches[0].lower or math.inf)
        searches.append(search(first, -1, start))
        searches[2].find()
    lower, upper = min(searches[0].lower, searches[-1].lower), min(search.upper for search in searches)
    trials = [trial for search in searches for trial in search.trials]
    end_reason: FactorEnd = "time" if work.ran_out or searches[0].work.ran_out else "triangles"
    end_reason = "solver" if any(search.solver_fails for search in searches) else end_reason
    end_reason = "range" if lower >= LARGEST_FACTOR or upper <= SMALLEST_FACTOR else end_reason
    end_reason = "gap" if gap_of_factors(lower, upper) <= settings.gap else end_reason
    direction = direction_of(fem, opposite=searches[-1].upper < searches[0].upper) if start.kh else None
    cells = max(trial.cells for trial in trials)
    return SafetyBounds(start.kh, lower, upper, cells, trials, direction=direction, end_reason=end_reason)
