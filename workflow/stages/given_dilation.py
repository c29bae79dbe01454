"""The continuum as the discs are: with their sides, and with ψ as given on a non-associated path."""

from dem.team import Tell
from fem.strength import is_dilating_fully
from meshes.errors import NoAnswerError
from workflow.results.answer import line
from workflow.results.continuum import FemAnswer
from workflow.results.discs import GivenDilation
from workflow.results.stored_mesh import stored_mesh
from workflow.run.store import Store
from workflow.settings import Input

# Cells times factorisations of a path at most, a minute or so: in bare sand it takes many more, and nothing but the
# place of the slip surface hangs on it.
WORK = 1.2e6


class _TakesTooLongError(NoAnswerError):
    """The path is not worth any more time."""


def given_dilation(given: Input, store: Store, tell: Tell) -> GivenDilation | None:
    """The slip surface and the critical Kh of the continuum with the dilation that the discs are to have, on the mesh
    that the search began with; None where every stratum dilates fully, or where the path takes too long or ends without
    failure."""
    from mpi4py import MPI

    from fem.as_discs import as_discs
    from fem.path import EquilibriumPath

    fem = FemAnswer.read(store)
    if is_dilating_fully(given.strata) or fem.settings.flow == "associated":
        return None
    mesh = stored_mesh(given, store)

    def step(path: EquilibriumPath) -> None:
        tell((f"the continuum with ψ as given: Kh = {path.factor:.4f}", None))
        if path.solves * len(mesh.cells) > WORK:
            raise _TakesTooLongError("the path takes too long", "")

    depth = (fem.rigid_box and fem.rigid_box.deeper_than_m) or given.fem.least_depth
    settings = given.fem.model_copy(update={"direction": fem.direction, "least_depth": depth})
    try:
        found = as_discs(given, mesh, settings, MPI.COMM_SELF, step)
    except NoAnswerError:
        return None
    if found.verdict not in ("plateau", "peak"):
        return None
    return GivenDilation(kc=found.kc, kc_upper=found.upper, slip_surface=line(found.slip_surface))
