"""The continuum as the discs are: with their sides, and with ψ as given on a non-associated path."""

from dem.team import Tell
from fem.settings import YIELDED
from fem.strength import is_dilating_fully
from meshes.errors import NoAnswerError
from workflow.results.answer import line
from workflow.results.continuum import FemAnswer, PathStep, displacement_at
from workflow.results.like_discs import LikeDiscs
from workflow.results.stored_mesh import stored_mesh
from workflow.run.store import Store
from workflow.settings import Input

# Cells times factorisations of a path at most, a minute or so: in bare sand it may take many more.
WORK = 1.2e6


class _TakesTooLongError(NoAnswerError):
    """The path is not worth any more time."""


def like_discs(given: Input, store: Store, tell: Tell) -> None:
    """Leave what soil discs are held against in the folder, unless a run that was stopped has done so."""
    if not store.has(LikeDiscs.FILE):
        continuum_like_discs(given, store, tell).write(store)


def continuum_like_discs(given: Input, store: Store, tell: Tell) -> LikeDiscs:
    """The path with ψ as given, on the mesh that the search began with, since discs have the strength of the soil and
    hardly any dilation. A path that goes on to rise leaves open where it fails: above the last equilibrium that was
    found on it, but below what ground with ψ = φ bears. Davis's substitute, a lower estimate, stands in where the path
    takes too long or comes to less.
    """
    from mpi4py import MPI

    from fem.as_discs import as_discs, dilating_fully
    from fem.path import EquilibriumPath

    fem = FemAnswer.read(store)
    known = LikeDiscs.of(fem)
    if known.sides != "fixed" or fem.settings.flow != "davis" or is_dilating_fully(given.strata):
        return known
    mesh = stored_mesh(given, store)

    def step(path: EquilibriumPath) -> None:
        tell((f"the continuum with ψ as given: Kh = {path.factor:.4f}", None))
        if path.solves * len(mesh.cells) > WORK:
            raise _TakesTooLongError("the path takes too long", "")

    depth = known.deeper_than_m or given.fem.least_depth
    settings = given.fem.model_copy(update={"direction": fem.direction, "least_depth": depth})
    try:
        found = as_discs(given, mesh, settings, MPI.COMM_SELF, step)
        upper = found.upper
        if found.upper > found.kc + given.dem.tolerance:
            upper = max(found.kc, min(found.upper, dilating_fully(given, mesh, settings, MPI.COMM_SELF)))
    except NoAnswerError as error:
        return LikeDiscs.of(fem, f"with ψ as given there is no answer: {error.reason}")
    if found.verdict == "no failure":
        return LikeDiscs.of(fem, f"with ψ as given there is {found.reason}")
    if found.kc < known.kc:
        return LikeDiscs.of(fem, f"the path with ψ as given ended at Kh = {found.kc:.3f}, below Davis's substitute")
    curve = tuple(PathStep.model_validate(each) for each in found.steps)
    return known.model_copy(
        update={
            "kc": found.kc, "kc_upper": upper, "verdict": found.verdict, "reason": found.reason,
            "flow": "section", "curve": curve, "yielding_m": displacement_at(curve, found.kc, YIELDED),
            "slip_surface": line(found.slip_surface),
        }
    )  # fmt: skip
