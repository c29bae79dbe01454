"""States the settlement, reconsolidation and freeboard of the crests of structures after every slide."""

from collections.abc import Iterator, Sequence

import numpy as np

from meshes.errors import InputError
from meshes.section.overburden import computed_water_points
from meshes.section.stratum import liquefying_strata
from workflow.config import Config
from workflow.earthquake.triggering.assessment import assess
from workflow.earthquake.triggering.consequences import residual_strengths
from workflow.estimates.crest import Crest, crest_settlement, freeboard, reconsolidation_settlement
from workflow.estimates.structures import CrestedStructure, structures_of
from workflow.report.numbers import signed_span, span
from workflow.report.summary_text import at_rest
from workflow.results.cases import CasesAnswer, Profile
from workflow.results.lengths import metres
from workflow.results.material_points import PointSlidesAnswer
from workflow.results.verdicts import CrestPart
from workflow.texts.report_texts import Texts

Settlements = tuple[float, float, float]  # by the slide: its value, and the interval over packings
NO_DRY_FORESHORE = ("building", "bank", "quay")  # kinds of structures whose free water stands beside them
LEAST_DEPTH = 1e-6  # m, of free water


def crest_parts(
    config: Config, cases: CasesAnswer | None = None, points: PointSlidesAnswer | None = None
) -> Iterator[CrestPart]:
    """Yield the crest of every structure after the slides of the governing set of discs, and of material points."""
    for structure in structures_of(config.section):
        if cases is not None and cases.first_set:
            for number, case in sorted(cases.sets[cases.first_set].items()):
                value = crest_settlement(*case.surfaces, structure.crest)
                random = cases.random.cases.get(number) if cases.random is not None else None
                values = _over_packings(value, None if random is None else random.profile, structure.crest)
                if values is not None:
                    of = f"discs, {config.called(number)}"
                    yield _part(config, structure, of, number, values, at_rest(case))
        for number, point in sorted(points.cases.items()) if points is not None else ():
            value = crest_settlement(*point.surfaces, structure.crest)
            if value is not None:
                method = f"material points, {config.called(number)}"
                yield _part(config, structure, method, number, (value, value, value), at_rest(point))


def _over_packings(value: float | None, profile: Profile | None, crest: Crest) -> Settlements | None:
    """Return the settlement of a slide, and the settlements of the surfaces at both ends of the range of packings."""
    if value is None:
        return None
    ends = [value]
    if profile is not None:
        before = np.column_stack([profile.x, profile.before])
        for after in (profile.after_low, profile.after_high):
            end = crest_settlement(before, np.column_stack([profile.x, after]), crest)
            ends += [] if end is None else [end]
    return value, min(ends), max(ends)


def _part(
    config: Config, structure: CrestedStructure, method: str, case: int, slide: Settlements, at_rest: bool
) -> CrestPart:
    drained = reconsolidation_below(config, structure.crest, case)
    added = 0.0 if config.cases[case - 1].volumetric_strain > 0.0 else drained or 0.0
    value, low, high = (settlement + added for settlement in slide)
    water = water_at_crest(config, structure)
    heights = [
        None if water is None else freeboard(structure.crest.elevation, settlement, water)
        for settlement in (value, high, low)
    ]
    return CrestPart(
        structure=structure.name,
        method=method,
        settlement_m=value,
        settlement_low_m=low,
        settlement_high_m=high,
        reconsolidation_m=drained,
        freeboard_m=heights[0],
        freeboard_low_m=heights[1],
        freeboard_high_m=heights[2],
        water_m=water,
        at_rest=at_rest,
    )


def reconsolidation_below(config: Config, crest: Crest, case: int) -> float | None:
    """Return the settlement (m) of the middle of a crest by drainage of the strata that liquefied in a case; None if no
    strain is known.

    The volumetric strain is given in the case or, if it is not, follows from the blow counts of each stratum.
    """
    levels = config.section.layering.interfaces(np.array([0.5 * (crest.left + crest.right)]))[0]
    strata = liquefying_strata(config.section.strata, case)
    strain = config.cases[case - 1].volumetric_strain
    known = dict.fromkeys(strata, strain) if strain > 0.0 else _strains_of_borings(config)
    if not any(k in known for k in strata):
        return None
    thickness = [float(levels[k] - levels[k + 1]) for k in strata]
    return reconsolidation_settlement(thickness, [known.get(k, 0.0) for k in strata])


def _strains_of_borings(config: Config) -> dict[int, float]:
    if not config.triggering.borings:
        return {}
    try:
        judged = assess(config.section, config.earthquake, config.triggering)
        return {layer.stratum: layer.volumetric_strain for layer in residual_strengths(judged, config.triggering)}
    except InputError:
        return {}


def water_at_crest(config: Config, structure: CrestedStructure) -> float | None:
    """Return the elevation (m) of the water that a structure retains: the elevation in the criteria or, without one,
    the higher level of the water that stands on the ground at its feet.

    Where none does, it is the higher water level in the ground at the feet of a levee or another structure that retains
    water, whose foreshore may be dry, and None of a building, bank or quay. It is also None where all water lies in the
    ground.
    """
    limit = config.criteria.freeboard
    if limit is not None and limit.water is not None:
        return float(limit.water)
    points = computed_water_points(config.section)
    if points is None or not holds_water(config):
        return None
    feet = np.array([structure.crest.start, structure.crest.end])
    levels = np.interp(feet, *points.T)
    free = levels > ground_at(config.section.ground, feet) + LEAST_DEPTH
    if free.any():
        return float(levels[free].max())
    return float(levels.max()) if structure.kind not in NO_DRY_FORESHORE else None


def ground_at(ground: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the elevation (m) of the ``ground`` (n, 2) at ``x``, at a vertical step that of its foot."""
    steps = [ground[np.abs(ground[:, 0] - place) < 1e-9, 1] for place in x]
    between = np.interp(x, *ground.T)
    return np.array([z.min(initial=level) for z, level in zip(steps, between, strict=True)])


def holds_water(config: Config) -> bool:
    """Return whether freeboard is relevant: there is a criterion for it, or free water."""
    if config.criteria.freeboard is not None:
        return True
    points, ground = computed_water_points(config.section), config.section.ground
    return points is not None and bool((np.interp(ground[:, 0], *points.T) > ground[:, 1] + LEAST_DEPTH).any())


def crest_sentences(parts: Iterator[CrestPart]) -> Iterator[str]:
    """Yield a sentence on every crest after every slide."""
    for part in parts:
        low, high = metres(part.settlement_low_m), metres(part.settlement_high_m)
        spread = "" if low == high else f" ({low} to {high} over packings)"
        drained = "" if not part.reconsolidation_m else f", {metres(part.reconsolidation_m)} of it by reconsolidation"
        left_over = "" if part.freeboard_m is None else f"; the remaining freeboard is {metres(part.freeboard_m)}"
        if part.freeboard_low_m is not None and part.freeboard_high_m is not None and spread:
            left_over += f" ({metres(part.freeboard_low_m)} to {metres(part.freeboard_high_m)})"
        moves = "" if part.at_rest else "; the slide is not at rest"
        yield (
            f"Crest of {part.structure}, {part.method}: the crest settles "
            f"{metres(part.settlement_m)}{spread}{drained}{left_over}"
            f"{moves}."
        )


def crests_in_short(parts: Sequence[CrestPart], _: Texts) -> Iterator[str]:
    """Yield a sentence on the crest of every structure, over all slides: settlement and freeboard."""
    for name in dict.fromkeys(part.structure for part in parts):
        of_crest = [part for part in parts if part.structure == name]
        ends = [end for part in of_crest for end in (part.settlement_low_m, part.settlement_high_m)]
        freeboards = [
            end for part in of_crest for end in (part.freeboard_low_m, part.freeboard_high_m) if end is not None
        ]
        values = {"structure": name, "settlement": span(ends)}
        if freeboards:
            yield _(
                "After liquefaction the crest of {structure} settles {settlement}; the remaining freeboard is "
                "{freeboard}.",
                freeboard=signed_span(freeboards),
                **values,
            )
        else:
            yield _("After liquefaction the crest of {structure} settles {settlement}.", **values)
