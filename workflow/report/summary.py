"""Writes summary.json: the results of all stages."""

from collections.abc import Iterator

from workflow.report.crests import crest_parts
from workflow.report.first_page import conclusions, headlines
from workflow.report.paper import rows
from workflow.report.second_opinion import agreeing, contradicting, second_opinions
from workflow.report.structures import face_rows
from workflow.report.summary_text import findings
from workflow.report.verdicts import verdict_paragraph, verdicts
from workflow.report.warnings import warnings
from workflow.results.answer import SectionLabel
from workflow.results.cases import CaseAnswer, CaseNumbers, CaseSummary
from workflow.results.continuum import MeshCount
from workflow.results.governing import (
    estimates_of,
    faces_with_bounds,
    governing_factor,
    governing_kh,
)
from workflow.results.results import Results
from workflow.results.stored_mesh import stored_mesh
from workflow.results.summary import (
    BoundsSummary,
    CircleSummary,
    DemSummary,
    EstimateSummary,
    FaceSummary,
    Factor,
    FailureSummary,
    FemSummary,
    MadeWith,
    NoAnswer,
    PaperModel,
    SafetySummary,
    Summary,
    VariantSummary,
)
from workflow.run.log import machine, versions
from workflow.texts.report_texts import Texts


def summary(results: Results, report_seconds: float) -> Summary:
    """Gather the results of all stages for summary.json.

    Parameters
    ----------
    results : results of all stages
    report_seconds : computing time of the report so far (s)

    Returns
    -------
    The summary; parts of stages without an answer are None.
    """
    config = results.config
    springs, cases = results.case_set()
    paper = tuple(rows(results))
    judged, opinions = verdicts(results), second_opinions(results.cases, results.mpm)
    texts = Texts(config.report.language)
    numbers = headlines(results, texts)
    short = [part.conclusion for part in numbers]
    return Summary(
        headlines=numbers,
        in_short=(
            *short,
            *verdict_paragraph(judged, texts, results.config.section.liquefies),
            *conclusions(results, texts),
        ),
        findings=(*findings(results), *agreeing(opinions)),
        warnings=(*contradicting(opinions), *warnings(results)),
        section=SectionLabel.of(config.section),
        mesh=_mesh(results),
        fem=_fem(results),
        fails_at_rest=results.failure is not None or results.fails_at_rest,
        failure=None if results.failure is None else FailureSummary.taken(results.failure),
        fem_variants=_variants(results),
        bounds=None if results.bounds is None else BoundsSummary.model_validate(results.bounds),
        slices=None if results.slices is None else CircleSummary.of(results.slices) or None,
        structures=tuple(_faces(results)) or None,
        crests=tuple(crest_parts(results.config, results.cases, results.mpm)) or None,
        criteria=tuple(judged) or None,
        dem=_dem(results),
        cases=_summaries(results, cases) or None,
        cases_springs=springs if cases else None,
        cases_table2=_numbers(results.printed_cases) or None,
        paper_model=_paper_model(results, results.printed_cases),
        cases_random=results.cases.random if results.cases is not None else None,
        cases_mpm=results.mpm.cases if results.mpm is not None else None,
        triggering=results.triggering.strata if results.triggering is not None else None,
        residual=results.residual.steps if results.residual is not None else None,
        liquefied=results.liquefied.cases if results.liquefied is not None else None,
        comparison=tuple(EstimateSummary.model_validate(part) for part in estimates_of(results)),
        paper=paper or None,
        no_answer={
            stage: NoAnswer.model_validate(entry)
            for stage in results.ends
            if (entry := results.no_answer(stage)) is not None
        },
        seconds={name: entry.seconds for name, entry in results.ends.items()} | {"report": round(report_seconds, 2)},
        made_with=MadeWith(versions=versions(), **machine()),
    )


def _paper_model(results: Results, cases: dict[int, CaseAnswer]) -> PaperModel | None:
    if results.dem is None or results.dem.paper is None:
        return None
    return PaperModel(kc=results.dem.paper.search.kc, cases=_numbers(cases))


def _faces(results: Results) -> Iterator[FaceSummary]:
    faces = faces_with_bounds(results)
    for row in face_rows(results.config, results.slices, faces):
        yield FaceSummary.taken(
            row.face,
            factors={kh: value for kh, value in row.factors if value is not None},
            kc=row.kc,
            block_slide_m=None if row.block is None else (row.block.low, row.block.high),
            elements=None if faces is None else faces.of(row.face.structure, row.face.towards),
        )


def _numbers(cases: dict[int, CaseAnswer]) -> dict[int, CaseNumbers]:
    return {number: cases[number].numbers for number in sorted(cases)}


def _summaries(results: Results, cases: dict[int, CaseAnswer]) -> dict[int, CaseSummary]:
    """Return the numbers of every case, with the mean and interval of its largest slide over several packings."""
    random = results.cases.random if results.cases is not None else None
    summaries = {}
    for number, numbers in _numbers(cases).items():
        spread = random.cases[number].slide_max_m if random is not None and number in random.cases else None
        interval = {} if spread is None or len(spread.values) < 2 else {
            "seeds": len(spread.values), "slide_max_m_mean": spread.mean, "slide_max_m_ci95": spread.mean_ci95
        }  # fmt: skip
        summaries[number] = CaseSummary.model_validate({**dict(numbers), **interval})
    return summaries


def _mesh(results: Results) -> MeshCount | None:
    if results.fem is not None:
        return results.fem.mesh
    if "mesh" not in results.ends or results.no_answer("mesh"):
        return None
    return MeshCount.of(stored_mesh(results.config.section, results.store))


def _fem(results: Results) -> FemSummary | None:
    """Return the summary of the finite elements. Without a verdict there is no critical Kh, only the largest Kh in
    equilibrium.
    """
    answer = results.fem
    if answer is None:
        return None
    has_kc, governing = results.kc is not None, governing_kh(results)
    return FemSummary.taken(
        answer,
        kc_governing=None if governing is None else governing.value,
        kc=answer.kc if has_kc else None,
        kc_upper=answer.kc_upper if has_kc else None,
        dilation="psi = phi" if answer.flow == "associated" else answer.dilation_deg,
        kc_davis=answer.davis.kc if has_kc and answer.davis is not None else None,
        kc_associated=answer.associated.kc if has_kc and answer.associated is not None else None,
        safety_factors=tuple(
            SafetySummary.taken(factor, governing=governing_factor(results, factor)) for factor in answer.safety_factors
        ),
        after_shaking=None
        if (after := answer.after_shaking) is None
        else SafetySummary.taken(after, governing=governing_factor(results, after)),
        sides=answer.settings.sides,
    )


def _variants(results: Results) -> dict[str, VariantSummary] | None:
    if results.variants is None:
        return None
    return {variant.name: VariantSummary.model_validate(variant) for variant in results.variants.variants}


def _dem(results: Results) -> DemSummary | None:
    """Return the summary of the discs. If there was a calibration, the verdict is the verdict of the calibration, else
    the verdict of the search for the critical Kh.
    """
    discs, calibration = results.dem, results.calibration
    if discs is None:
        return None
    calibrated = None if calibration is None else Factor(parameter=calibration.parameter, value=calibration.value)
    counterpart = results.dem_counterpart if discs.model.discs == "soil" else None
    strength = calibration is not None and calibration.parameter == "strength"
    fem = results.fem
    return DemSummary.taken(
        discs.after,
        model=discs.model.discs,
        sides="" if fem is None else counterpart.sides if counterpart else fem.settings.sides,
        kc_uncalibrated=discs.before.kc,
        kc_target=None if calibration is None else calibration.target_kc,
        strength_factor=calibration.value if strength and calibration is not None else None,
        slip_surface_distance_m=discs.slip_surface.mean_distance_m,
        layers=() if calibration is None else calibration.layers,
        elements=discs.model.elements,
        boundary_elements=discs.model.boundary_elements,
        kc_table2=discs.kc_table2,
        calibrated=calibrated,
        verdict=discs.after.verdict if calibration is None else calibration.verdict,
    )
