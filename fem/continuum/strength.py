"""Determines the strength and flow rule of the strata in an analysis, and Davis's estimate where ψ < φ.

Ground that dilates by less than its friction angle has no unique limit load: the normality rule does not hold, and the
largest load of an equilibrium path depends on how the path is followed. Davis (1968, in Lee, Soil Mechanics: Selected
Topics) noticed that along a velocity characteristic, where the ground strains at no change of length, such material has
the strength

    τ = β (c + σ tan φ),    β = cos ψ cos φ / (1 - sin ψ sin φ)    (at most 1),

and substitutes associated ground with c* = β c and tan φ* = β tan φ. The limit load of the substituted ground is
unique, has strict bounds, and is never above the limit load of ground with ψ = φ. When the strength is divided by a
factor λ, there are three forms (Tschuchnigg, Schweiger & Sloan 2015, Géotechnique 65, 249; theory in Sysala et al.
2021):

    Form A takes β of φ and ψ as given; form B takes β of arctan(tan φ / λ) and arctan(tan ψ / λ); form C takes β of
    arctan(tan φ / λ) and ψ, and β = 1 where ψ is the larger of these two angles.

At λ = 1 the three forms are equal. Angles are in radians, cohesion in Pa.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, assert_never

import numpy as np

from fem.settings import DavisForm, FlowSetting
from meshes.section.section import Section, Stratum

Flow = Literal["davis", "associated", "non-associated"]


@dataclass(frozen=True)
class StrataStrength:
    """Holds the strength and flow rule of the strata.

    Attributes
    ----------
    cohesion (strata,) : cohesion (Pa)
    friction (strata,) : friction angle (rad)
    dilation (strata,) : dilation angle (rad)
    tension (strata,) : largest major principal effective stress (Pa, tension positive); inf without a tension cut-off
    """

    cohesion: np.ndarray
    friction: np.ndarray
    dilation: np.ndarray
    tension: np.ndarray


def davis_factor(friction: np.ndarray, dilation: np.ndarray) -> np.ndarray:
    """Return β = cos ψ cos φ / (1 - sin ψ sin φ) of angles in rad (Davis 1968); 1 where ψ = φ."""
    return np.cos(dilation) * np.cos(friction) / (1.0 - np.sin(dilation) * np.sin(friction))


def with_davis_strength(section: Section) -> Section:
    """Return the section with Davis's reduced strength, for methods that have no flow rule.

    Parameters
    ----------
    section : the ground, with the dilation angles of its strata

    Returns
    -------
    The section with c and tan φ of its strata multiplied by Davis's factor β.
    """
    strata = []
    for soil in section.strata:
        factor = float(davis_factor(np.array(soil.friction_angle), np.array(soil.dilation)))
        friction = float(np.arctan(factor * np.tan(soil.friction_angle)))
        strata.append(soil.with_multiple_of_cohesion(factor).model_copy(update={"friction_angle": friction}))
    return section.with_strata(strata)


def flow_of(strata: Sequence[Stratum], flow: FlowSetting) -> Flow:
    """Return the flow rule that a setting selects for these strata.

    Parameters
    ----------
    strata : the strata, with the dilation angles of the section file
    flow : the setting. "auto" is "associated", ψ = φ, unless a dilation angle below φ is given for any of the strata.
        With such an angle "auto" is "davis", and strata without a dilation angle have ψ = 0.

    Returns
    -------
    The flow rule.
    """
    if flow != "auto":
        return flow
    below = any(s.dilation_angle is not None and s.dilation_angle < s.friction_angle for s in strata)
    return "davis" if below else "associated"


def strength_of(
    strata: Sequence[Stratum], flow: FlowSetting, factor: float = 1.0, form: DavisForm = "B"
) -> StrataStrength:
    """Return the flow rule and the strength of the strata, divided by ``factor``; tension cut-offs are divided, too.

    "non-associated" takes the given ψ, but not above the reduced φ; "associated" sets ψ = φ; "davis" reduces c and tan
    φ in one of Davis's three forms and then sets ψ = φ. At a tension cut-off the flow is associated, whatever the flow
    rule is.

    Parameters
    ----------
    strata : the strata, with the dilation angles of the section file
    flow : flow rule; "auto" is "associated" or "davis" (`flow_of`)
    factor : divisor of c, tan φ and tension cut-offs (-)
    form : Davis's form, "A", "B" or "C"

    Returns
    -------
    The strength of each stratum; a cohesion that varies is represented by its constant part.
    """
    flow = flow_of(strata, flow)
    cohesion = np.array([s.cohesion for s in strata]) / factor
    tension = tensile_strengths(strata) / factor
    full_friction = np.array([s.friction_angle for s in strata])
    dilation = np.array([s.dilation for s in strata])
    friction = np.arctan(np.tan(full_friction) / factor)
    if flow == "non-associated":
        return StrataStrength(cohesion, friction, np.minimum(dilation, friction), tension)
    if flow == "davis":
        match form:
            case "A":
                beta = davis_factor(full_friction, dilation)
            case "B":
                beta = davis_factor(friction, np.arctan(np.tan(dilation) / factor))
            case "C":
                beta = davis_factor(friction, np.minimum(dilation, friction))
            case _:
                assert_never(form)
        cohesion, friction = beta * cohesion, np.arctan(beta * np.tan(friction))
    return StrataStrength(cohesion, friction, friction, tension)


def davis_words(dilation: Iterable[float]) -> str:
    """Return the name of Davis's estimate, which states the dilation angles.

    Parameters
    ----------
    dilation (strata,) : dilation angles of the strata (rad)

    Returns
    -------
    A noun phrase for a report; "for ψ = 0" if all angles are 0.
    """
    return "Davis's estimate for the given ψ" if any(dilation) else "Davis's estimate for ψ = 0"


def strengths(strata: Sequence[Stratum], davis: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return cohesion and friction angle of the strata.

    Parameters
    ----------
    strata : the strata
    davis : whether c and tan φ are multiplied by Davis's factor β

    Returns
    -------
    Cohesion (strata,) in Pa, of which a varying one is represented by its constant part, and friction angle (strata,)
    in rad.
    """
    cohesion = np.array([s.cohesion for s in strata])
    friction = np.array([s.friction_angle for s in strata])
    if not davis:
        return cohesion, friction
    factor = davis_factors(strata)
    return factor * cohesion, np.arctan(factor * np.tan(friction))


def davis_factors(strata: Sequence[Stratum]) -> np.ndarray:
    """Return Davis's β for the dilation angles of the strata.

    Parameters
    ----------
    strata : the strata; those without a dilation angle have ψ = 0

    Returns
    -------
    β (strata,), at most 1 (-).
    """
    friction = np.array([s.friction_angle for s in strata])
    return davis_factor(friction, np.array([s.dilation for s in strata]))


def tensile_strengths(strata: Sequence[Stratum]) -> np.ndarray:
    """Return the tension cut-offs of the strata.

    Parameters
    ----------
    strata : the strata

    Returns
    -------
    The largest major principal effective stress (strata,), tension positive (Pa); inf without a cut-off.
    """
    return np.array([np.inf if s.tension is None else s.tension for s in strata])


def is_associated(strata: Sequence[Stratum], flow: FlowSetting) -> bool:
    """Return whether the analysis has ψ = φ in every stratum, so that the limit load is unique.

    Parameters
    ----------
    strata : the strata, with the dilation angles of the section file
    flow : flow rule of the analysis; Davis's estimate is associated

    Returns
    -------
    False only if the flow is non-associated and a stratum has ψ < φ.
    """
    return flow != "non-associated" or is_dilating_fully(strata)


def is_dilating_fully(strata: Sequence[Stratum]) -> bool:
    """Return whether the section file has ψ = φ in every stratum, so that Davis's estimate changes nothing.

    Parameters
    ----------
    strata : the strata; those without a dilation angle have ψ = 0

    Returns
    -------
    True if ψ = φ in all of them, as in ground with φ = 0.
    """
    return all(s.dilation == s.friction_angle for s in strata)
