"""States assumptions and limits of the analysis."""

from collections.abc import Iterator, Mapping

from dem.settings import PAPER_LOADING
from fem.continuum.strength import Flow, flow_of
from fem.settings import DirectionSetting, Sides
from meshes.section.section import Section
from workflow.config import Config
from workflow.report.flow_rule import BLOCKS, DISCS, LIQUEFIED

SIDES: Mapping[Sides, str] = {
    "free-field": "The sides keep their stress at rest, K0 = ν / (1 - ν), and may move horizontally, not vertically.",
    "smooth": "The sides are held horizontally and free vertically, without shear stress, as in slope programs.",
    "fixed": "The sides are held in both directions, which supports the ground.",
    "periodic": "Both sides have equal displacements, as if the section were one of many in a row.",
}
FLOWS: Mapping[Flow, str] = {
    "associated": "The ground yields with ψ = φ: ground that dilates less is not stronger (Radenkovic 1961).",
    "davis": "Where ψ < φ, c and tan φ are reduced by Davis's factor and the ground yields with ψ = φ (Davis 1968): an "
    "estimate, and no bound.",
    "non-associated": "Yielding ground dilates with the given ψ; the limit load is then not unique.",
}
DIRECTIONS: Mapping[DirectionSetting, str] = {
    "both": "The seismic force acts downslope in one analysis and upslope in another.",
    "downhill": "The seismic force acts downslope.",
    "uphill": "The seismic force acts upslope.",
}


def assumptions(config: Config) -> Iterator[tuple[str, str]]:
    """Yield assumptions as pairs of a heading and sentences."""
    yield (
        "Plane strain",
        "The analysis is two-dimensional: the slope is infinitely long out of the plane of the section, and its ends "
        "give no support.",
    )
    yield (
        "Shaking",
        "In the critical Kh and the factors of safety shaking is a constant horizontal force, Kh times g times the "
        "seismic density, with the same Kh everywhere. These analyses neglect waves, amplification and the frequency "
        "of shaking. "
        + (
            f"Kv = {config.fem.vertical:g} acts together with Kh. "
            if config.fem.vertical
            else "No vertical acceleration. "
        )
        + DIRECTIONS[config.fem.direction],
    )
    yield (
        "Strength",
        "The strength is Mohr-Coulomb with the given c and φ, which do not fall with strain or with the number of "
        "cycles. "
        + (
            "Ratios of strength apply to the vertical effective stress before shaking. "
            if any(stratum.by_stress for stratum in config.section.strata)
            else ""
        )
        + (
            "The preconsolidation stress is that of the state in [consolidation]. "
            if config.section.consolidation is not None
            else ""
        )
        + FLOWS[flow_of(config.section.strata, config.fem.flow)],
    )
    yield "Water", _water(config.section)
    if (flow := config.section.water_pressure.flow) is not None:
        yield "Seepage", flow.description
    if config.section.surcharges:
        yield (
            "Loads",
            "Surcharges are vertical; the given share of their mass shakes with the ground. Ratios of strength to "
            "effective stress include only the share of surcharges under which the ground has consolidated.",
        )
    yield "Sides and base", f"{SIDES[config.fem.sides]} The base does not move."
    yield "Sliding blocks", BLOCKS[flow_of(config.section.strata, config.fem.flow)]
    if config.section.liquefies:
        yield (
            "Liquefaction",
            f"{_source_of_liquefaction(config)} The layers that liquefy lose strength {_onset(config)}. The ground "
            f"slides under {_driven(config)}. {_of_the_paper(config)}{LIQUEFIED}",
        )
        yield (
            "Discs",
            "Discs in a plane, far larger than the grains of the soil, represent the ground. "
            + (
                "The contacts between discs are chosen so that element tests of the discs give the stiffness and "
                "strength of the soil; one factor on all strengths makes the critical Kh of the discs equal to that of "
                f"the finite elements with the boundary conditions of the disc box. {DISCS}"
                if config.dem.model == "soil"
                else "The springs of the discs are calibrated only to the critical Kh of the finite elements, not to "
                "the stiffness after failure or the dilation of the soil."
            ),
        )


def _source_of_liquefaction(config: Config) -> str:
    """Return a sentence on what determines the layers that liquefy, and their residual strength."""
    liquefying = [stratum for stratum in config.section.strata if stratum.liquefies_in]
    if not any(stratum.liquefies_in.triggered for stratum in liquefying):
        return "The layers that liquefy and their residual strength are input, not results."
    if any(number > len(config.slide.cases) for stratum in liquefying for number in stratum.liquefies_in):
        return "The layers that liquefy and their residual strength follow from borings and the earthquake."
    return "The layers that liquefy follow from borings and the earthquake; their residual strength is input."


def _onset(config: Config) -> str:
    """Return the duration of the onset of liquefaction, and its time relative to the shaking."""
    slide = config.slide
    seconds, at = slide.onset_of(config.dem.model), slide.liquefies_at
    how = f"over {seconds:g} s" if seconds > 0.0 else "at once"
    if slide.accelerogram:
        return f"{how}, from {at:g} s of the record" if at != "F_L" else f"{how}, during the record"
    if slide.kh == 0.0:
        return how
    if slide.kh_cycles is None:
        return f"{how}, after the constant Kh has begun to act"
    if at == "F_L":
        return f"{how}, before the first cycle or, where borings give F_L, during the cycles"
    return f"{how}, from {at:g} s after the cycles begin"


def _water(section: Section) -> str:
    """Return how water enters the analysis."""
    if not section.water_pressure.present:
        return (
            "Water enters only by the given densities and strengths: there is no pore pressure, and none builds up "
            "with strain."
        )
    head = "across the flow" if section.water_pressure.normal else "vertically"
    phrase = (
        "The analysis is in effective stresses: below the water level of each stratum pores are saturated, with the "
        "pressure head "
        f"measured {head}; above it there is neither pore pressure nor suction. Free water loads the ground surface. "
        "The horizontal force acts on all "
        "of the saturated mass. No excess pore pressure builds up with strain."
    )
    if section.water_pressure.flow is not None:
        phrase = (
            "The analysis is in effective stresses: the pore pressure is that of steady seepage between free water "
            "and the heads at the sides, "
            "0 above the phreatic line, without suction. Shaking and sliding do not change the flow. The horizontal "
            "force acts on all of the saturated mass. No excess pore pressure builds up with strain."
        )
    if section.water_pressure.moves:
        phrase += " The inertia of free water acts on the ground, too (Westergaard 1933)."
    if section.water_pressure.rises_by_shaking:
        phrase += " Shaking adds the given excess pore pressure, all of it before Kh acts."
    if section.water is not None and section.water.after_drawdown is not None:
        phrase += " After the drawdown undrained ground keeps its pore pressure, less the load of the removed water."
    return phrase


def _of_the_paper(config: Config) -> str:
    """Return the loading of the paper's own discs, if they are computed in addition to soil discs."""
    both_models = config.dem.model == "soil" and config.dem.paper
    if not both_models:
        return ""
    return f"On the discs of the paper, Kh = {PAPER_LOADING['kh']:g} is constant until their computation ends. "


def _driven(config: Config) -> str:
    """Return the loading of slides, and how it differs from an earthquake."""
    words = config.slide.shaking
    if config.slide.accelerogram:
        return (
            f"{words}, which moves the base and everything fixed to it as one rigid body; after the record there is no "
            "shaking"
        )
    if config.slide.kh == 0.0:
        return f"{words}, as if all shaking were over"
    if config.slide.kh_cycles is not None:
        return f"{words}: uniform cycles instead of the irregular ones of an earthquake"
    lasts = "" if config.slide.kh_seconds is not None else " that acts until the slides end"
    return f"a constant {words}{lasts}, while an earthquake acts in both directions and ends"
