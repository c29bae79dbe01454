"""Defines the stage `fem`: the critical seismic coefficient of a meshed section, its files and its pictures."""

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fem.continuum.strength import Flow
from fem.errors import UnstableError
from fem.search.result_warnings import contradict_answer
from meshes.errors import NoAnswerError
from meshes.section.section import Section
from workflow.config import Config
from workflow.results.answer import Line, SectionLabel, line
from workflow.results.continuum import (
    FactorOfSafety,
    FailureAnswer,
    FemAnswer,
    Gravity,
    MeshCount,
    MeshStep,
    OtherCriticalKh,
    OwnDilationPart,
    ShallowFailurePart,
    StoredState,
    Variant,
)
from workflow.results.stored_mesh import FEM_FILE, PATH_FILE
from workflow.run.progress import Progress
from workflow.run.ranks import Ranks
from workflow.run.stage import Job, Stage
from workflow.run.store import Store

if TYPE_CHECKING:
    from fem.continuum.fields import FieldState
    from fem.path.equilibrium_path import EquilibriumPath
    from fem.search.assessment import Assessment
    from fem.search.critical import CriticalResult
    from fem.search.mesh_sequence import AdaptiveResult
    from fem.search.strength_reduction import SafetyFactor
    from meshes.quad_mesh import QuadMesh


def help_compute(job: Job, ranks: Ranks) -> None:
    """Compute the share of an MPI rank in the finite element analysis; for every rank but the first.

    The rank waits until the first one calls it, and returns at once if the first one releases it.

    Parameters
    ----------
    job : section, settings and folder, as on the first rank
    ranks : MPI ranks of the program
    """
    if ranks.called():
        work(job)


def draw(job: Job) -> None:
    """Draw the curve, and the fields at every recorded Kh, or the slip surface of ground that fails at rest."""
    from workflow.figures.fem import draw_all, draw_failure
    from workflow.results.fem_states import FemResults

    if job.store.has(FailureAnswer.FILE):
        draw_failure(job.config, FailureAnswer.read(job.store), job.store)
        return
    draw_all(job.config, FemResults.load(job.config.section, job.store), job.store)


def work(job: Job) -> None:
    """Find the critical Kh in both directions, with ψ = φ and by Davis's estimate, and factors of safety; writes fem/.

    Every MPI rank computes; only the first one writes. Raises InputError, UnstableError, NoEquilibriumError, and, when
    all is written, NoAnswerError if the equilibrium path showed no limit load.
    """
    from fem.search.assessment import assess
    from meshes.quad_mesh import save
    from workflow.results.stored_mesh import stored_mesh

    config, store, progress, ranks = job.config, job.store, job.progress, job.ranks or Ranks()
    mesh = stored_mesh(config.section, store)
    if ranks.is_first:
        store.remove([FailureAnswer.FILE])  # that of an earlier input
        ranks.call()

    def tell(what: str, path: "EquilibriumPath | None") -> None:
        if path is None:
            progress(what, None)
            return
        step = path.steps[-1]
        progress(
            f"step {len(path.steps)}, {what} = {path.factor:.4f}, displacement {path.displacement:.4f} m, "
            f"{step.iterations} iterations, {100 * step.plastic_share:.0f} % plastic",
            None,
        )

    progress("gravity", None)
    try:
        assessment = assess(config.section, config.mesh, mesh, config.fem, ranks.comm, tell)
    except UnstableError as error:
        if error.at_rest is not None and ranks.is_first:
            line_of_slip = line(error.at_rest.slip_surface)
            FailureAnswer.taken(
                error.at_rest, section=SectionLabel.of(config.section), slip_surface=line_of_slip
            ).write(store)
        raise
    result = assessment.critical
    if ranks.is_first:
        with store.writing(FEM_FILE) as path:
            save(assessment.mesh, path)
        with store.writing(PATH_FILE) as path:
            save(assessment.path_mesh, path)
        cracked = without_tensile_strength(config, assessment, progress) if ranks.comm.size == 1 else None
        answer_of(config, assessment).model_copy(update={"without_tension": cracked}).write(store)
        write_fields(config.section, assessment.path_mesh, result.states, store)
        progress(f"critical Kh = {result.kc:.4f}", None)
    if result.verdict == "undecided":
        raise NoAnswerError(f"the finite elements found no limit load: {result.reason}", result.remedy)


def without_tensile_strength(config: Config, assessment: "Assessment", progress: Progress) -> Variant | None:
    """Return the critical Kh without tensile strength, on the first mesh that is adapted to the mechanism, where it
    costs a tenth of the last one; None without a limit load, or if the ground has no tensile strength."""
    from workflow.stages.variants import Change, changed, variant

    adapted = assessment.adapted
    first = adapted.earlier[0] if adapted is not None and adapted.earlier else adapted
    if first is None or first.result.verdict != "plateau" or not first.result.kc > 0.0:
        return None
    one_way = config.with_settings("fem", direction=first.result.direction)
    if (change := changed(one_way, "tension", assessment.critical.element)) is None:
        return None
    name, words, with_it = change
    return variant(
        Change(name, words, with_it, first.mesh, False, first.result.kc),
        lambda text: progress(f"{words}: {text}", None),
    )


def _slip_line(mesh: "QuadMesh", state: "FieldState") -> Line:
    from fem.search.slip_surface import slip_surface

    return line(slip_surface(mesh, state))


def answer_of(config: Config, assessment: "Assessment") -> FemAnswer:
    """Return the answer: critical Kh with its alternatives, path, stored states, and factors of safety."""
    from fem.continuum.shallow_failure import merged_faces
    from fem.search.mesh_sequence import AdaptiveResult

    result, mesh, adapted = assessment.critical, assessment.mesh, assessment.adapted
    rounds = adapted.rounds if adapted and len(adapted.rounds) > 1 else []
    surface = _slip_line(mesh, result.mechanism)
    angles = {s.name: round(float(np.degrees(s.dilation)), 6) for s in config.section.strata}
    return FemAnswer.taken(
        result,
        section=SectionLabel.of(config.section),
        kc_lower=result.lower,
        kc_upper=result.upper,
        judgement="doubtful" if contradict_answer(assessment.warnings) else "sound",
        warnings=tuple(assessment.warnings),
        towards="right" if result.sign > 0 else "left",
        at_sides=_at_sides(AdaptiveResult(result, mesh)),
        opposite=_other_way(assessment.opposite),
        associated=_other_way(assessment.associated),
        davis=_other_way(assessment.davis),
        own_dilation=OwnDilationPart.taken(assessment.own_dilation) if assessment.own_dilation else None,
        shallow_failures=tuple(
            ShallowFailurePart.taken(
                face, start_x_m=face.start, end_x_m=face.end, angle_deg=float(np.degrees(face.angle))
            )
            for face in merged_faces(result.shallow_failures)
        ),
        settings=config.fem,
        dilation_deg=angles,
        mesh=MeshCount.of(mesh),
        meshes=tuple(MeshStep(cells=step.cells, kc=step.value) for step in rounds),
        meshes_ended=adapted.reason if adapted and rounds else "",
        kc_limit=adapted.limit if adapted and rounds else None,
        gravity=Gravity(iterations=result.gravity_iterations, plastic_share=result.gravity_plastic_share),
        linear_solves=result.solves,
        curve=tuple(result.steps),
        states=tuple(_stored_state(assessment.path_mesh, state, result, surface) for state in result.states),
        safety_factors=tuple(_factor_of_safety(factor, result.flow) for factor in assessment.safety),
        after_shaking=_factor_of_safety(after, result.flow, True) if (after := assessment.after_shaking) else None,
    )


def _other_way(adapted: "AdaptiveResult[Any] | None") -> OtherCriticalKh | None:
    if adapted is None:
        return None
    result = adapted.result
    meshes = max(len(adapted.rounds), 1)
    return OtherCriticalKh.taken(result, kc_upper=result.upper, at_sides=_at_sides(adapted), meshes=meshes)


def _at_sides(adapted: "AdaptiveResult[Any]") -> tuple[str, ...]:
    """Return the sides of the section that the failing ground reaches; none if the ground does not fail."""
    return adapted.at_sides if adapted.result.verdict in ("plateau", "peak") else ()


def _stored_state(mesh: "QuadMesh", state: "FieldState", result: "CriticalResult", surface: Line) -> StoredState:
    """Return a state without its fields, and with the slip surface if the ground slips: before failure the ground only
    deforms."""
    return StoredState.taken(
        state,
        largest_displacement_m=float(np.hypot(*state.displacement.T).max()),
        failed_share_by_stratum={
            name: float(np.mean(state.failed[mesh.stratum == k])) for k, name in enumerate(mesh.strata)
        },
        slip_surface=surface if state.past_equilibrium or state.kh >= result.lower else (),
    )


def _factor_of_safety(
    adapted: "AdaptiveResult[SafetyFactor]", flow: Flow, after_shaking: bool = False
) -> FactorOfSafety:
    from fem.search.slip_surface import moving_ground

    result, remaining_error = adapted.result, adapted.rounds[-1].remaining_error if adapted.rounds else np.inf
    return FactorOfSafety.taken(
        result,
        curve=tuple(result.steps),
        davis=result.by_other_flow if flow == "associated" else None,
        associated=result.by_other_flow if flow == "davis" else None,
        remaining_error=float(remaining_error) if np.isfinite(remaining_error) else None,
        slip_surface=_slip_line(adapted.mesh, result.mechanism) if result.mechanism is not None else (),
        slides_to=_sides_of(adapted),
        extent_m=moving_ground(adapted.mesh, result.mechanism) if result.mechanism is not None else None,
        after_shaking=after_shaking,
    )


def _sides_of(adapted: "AdaptiveResult[SafetyFactor]") -> tuple[Literal["left", "right"], ...]:
    """Return the sides to which the ground slides at its factor of safety; none without a mechanism."""
    from fem.continuum.fields import sliding_sides

    mechanism = adapted.result.mechanism
    if mechanism is None:
        return ()
    return tuple("left" if side < 0 else "right" for side in sliding_sides(adapted.mesh, mechanism))


def write_fields(section: Section, mesh: "QuadMesh", states: list["FieldState"], store: Store) -> None:
    """Write fem/fields.pvd with one .vtu file for every state of equilibrium, and for the last one of the path.

    ``section``: the section of the ground; ``mesh``: a mesh of the section; ``states``: states with their fields;
    ``store``: the folder of the run.
    """
    from workflow.results.fem_states import COLLECTION, fields_file
    from workflow.results.mesh_grids import grid_of

    entries = []
    for number, state in enumerate(state for state in states if not state.past_equilibrium):
        grid = grid_of(section, mesh)
        grid.add_to_points("displacement_m", np.column_stack([state.displacement, np.zeros(len(mesh.points))]))
        grid.add_to_cells("stress_xx_yy_zz_xy_Pa", state.stress)
        grid.add_to_cells("mobilised_strength", state.mobilised)
        grid.add_to_cells("shear_strain", state.shear_strain)
        grid.add_to_cells("plastic_shear_strain", state.plastic_shear_strain)
        grid.add_texts("state", [state.label])
        store.write_grid(f"fem/{fields_file(number)}", grid)
        entries.append((state.kh, fields_file(number)))
    store.write_collection(COLLECTION, entries)
    stored = {f"fem/{fields_file(number)}" for number in range(len(entries))}
    store.remove(sorted(set(store.matching(["fem/fields_*.vtu"])) - stored))


STAGE = Stage(
    name="fem",
    description="critical Kh by finite elements",
    work=work,
    draw=draw,
    drawn_after=True,
    needs=("mesh",),
    reads=("fem",),
    ignores=lambda config: ("fem.threads", "fem.rigid_box"),
    adds=("fem.safety_factor_at",),
    results=(FemAnswer.FILE, FailureAnswer.FILE, FEM_FILE, PATH_FILE, "fem/fields.pvd", "fem/fields_*.vtu"),
    read=FemAnswer.read,
    pictures=("figures/fem_*.png",),
)
