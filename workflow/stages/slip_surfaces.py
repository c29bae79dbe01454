"""The slip surfaces of discs and continuum side by side, and what the continuum says of that of the discs."""

import numpy as np

from dem.slides.slip import compare
from meshes.errors import NoAnswerError
from workflow.results.answer import line
from workflow.results.continuum import FemAnswer
from workflow.results.discs import GivenDilation, SlipSurfaces
from workflow.results.stored_mesh import fem_mesh
from workflow.run.store import Store
from workflow.settings import Input


def slip_surfaces(
    given: Input,
    store: Store,
    before: np.ndarray,
    after: np.ndarray,
    fem: FemAnswer,
    dilating: GivenDilation | None = None,
) -> SlipSurfaces:
    """Those of the discs ``before`` and ``after`` calibration, both (k, 2), points [x, elevation] in m, and that of the
    continuum with the sides of the discs' box where it was computed with these, else at the last state of its path;
    ``dilating`` is the continuum with ψ as given.
    """
    of_fem = [state.slip_surface for state in fem.states if state.slip_surface]
    if given.dem.model == "soil" and fem.rigid_box is not None and fem.rigid_box.has_kc:
        of_fem.append(fem.rigid_box.slip_surface)
    continuum = np.array(of_fem[-1] if of_fem else ()).reshape(-1, 2)
    agreement = compare(given, after, continuum)
    deeper = agreement is not None and agreement.mean_height_m > 0.0
    return SlipSurfaces(
        dem=line(after),
        dem_before=line(before),
        fem=line(continuum),
        mean_distance_m=agreement.mean_distance_m if agreement else None,
        same_stratum_share=agreement.same_stratum_share if agreement else None,
        columns=agreement.columns if agreement else None,
        given_dilation=_compared(given, after, dilating) if dilating else None,
        excess_above=_excess_above(given, store, after, fem) if deeper else None,
    )


def _compared(given: Input, discs: np.ndarray, continuum: GivenDilation) -> GivenDilation:
    found = compare(given, discs, np.array(continuum.slip_surface).reshape(-1, 2))
    if found is None:
        return continuum
    apart = {"mean_distance_m": found.mean_distance_m, "same_stratum_share": found.same_stratum_share}
    return continuum.model_copy(update=apart)


def _excess_above(given: Input, store: Store, line: np.ndarray, fem: FemAnswer) -> float | None:
    """By which share the continuum bears more Kh where it may fail no deeper than the line; None without an answer."""
    from mpi4py import MPI

    from fem.given_surface import critical_above

    mesh = fem_mesh(given, store, fem.mesh.method)
    depth = (fem.rigid_box and fem.rigid_box.deeper_than_m) or given.fem.least_depth
    wish = {"sides": fem.sides_for_discs, "direction": fem.direction, "least_depth": depth}
    settings = given.fem.model_copy(update=wish)
    try:
        excess = critical_above(given, mesh, settings, line, MPI.COMM_SELF).excess
    except NoAnswerError:
        return None
    return excess if np.isfinite(excess) else None
