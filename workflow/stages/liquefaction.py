"""Determines the strata that liquefy in each case, by settings, blow counts and earthquake."""

from collections.abc import Collection, Hashable, Mapping
from typing import Any, TypeVar

from meshes.errors import InputError
from meshes.section.liquefies import RemainingStrength
from meshes.section.section import Section
from meshes.section.stratum import cases_of, liquefying_strata
from workflow.config import Config
from workflow.earthquake.triggering.assessment import assess

Item = TypeVar("Item", bound=Hashable)

STRENGTH_KEYS = (
    "cohesion",
    "friction",
    "residual",
    "residual_strength",
)  # keys of a case that change the strength of strata


def liquefying(config: Config) -> dict[int, list[int]]:
    """For every case, return the indices of the strata that liquefy in it. Cases in which no stratum liquefies are left
    out."""
    strata = config.section.strata
    return {n: liquefying_strata(strata, n) for n in cases_of(strata) if n <= len(config.cases)}


def refuse_unless_liquefying(section: Section) -> None:
    """Refuse a section in which no stratum liquefies in any case.

    Parameters
    ----------
    section : the ground

    Raises
    ------
    InputError : No stratum liquefies.
    """
    if not section.liquefies:
        raise InputError(
            section.name, ["no stratum liquefies in any case; expected liquefies_in for at least one stratum"]
        )


def remaining(config: Config) -> dict[int, dict[int, RemainingStrength]]:
    """For every case, return the remaining strength of the strata that liquefy in it, by their indices."""
    return {
        n: {k: config.cases[n - 1].remains_of(config.section, k) for k in strata}
        for n, strata in liquefying(config).items()
    }


def first_equal(keys: Mapping[Item, Hashable]) -> dict[Item, Item]:
    """For every item, return the first item with the same key, which may be the item itself. Of several items with the
    same key only the first item has to be computed."""
    first: dict[Hashable, Item] = {}
    return {item: first.setdefault(key, item) for item, key in keys.items()}


def lowest_factors(config: Config) -> list[float | None]:
    """Return the smallest F_L of every stratum by its blow counts, None if it has none; empty without any borings."""
    if not config.triggering.borings:
        return []
    return [stratum.lowest for stratum in assess(config.section, config.earthquake, config.triggering).strata]


def cases_as_data(config: Config, keys: Collection[str] | None = None) -> list[dict[str, Any]]:
    """Return every case in which strata liquefy, as data for JSON: number, strata, and all or some of its settings."""
    wanted = None if keys is None else {"name", *keys}
    return [
        {"number": n, "strata": strata, **config.cases[n - 1].model_dump(mode="json", include=wanted)}
        for n, strata in liquefying(config).items()
    ]


def resolved_inputs(config: Config) -> dict[str, Any]:
    """Return the resolved cases. If a record determines when strata liquefy, also return the smallest F_L of each
    stratum."""
    decides = (config.slide.accelerogram or config.slide.kh_cycles) and config.slide.liquefies_at == "F_L"
    return {"what liquefies": cases_as_data(config)} | ({"its F_L": lowest_factors(config)} if decides else {})


def liquefied_ground(config: Config, remains: Mapping[int, RemainingStrength]) -> Section:
    """Return the section after liquefaction."""
    from fem.continuum.liquefied_ground import liquefied_section

    return liquefied_section(config.section, remains)


def different_cases(config: Config) -> dict[tuple[tuple[int, RemainingStrength], ...], list[int]]:
    """Return the numbers of the cases, grouped by the residual strength of their liquefied strata."""
    groups: dict[tuple[tuple[int, RemainingStrength], ...], list[int]] = {}
    for number, remains in remaining(config).items():
        groups.setdefault(tuple(remains.items()), []).append(number)
    return groups


def has_strength(remains: Mapping[int, RemainingStrength]) -> bool:
    """Return whether any liquefied stratum has a residual strength."""
    return any(soil.friction or soil.residual or soil.strength for soil in remains.values())
