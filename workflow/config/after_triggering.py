"""Completes settings by analyses: strata that liquefy, their residual strength, and the Kh of slides."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from dem.case import Case, cases_of_loose_sand
from dem.settings import SlideSettings
from meshes.errors import InputError
from meshes.section.cutting import key_in_file
from meshes.section.liquefies import Cases
from meshes.section.overburden import reaches_water
from meshes.section.section import Section
from workflow.config import K_MAX, Config
from workflow.earthquake.column import column_of
from workflow.earthquake.settings import SHAKES, SiteResponseSettings, assumed_loading, loading_of_slides
from workflow.earthquake.triggering.assessment import TriggeringAssessment, assess
from workflow.earthquake.triggering.consequences import pore_pressures, residual_strengths
from workflow.earthquake.triggering.settings import TriggeringSettings

# Tests in borings that a method of triggering uses.
TESTS: Mapping[Literal["spt", "cpt"], str] = {"spt": "blow count", "cpt": "cone test"}


def config_after_triggering(config: Config, source: str = "section") -> Config:
    """Complete a config by triggering analysis, site response and earthquake.

    Parameters
    ----------
    config : the config as read from the file
    source : file from which the config was read; error messages name it

    Returns
    -------
    The config with all values that follow from borings and earthquake: strata that liquefy in all cases, excess
    pore pressure ratios of other strata, cases of the slides, and a numerical Kh.

    Raises
    ------
    InputError : with every problem of borings, earthquake or site response
    """
    try:
        return _analysed(config)
    except InputError as error:
        raise error.of_file(config.section.name, Path(source)) from None


def load_config(path: Path, overrides: Mapping[str, Mapping[str, Any]] | None = None) -> Config:
    """Read a section file, and complete it by triggering analysis, site response and earthquake.

    Parameters
    ----------
    path : the section file; errors name it
    overrides : settings of the command line, as for `Config.load`

    Returns
    -------
    The config with all values that follow from borings and earthquake, see `config_after_triggering`.

    Raises
    ------
    InputError : with every problem of the file, or of its borings, earthquake or site response
    """
    return config_after_triggering(Config.load(path, overrides), str(path))


def _analysed(config: Config) -> Config:
    slide, of_the_earthquake = _driven(config)
    section, cases = config.section, list[Case]()
    triggered = any(stratum.liquefies_in.triggered for stratum in section.strata)
    if config.triggering.cases or config.triggering.pore_pressure or triggered:
        assessment = assess(section, config.earthquake, config.triggering)
        count = len(slide.cases) + len(config.triggering.cases)
        section = ground_after_triggering(section, assessment, config.triggering, count)
        cases = cases_after_triggering(section, assessment, config.triggering)
    return config.analysed(section, _assumed(config, section, slide), cases, of_the_earthquake)


def ground_after_triggering(
    section: Section, assessment: TriggeringAssessment, settings: TriggeringSettings, cases: int
) -> Section:
    """Return the section in which each triggered stratum liquefies in all ``cases`` or in none, with excess pore
    pressures.

    ``assessment``: answer of triggering; ``settings``: settings of triggering. Raises InputError for triggered strata
    below water in which no boring has a test that the method uses.
    """
    pairs = list(zip(section.strata, assessment.strata, strict=True))
    test = TESTS[assessment.relation.kind]
    message = f'liquefies_in = "triggered": no boring has a {test} in it; expected one, or cases, [] for none'
    untested = [
        f"{key_in_file(section.strata, k)}, {message}"
        for k, (stratum, stratum_answer) in enumerate(pairs)
        if stratum.liquefies_in.triggered and stratum_answer.share is None and reaches_water(section, k)
    ]
    if untested:
        raise InputError(section.name, untested)
    numbers = range(1, cases + 1)
    strata = [
        stratum.model_copy(update={"liquefies_in": Cases(numbers if stratum_answer.liquefies else (), triggered=True)})
        if stratum.liquefies_in.triggered
        else stratum
        for stratum, stratum_answer in pairs
    ]
    if settings.pore_pressure:
        strata = [
            stratum
            if stratum.liquefies_in or stratum.excess_pore_pressure_ratio
            else stratum.model_copy(update={"excess_pore_pressure_ratio": ratio})
            for stratum, ratio in zip(strata, pore_pressures(assessment, len(strata)), strict=True)
        ]
    return section.with_strata(strata)


def cases_after_triggering(
    section: Section, assessment: TriggeringAssessment, settings: TriggeringSettings
) -> list[Case]:
    """Return the cases that follow from borings, by their names."""
    strata = section.strata
    remains = [layer for layer in residual_strengths(assessment, settings) if strata[layer.stratum].liquefies_in]
    drained = min(0.2, max((layer.volumetric_strain for layer in remains), default=0.0))
    potential = {strata[layer.stratum].name: layer.strain_potential for layer in remains}
    cases = []
    for name in settings.cases:
        if settings.residual == "ratio":
            remaining_strength: dict[str, Any] = {
                "residual": {strata[layer.stratum].name: layer.ratio(name) for layer in remains}
            }
        else:
            remaining_strength = {
                "residual_strength": {strata[layer.stratum].name: layer.strength(name) for layer in remains}
            }
        cases.append(Case(name=name, volumetric_strain=drained, strain_potential=potential, **remaining_strength))
    return cases


def average_kh(section: Section, response: SiteResponseSettings) -> float:
    """Return k_max of the soil above the slip surface (Makdisi & Seed 1978); raise InputError without a record or a
    depth."""
    if not response.record or response.slip_depth is None:
        message = f'slide, kh = "{K_MAX}": expected record and slip_depth in [site_response], or a number'
        raise InputError(section.name, [message])
    return round(column_of(section, response).k_max(float(response.slip_depth)), 4)


def _driven(config: Config) -> tuple[SlideSettings, list[str]]:
    """Return the settings of the slides with a numerical Kh, and the keys that the earthquake determines."""
    written = {key: getattr(config.slide, key) for key in config.slide.model_fields_set} | config.left_open
    if written.get("kh") == K_MAX:
        written["kh"] = average_kh(config.section, config.site_response)
    numbers = loading_of_slides(config.earthquake, written, config.section.name)
    return SlideSettings.model_validate({**written, **numbers}), list(numbers)


def _assumed(config: Config, section: Section, slide: SlideSettings) -> SlideSettings:
    """Return the settings of the slides. If ground liquefies and the input gives no values, they have assumed values.

    ``config``: config as read from the file; ``section``: the section after triggering; ``slide``: settings after the
    earthquake.
    """
    if not section.liquefies or config.dem.model != "soil":
        return slide
    if "cases" not in config.slide.model_fields_set:
        slide = slide.changed(cases=cases_of_loose_sand(section))
    settings_present = slide.model_fields_set | config.left_open.keys()
    return slide if settings_present & set(SHAKES) else slide.changed(**assumed_loading(config.earthquake.magnitude))
