"""Comparison of the slip surfaces of discs and continuum."""

import numpy as np

from dem.slides.slip import compare
from meshes.errors import NoAnswerError
from workflow.config import Config
from workflow.results.answer import line
from workflow.results.continuum import FemAnswer
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.discs import SlipSurfaces
from workflow.results.stored_mesh import fem_mesh
from workflow.run.store import Store


def slip_surfaces(config: Config, store: Store, before: np.ndarray, after: np.ndarray, fem: FemAnswer) -> SlipSurfaces:
    """Slip surfaces of the discs and of the continuum, and their agreement.

    ``before``, ``after``: of the discs before and after calibration, (k, 2) points [x, elevation] in m. The slip
    surface of the continuum is that of the FEM counterpart of soil discs, else that of the last state of its path.
    ``config``: of the run; ``store``: its folder; ``fem``: answer of the finite elements.
    """
    soil = config.dem.model == "soil"
    of_fem = [state.slip_surface for state in fem.states if state.slip_surface]
    surface = DemCounterpart.read(store).slip_surface if soil else of_fem[-1] if of_fem else ()
    continuum = np.array(surface).reshape(-1, 2)
    agreement = compare(config.section, after, continuum)
    deeper = agreement is not None and agreement.mean_height_m > 0.0
    return SlipSurfaces(
        dem=line(after),
        dem_before=line(before),
        fem=line(continuum),
        mean_distance_m=agreement.mean_distance_m if agreement else None,
        same_stratum_share=agreement.same_stratum_share if agreement else None,
        columns=agreement.columns if agreement else None,
        excess_above=_excess_above(config, store, after, fem) if deeper else None,
    )


def _excess_above(config: Config, store: Store, line: np.ndarray, fem: FemAnswer) -> float | None:
    """Relative increase of the critical Kh if the continuum can fail only above the line; None without an answer."""
    from mpi4py import MPI

    from fem.search.prescribed_surface import critical_above

    mesh = fem_mesh(config.section, store, fem.mesh.method)
    like = DemCounterpart.read(store) if config.dem.model == "soil" else DemCounterpart.of(fem)
    depth = like.deeper_than_m or config.fem.least_depth
    settings = config.fem.changed(sides=like.sides, direction=fem.direction, least_depth=depth)
    try:
        excess = critical_above(config.section, mesh, settings, line, MPI.COMM_SELF).excess
    except NoAnswerError:
        return None
    return excess if np.isfinite(excess) else None
