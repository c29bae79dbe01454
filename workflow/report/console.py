"""States the results of the stages in sentences, which commands print."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from fem.search.result_warnings import difference_words
from meshes.section.cutting import shown_name
from meshes.section.section import Section
from meshes.slip_line import extent_in_words
from workflow.config import Config, notice_lines
from workflow.earthquake.site_response import TOLERANCE as CAME_TO_REST
from workflow.estimates.crest import embankments
from workflow.report import post_liquefaction
from workflow.report.at_rest import failure_at_rest, is_same_after_shaking, when_words
from workflow.report.bounds_text import bounds_sentences, edge_sentence, face_words, failing_at
from workflow.report.contradictions import FALL_RATIO, SURFACE_FALL
from workflow.report.crests import crest_parts, crest_sentences
from workflow.report.faces import faces_sentences
from workflow.report.flow_rule import (
    WHEN,
    critical_with_flow,
    how_to_get_own_dilation,
    own_dilation_sentences,
    with_flow,
)
from workflow.report.numbers import coefficient, range_of, range_sentence, rough_coefficient, span, strict_words
from workflow.report.residual import residual_sentences
from workflow.report.second_opinion import agreeing, contradicting, second_opinions
from workflow.report.slices import contradicted_circles, slices_sentences
from workflow.report.structures import structure_sentences
from workflow.report.summary_text import lies_still, moved_lately
from workflow.report.tables import case_heads, case_rows
from workflow.report.triggering import triggering_sentences
from workflow.report.warnings import sides_warning, split_warning, tension_warning
from workflow.results.accuracy import accuracy, of_meshes, remaining_error, strict_factor, strict_kh
from workflow.results.answer import FORCE, SectionLabel, way_out
from workflow.results.bounds import BoundsAnswer, SafetyPart
from workflow.results.calibration import CalibrationAnswer
from workflow.results.cases import CasesAnswer
from workflow.results.continuum import FactorOfSafety, FemAnswer
from workflow.results.faces import FacesAnswer
from workflow.results.governing import governing_factor, governing_kh, governing_value
from workflow.results.lengths import metres
from workflow.results.material_points import PointSlidesAnswer
from workflow.results.results import Results
from workflow.results.site_response import SiteResponseAnswer
from workflow.results.slices import SlicesAnswer
from workflow.results.stability import LiquefiedAnswer, ResidualAnswer
from workflow.results.stored_mesh import stored_mesh
from workflow.results.summary import Summary
from workflow.results.triggering import TriggeringAnswer
from workflow.run.store import Store

REPORTED_ERROR = 5e-4  # of a factor of safety: smaller discretisation errors are not reported


def mesh_sentences(config: Config, store: Store) -> Iterator[str]:
    """Return the number of cells and the quality of the mesh, and notices on the ground, in sentences."""
    mesh = stored_mesh(config.section, store)
    quality = mesh.quality()
    yield (
        f"{quality.quadrilaterals} quadrilaterals, {quality.nodes} nodes ({mesh.method}). "
        f"Smallest scaled Jacobian {quality.smallest_scaled_jacobian:.3f}, angles from {quality.smallest_angle:.0f}° "
        f"to {quality.largest_angle:.0f}°, "
        f"largest aspect ratio {quality.largest_aspect_ratio:.2f}."
    )
    if (flow := config.section.water_pressure.flow) is not None:
        yield flow.description
    yield from notice_lines(config.notices_of_ground)


def fem_sentences(
    answer: FemAnswer, section: Section, every: bool = True, results: Results | None = None
) -> Iterator[str]:
    """Yield sentences on the critical Kh with its interval, and the factors of safety, from fem/critical.json.

    ``answer``: the result of the finite elements; ``section``: the ground, for names of its strata. With ``every`` also
    details: the end of the path, the sequence of meshes, and the use of Davis's estimate. If there
    is no limit load, the reason is always stated. Strict bounds among the ``results`` are part of the interval.
    """
    error = accuracy(results, answer) if results is not None else of_meshes(answer)
    governing = governing_kh(results) if results is not None else None
    interval = f" {range_sentence(answer, error)}" if error is not None else ""
    surface = next((state.slip_surface for state in reversed(answer.states) if state.slip_surface), ())
    where = f" The ground {extent_in_words(np.array(surface))}." if surface and answer.has_kc else ""
    how = ""
    if every or answer.end_reason not in ("plateau", "limit load"):
        most = f", at most {coefficient(answer.kc_upper)} on this mesh" if answer.kc_upper > answer.kc else ""
        how = f"; {answer.reason}" if answer.by_limit_analysis else f": {answer.end_reason}{most}, {answer.reason}"
    if results is not None and results.fails_at_rest:
        yield f"No critical Kh. {failure_at_rest(results)}"
    elif governing is not None and (strict_part := governing.opposite_bounds) is not None:
        yield (
            f"Critical Kh {critical_with_flow(answer, coefficient, governing)}. The seismic force acts "
            f"{FORCE[strict_part.direction]}, to the {strict_part.towards}, where the strict upper bound counts: "
            f"the finite elements give {coefficient(answer.kc)} {FORCE[answer.direction]}.{where}"
        )
    else:
        yield (
            f"Critical Kh {critical_with_flow(answer, coefficient, governing)}.{how_to_get_own_dilation(answer)} The "
            f"seismic force acts {FORCE[answer.direction]}, to the {answer.towards}{how}.{where}{interval}"
        )
    if every:
        if answer.davis is not None or answer.associated is not None:
            yield WHEN
        yield from meshes_sentences(answer, results)
    yield from own_dilation_sentences(answer)
    yield from comparison_sentences(answer, results)
    for factor in answer.safety_factors if is_same_after_shaking(answer) else answer.factors:
        strict = strict_factor(results, answer, factor, answer.flow) if results is not None else None
        counts = factor.factor if results is None else governing_factor(results, factor)
        yield safety_sentence(factor, answer, every, strict, counts)
    # What lies beyond a bound by no more than the error of its mesh is part of the sentences on this quantity.
    by_bounds = [] if results is None else results.warnings_by_bounds()
    by_bounds = [warning for warning in by_bounds if warning.contradiction or answer.flow != "associated"]
    for warning in (*answer.warnings, *by_bounds):
        kind = "Contradiction" if warning.contradiction else "Warning"
        yield f"{kind}: {warning.observation} To do: {warning.remedy}."
    variants = results.variants.variants if results is not None and results.variants is not None else ()
    for _, text in (*sides_warning(answer, section), *tension_warning(answer, variants, section)):
        yield "Warning: {} To do: {}".format(*split_warning(text))


def safety_sentence(
    factor: FactorOfSafety,
    answer: FemAnswer,
    every: bool = True,
    strict: SafetyPart | None = None,
    governing: float | None = None,
) -> str:
    """Return a factor of safety and the extent of its slip surface; with ``every`` also details of its computation.

    ``answer``: result of the finite elements that computed it; ``strict``: strict bounds of the factor, which limit the
    error by the mesh; ``governing``: the factor that counts, by default that of the finite elements.
    """
    most = f", on this mesh at most {factor.upper:.3f}" if factor.upper > factor.factor else ""
    mesh_error = (
        f", with a mesh error of {100 * factor.remaining_error:.1f} % or less"
        if factor.remaining_error is not None
        else ""
    )
    compared = factor.davis if factor.davis is not None else factor.associated
    governing = factor.factor if governing is None else governing
    number = with_flow(governing, answer.flow, compared, answer.estimate, "{:.3f}".format)
    if factor.verdict == "no failure":  # it is where the search ended, not where the ground fails
        return f"Factor of safety {when_words(factor, answer)}: above {factor.factor:.2g}, where the search ended."
    of_mesh = factor.reason.startswith("the factor of safety")
    end = "This is " if of_mesh else f"{factor.verdict.capitalize()}{most}, "
    phrase = f"Factor of safety {when_words(factor, answer)}: {number}. {end}{factor.reason}{mesh_error}."
    if not every:
        gain = remaining_error(factor, strict) or 0.0 if factor.remaining_error is not None else 0.0
        finer = f" A finer mesh may give {100 * gain:.1f} % less." if gain >= REPORTED_ERROR else ""
        phrase = f"Factor of safety {when_words(factor, answer)}: {number}.{finer}"
    if factor.slip_surface:
        phrase += f" The ground {extent_in_words(np.array(factor.slip_surface))}."
    elif factor.extent_m is not None:
        how = "spreads to both sides" if len(factor.slides_to) > 1 else "moves"
        phrase += f" The ground {how} between x = {factor.extent_m[0]:.1f} and {factor.extent_m[1]:.1f} m."
    if factor.shallow_failure is not None and factor.shallow_failure < factor.factor:
        depth, faces = answer.settings.least_depth, answer.shallow_failures
        edges = bool(faces) and all(face.is_edge(depth) for face in faces)
        face_words = "The edge of a layer without cohesion" if edges else "A cohesionless face"
        phrase += f" {face_words} fails in a shallow failure at a smaller factor, {factor.shallow_failure:.3f}."
    if governing != factor.factor:
        phrase += f" The finite elements give {factor.factor:.3f}, {_beyond(factor.factor, governing)}."
    return phrase


def _beyond(value: float, bound: float) -> str:
    """Return how far a value by finite elements lies beyond the strict bound that counts, in words."""
    side_words = "above the strict upper bound" if value > bound else "below the strict lower bound"
    return f"{difference_words(value, bound)} {side_words}, which is reported"


def meshes_sentences(answer: FemAnswer, results: Results | None = None) -> Iterator[str]:
    """Yield sentences on the critical Kh on every mesh that was adapted to the mechanism; a limit of the sequence
    outside the strict bounds among the ``results`` is none."""
    if answer.meshes:
        phrase = ", ".join(f"{mesh.kc:.4f} ({mesh.cells} cells)" for mesh in answer.meshes)
        strict = strict_kh(results, answer, answer.flow, answer.direction) if results is not None else None
        limit = answer.kc_limit
        outside = limit is not None and strict is not None and governing_value(limit, *strict) != limit
        tends = "" if limit is None or outside else f" The sequence of meshes converges to {limit:.4f}."
        yield f"On meshes adapted to the mechanism the critical Kh is {phrase}."
        yield f"The sequence of meshes ended because {answer.meshes_ended}.{tends}"


def comparison_sentences(answer: FemAnswer, results: Results | None = None) -> Iterator[str]:
    """Yield sentences on the critical Kh in the other direction, within its strict bounds among the ``results``, and
    the shallow failures of cohesionless faces."""
    if answer.associated is not None and answer.associated.at_sides:
        yield f"With ψ = φ the critical Kh is {coefficient(answer.associated.kc)}{way_out(answer.associated.at_sides)}."
    other = answer.opposite
    if other is not None:
        kh = f"{'above ' if other.verdict == 'no failure' else ''}{coefficient(other.kc)}"
        strict = strict_kh(results, answer, answer.flow, other.direction) if results is not None else None
        if strict is not None and other.verdict != "no failure":
            governing = governing_value(other.kc, *strict)
            kh = f"{coefficient(governing)}{strict_words(*strict)}"
            if governing != other.kc:
                kh += f" (the finite elements give {coefficient(other.kc)}, {_beyond(other.kc, governing)})"
        elif answer.is_rough(other):
            kh = f"about {rough_coefficient(other.kc)}, by one mesh"
        yield f"With the seismic force {FORCE[other.direction]} the critical Kh is {kh}{way_out(other.at_sides)}."
    critical = governing_kh(results) if results is not None else None
    whole = coefficient(answer.kc if critical is None else critical.value)
    for face in answer.shallow_failures:
        if face.is_edge(answer.settings.least_depth):
            yield edge_sentence(face.stratum, face.start_x_m, face.end_x_m, face.kh)
            continue
        yield (
            f"{face_words(face.stratum, face.start_x_m, face.end_x_m)} ({face.angle_deg:.0f}°) {failing_at(face.kh)}; "
            f"the slope as a whole fails at {whole}."
        )


def calibrate_sentences(answer: CalibrationAnswer) -> Iterator[str]:
    """Yield sentences on how the discs were calibrated, from dem/calibration.json."""
    if answer.kc is None:
        yield f"The critical Kh of the discs was not found: {answer.verdict}, {answer.reason}."
    elif answer.range is None or answer.target_kc is None:
        yield f"Without calibration the critical Kh of the discs is {_bracket(answer.kc, answer)}: {answer.reason}."
    elif answer.verdict == "calibrated":
        if answer.predicted_kc is not None and answer.predicted_ratio is not None:
            yield (
                f"Without calibration the critical Kh of the discs is {coefficient(answer.predicted_kc)}. This is "
                f"{answer.predicted_ratio:.2f} times the critical Kh of the finite elements with the same boundary "
                "conditions (lower end of its interval)."
            )
        yield (
            f"With the {answer.parameter} of the discs multiplied by {answer.value:.4g} their critical Kh is "
            f"{_bracket(answer.kc, answer)}, for {_target_words(answer, answer.target_kc)}."
        )
    else:
        low, high = answer.range
        yield (
            f"No factor on the {answer.parameter} of the discs from {low:g} to {high:g} gives a critical Kh of "
            f"{coefficient(answer.target_kc)}; the nearest is {coefficient(answer.kc)}, with the factor "
            f"{answer.value:.4g}: {answer.reason}."
        )


def _target_words(answer: CalibrationAnswer, target: float) -> str:
    """Return the target of the calibration in words. The target is a range if the critical Kh of the continuum is a
    range and the critical Kh of the discs lies within it.
    """
    low, high = answer.continuum_kc or (target, target)
    return f"a target of {range_of([low, high] if low < target < high else [target])}"


def _bracket(kc: float, answer: CalibrationAnswer) -> str:
    """Return the critical Kh of the discs with its bracket."""
    upper = kc if answer.kc_upper is None else answer.kc_upper
    return f"{coefficient(kc)} ({range_of([answer.kc_lower, upper])})"


def slide_sentences(config: Config, answer: CasesAnswer) -> Iterator[str]:
    """Yield sentences on the cases and their slides, from dem/cases.json."""
    heads = [name for name, _ in case_heads(config)]
    phrases = []
    for number, layers, *factors in case_rows(config):
        left = [f"{head} {factor}" for head, factor in zip(heads, factors, strict=True) if head != "name"]
        phrases.append(f"{config.called(int(number))}, {layers}: {', '.join(left)}")
    if phrases:
        yield f"Factors and residual strengths of the layers that liquefy: {'; '.join(phrases)}."
    two_faces = bool(embankments(config.section.ground))  # no upslope third: the settlement of the crest counts
    for name, which, case in answer.each():
        settled = "" if case.settled else f"; the slide is not at rest: {case.reason}"
        if not case.settled and lies_still(case):
            settled = f"; it moved {moved_lately([case])} in the last 10 s"
        if case.stopped_by is not None:
            settled += f"; the {case.stopped_by} side of the disc model stopped it"
        fall, x = case.largest_fall
        if fall > max(SURFACE_FALL, FALL_RATIO * abs(case.settlement_uphill_m)):
            settled += f"; the surface falls by {metres(fall)} at x = {x:.0f} m"
        settled += "".join(f"; {note}" for note in case.notes)
        third = (
            ""
            if two_faces
            else f", and the upslope third {case.uphill} by {metres(abs(case.settlement_uphill_m))} (median)"
        )
        yield (
            f"Case {which} ({name}): the largest slide is {metres(case.slide_max_m)} at x = "
            f"{case.slide_max_at_x_m:.0f} m{third}{settled}."
        )
    yield from crest_sentences(crest_parts(config, answer))


def mpm_sentences(config: Config, answer: PointSlidesAnswer) -> Iterator[str]:
    """Yield sentences on the slide of every case by the material point method, from mpm/slides.json."""
    if answer.not_possible:
        yield f"The material point method cannot compute the slides: {answer.not_possible}."
    for number, case in sorted(answer.cases.items()):
        between_ends = span([case.slide_max_low_m, case.slide_max_high_m])
        yield (
            f"{config.called(number)}: by the material point method the largest slide of the surface is "
            f"{between_ends}, and the highest ground is then {case.highest}; {case.reason}."
        )
        yield from (f"- {note}." for note in case.notes)
    yield from crest_sentences(crest_parts(config, points=answer))


def response_sentences(answer: SiteResponseAnswer) -> Iterator[str]:
    """Yield sentences on the response of the layers to the record, from site_response.json."""
    largest = max(answer.layers, key=lambda layer: layer.strain)
    yield (
        f"Under {answer.record} the peak acceleration at x = {answer.x_m:g} m is {answer.peak_rock_gal:.0f} gal on "
        f"rock and {answer.peak_surface_gal:.0f} gal at the surface; the largest shear strain is "
        f"{100.0 * largest.strain:.3g} % in {shown_name(largest.stratum)}, "
        f"{0.5 * (largest.top_m + largest.bottom_m):.1f} m below the ground."
    )
    if answer.change > CAME_TO_REST:
        yield (
            f"Warning: the site response has not converged: after {answer.rounds} iterations one more iteration "
            f"changes G or damping by {100.0 * answer.change:.1f} %."
        )
    if answer.warning:
        yield f"Warning: {answer.warning}."
    bottoms = [layer.bottom_m for layer in answer.layers]
    wanted = [5.0 * k for k in range(1, int(bottoms[-1] / 5.0) + 1)] or bottoms[-1:]
    nearest = dict.fromkeys(min(range(len(bottoms)), key=lambda k: abs(bottoms[k] - depth)) for depth in wanted)
    phrases = (f"{answer.layers[k].k_max:.3f} ({bottoms[k]:.3g} m)" for k in nearest)
    yield f"k_max, the largest average acceleration over g of the ground above a depth, is {', '.join(phrases)}."


def _slides(config: Config, store: Store) -> Iterator[str]:
    """Yield the slides of the discs, compared with the slides of material points of the same section."""
    answer, label = CasesAnswer.read(store), SectionLabel.of(config.section)
    yield from slide_sentences(config, answer)
    if "mpm" in config.slide.methods and (store.folder / PointSlidesAnswer.FILE).is_file():
        points = PointSlidesAnswer.read(store)
        opinions = second_opinions(answer, points if points.section.sha256 == label.sha256 else None)
        yield from (f"Warning: {opinion.observation} {opinion.remedy}" for opinion in contradicting(opinions))
        yield from agreeing(opinions)


def _slices(config: Config, answer: SlicesAnswer, results: Results | None) -> Iterator[str]:
    yield from slices_sentences(answer, config.section.water_pressure.rises_by_shaking)
    yield from contradicted_circles(results) if results is not None else ()
    if config.tension_crack.description:
        yield config.tension_crack.description
    yield from structure_sentences(config, answer)


def sentences(
    name: str,
    config: Config,
    store: Store,
    every: bool = True,
    results: Results | None = None,
    reported: Sequence[str] = (),
) -> Iterator[str]:
    """Yield the result of a stage in sentences.

    Parameters
    ----------
    name : name of the stage
    config : section and settings
    store : folder of the run, in which the stage has an answer
    every : whether details of the finite elements are included
    results : results of the other stages, with which the result is compared; None for no comparison
    reported : stages whose sentences are reported already; their facts are left out

    Returns
    -------
    The sentences; none for a stage that has nothing to say.
    """
    fem = results.fem if results is not None and "fem" in reported else None
    of_stage: dict[str, Callable[[], Iterator[str]]] = {
        "triggering": lambda: triggering_sentences(TriggeringAnswer.read(store)),
        "response": lambda: response_sentences(SiteResponseAnswer.read(store)),
        "residual": lambda: residual_sentences(ResidualAnswer.read(store).steps),
        "liquefied": lambda: post_liquefaction.sentences(LiquefiedAnswer.read(store)),
        "mesh": lambda: mesh_sentences(config, store),
        "fem": lambda: fem_sentences(FemAnswer.read(store), config.section, every, results),
        "bounds": lambda: bounds_sentences(BoundsAnswer.read(store), fem),
        "slices": lambda: _slices(config, SlicesAnswer.read(store), results),
        "faces": lambda: faces_sentences(FacesAnswer.read(store), results),
        "calibrate": lambda: calibrate_sentences(CalibrationAnswer.read(store)),
        "mpm": lambda: mpm_sentences(config, PointSlidesAnswer.read(store)),
        "slide": lambda: _slides(config, store),
        "report": lambda: iter(Summary.read(store).findings),
    }
    return of_stage[name]() if name in of_stage else iter(())
