"""Checks an answer: each check returns warnings of contradictions and uncertainties, with remedies.

A check compares answers that are already computed. No check computes a new answer.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from fem.continuum.fields import FieldState
from fem.search.result_warnings import ResultWarning
from meshes.quad_mesh import QuadMesh
from meshes.quality import corner_angles
from meshes.section.uplift import Uplift

if TYPE_CHECKING:
    from fem.limit_load.limit_load import LimitLoadResult
    from fem.search.critical import CriticalResult
    from fem.settings import PathVerdict

# Relative difference of two limit loads of the same mesh and loading that exceeds the accuracy of the solver, which is
# 0.01 % in most cases and 0.1 % in some (``program_accuracy.FEASIBILITY_OF_ELEMENTS``).
SOLVER_ACCURACY = 1e-3
# Corner angle (degrees) below which a cell is a wedge.
NARROW_ANGLE = 15.0
# The mechanism reaches the base if cells at the base have this share of the largest shear strain.
BASE_STRAIN_SHARE = 0.1


def warnings_of(
    result: "CriticalResult", mesh: QuadMesh, associated: "LimitLoadResult | CriticalResult | None" = None
) -> list[ResultWarning]:
    """Return the warnings about a result, alone and compared with the result for ψ = φ."""
    return [
        *of_verdict(result.verdict, result.reason, result.remedy),
        *of_dilation(result, associated),
        *of_base(mesh, result.mechanism, result.verdict),
        *of_cells(mesh),
    ]


def of_uplift(uplift: Uplift | None) -> Iterator[ResultWarning]:
    """Warn of pore pressure above the total vertical stress: only the strength of the ground resists uplift."""
    if uplift is not None:
        yield ResultWarning(
            f"{uplift.description[0].upper()}{uplift.description[1:]}.",
            "check the water levels, or relieve the pressure; until then no answer for this section is valid",
        )


def of_verdict(verdict: "PathVerdict", reason: str, remedy: str) -> Iterator[ResultWarning]:
    """Warn of a path that ended before it reached a limit load."""
    if verdict == "undecided":
        yield ResultWarning(f"The path ended before a limit load was found: {reason}.", remedy)


def of_dilation(
    result: "CriticalResult", associated: "LimitLoadResult | CriticalResult | None"
) -> Iterator[ResultWarning]:
    """Report a contradiction if the critical Kh is above that with ψ = φ: ground that dilates less cannot resist more
    (Radenkovic 1961).
    """
    if associated is None or associated.direction != result.direction:
        return
    if result.kc > (1.0 + SOLVER_ACCURACY) * associated.kc:
        yield ResultWarning(
            f"The critical Kh with ψ < φ, {result.kc:.3f}, is above the critical Kh with ψ = φ, {associated.kc:.3f}.",
            f'take {associated.kc:.3f} as an upper limit, use flow = "davis", or refine the mesh',
        )


def of_base(mesh: QuadMesh, mechanism: FieldState, verdict: "PathVerdict") -> Iterator[ResultWarning]:
    """Warn of a mechanism along the base of the section."""
    if verdict in ("plateau", "peak") and touches_base(mesh, mechanism):
        yield ResultWarning(
            "The slip surface runs along the base of the section: ground below the base might fail at a smaller Kh.",
            "make the section deeper, unless the base is firm rock",
            contradiction=False,
        )


def touches_base(mesh: QuadMesh, mechanism: FieldState) -> bool:
    """Return whether cells at the base strain by a large share of the largest shear strain."""
    at_base = np.isin(mesh.cells, np.unique(mesh.boundaries["base"])).sum(axis=1) >= 2
    return bool(
        at_base.any() and mechanism.shear_strain[at_base].max() > BASE_STRAIN_SHARE * mechanism.shear_strain.max()
    )


def of_cells(mesh: QuadMesh) -> Iterator[ResultWarning]:
    """Warn of cells with a narrow corner, in which displacements are inaccurate."""
    narrowest = np.abs(corner_angles(mesh.points, mesh.cells)).min(axis=1)
    count = int(np.count_nonzero(narrowest < NARROW_ANGLE))
    if count:
        x, z = mesh.points[mesh.cells[int(narrowest.argmin())]].mean(axis=0)
        have = "has" if count == 1 else "have"
        yield ResultWarning(
            f"{count} of {len(mesh.cells)} cells {have} a corner below {NARROW_ANGLE:g}°; the narrowest, "
            f"{narrowest.min():.1f}°, is at x = {x:.1f} m, elevation {z:.1f} m.",
            "let thin layers end in a vertical step in the section file"
            + (', or use mesh.method = "free"' if mesh.method == "mapped" else ""),
            contradiction=False,
        )
