"""The stage `fem`: the critical seismic coefficient of a meshed section, its files and its pictures."""

import json
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from fem.critical import CriticalResult, critical_coefficient
from fem.fields import State, slip_surface
from fem.path import Walk
from fem.strength_reduction import SafetyFactor, safety_factor
from meshes.quadrilaterals import QuadMesh
from workflow import fem_figures, figures
from workflow.settings import Input
from workflow.store import Store

Progress = Callable[[str, Walk], None]


def fem_stage(
    run: Input, mesh: QuadMesh, store: Store | None, comm: Any, progress: Progress
) -> tuple[CriticalResult, list[SafetyFactor]]:
    """Find the critical Kh, and the factors of safety that are asked for; leaves fem/ and figures/fem_*.png.

    Every rank computes; only the one with a store writes. Raises InputError, UnstableError.
    """
    result = critical_coefficient(run, mesh, run.fem, comm, lambda walk: progress("Kh", walk))
    factors = [
        safety_factor(run, mesh, run.fem, kh, comm, lambda walk: progress("factor of safety", walk))
        for kh in run.fem.safety_factor_at
    ]
    if store is not None:
        store.write_text("fem/critical.json", json.dumps(as_json(run, mesh, result, factors), indent=1) + "\n")
        write_fields(run, mesh, result.states, store)
        fem_figures.draw_all(run, mesh, result, store)
    return result, factors


def as_json(run: Input, mesh: QuadMesh, result: CriticalResult, factors: list[SafetyFactor]) -> dict[str, Any]:
    """What fem/critical.json holds: the answer with its bracket first, then how it was found."""
    return {
        "section": {"name": run.name, "sha256": run.sha256(), "reconstruction": run.reconstruction},
        "kc": result.kc,
        "kc_lower": result.lower,
        "kc_upper": result.upper,
        "verdict": result.verdict,
        "reason": result.reason,
        "remedy": result.remedy,
        "settings": run.fem.model_dump(mode="json"),
        "dilation_deg": {s.name: round(float(np.degrees(s.dilation_angle)), 6) for s in run.strata}
        if run.fem.flow == "section"
        else "equal to the friction angle",
        "mesh": {"quadrilaterals": len(mesh.cells), "nodes": len(mesh.points), "method": mesh.method},
        "gravity": {"iterations": result.gravity_iterations, "plastic_share": result.gravity_plastic_share},
        "linear_solves": result.solves,
        "curve": [asdict(step) for step in result.steps],
        "states": [
            {
                "label": state.label,
                "kh": state.kh,
                "past_equilibrium": state.past_equilibrium,
                "largest_displacement_m": float(np.hypot(*state.displacement.T).max()),
                "failed_share_by_stratum": failed_shares(mesh, state),
                "slip_surface": slip_surface(mesh, state).tolist(),
            }
            for state in result.states
        ],
        "safety_factors": [
            {
                "kh": f.kh,
                "factor": f.factor,
                "upper": f.upper,
                "verdict": f.verdict,
                "reason": f.reason,
                "curve": [asdict(step) for step in f.steps],
            }
            for f in factors
        ],
    }


def failed_shares(mesh: QuadMesh, state: State) -> dict[str, float]:
    """Share of the cells of each stratum that are at failure."""
    return {name: float(np.mean(state.failed[mesh.stratum == k])) for k, name in enumerate(mesh.strata)}


def write_fields(run: Input, mesh: QuadMesh, states: list[State], store: Store) -> None:
    """fem/fields.pvd with one .vtu for every state of equilibrium, and the last one of the path."""
    entries = []
    for number, state in enumerate(state for state in states if not state.past_equilibrium):
        grid = figures.unstructured(mesh)
        grid.point_data["displacement_m"] = np.column_stack([state.displacement, np.zeros(len(mesh.points))])
        grid.cell_data["stress_xx_yy_zz_xy_Pa"] = state.stress
        grid.cell_data["safety_factor"] = state.safety_factor
        grid.cell_data["shear_strain"] = state.shear_strain
        grid.cell_data["plastic_shear_strain"] = state.plastic_shear_strain
        figures.add_texts(grid, "state", [state.label])
        if run.reconstruction:
            figures.add_texts(grid, "reconstruction", [run.reconstruction_note])
        name = f"fields_{number}.vtu"
        store.write_grid(f"fem/{name}", grid)
        entries.append(f'    <DataSet timestep="{state.kh!r}" file="{name}"/>\n')
    collection = "".join(entries)
    store.write_text(
        "fem/fields.pvd",
        f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n{collection}'
        "  </Collection>\n</VTKFile>\n",
    )
