"""Finds implausible numbers of earthquake and borings. Most implausible numbers have a wrong unit."""

from collections.abc import Iterator

from meshes.borings.plausible import implausible_tests
from meshes.section.plausibility import Range, sentence, within
from meshes.section.section import Section
from workflow.earthquake.settings import EarthquakeSettings
from workflow.earthquake.triggering.settings import TriggeringSettings

# From a fault that breaks the ground to the deepest earthquake; from beside a fault to where nothing is felt; rods that
# a rig can carry; from mud to hard rock.
DEPTH = Range(0.5, 750.0, "km", 1e3, ((1e3, "km"), (1e-3, "m")))
DISTANCE = Range(0.1, 1500.0, "km", 1e3, ((1e3, "km"), (1e-3, "m")))
RODS = Range(0.0, 30.0, "m", 1.0, ((1e-2, "cm"), (1e-3, "mm")))
VS30 = Range(50.0, 3000.0, "m/s", 1.0, ())


def implausible_triggering(
    section: Section, earthquake: EarthquakeSettings, triggering: TriggeringSettings
) -> list[str]:
    """Return one sentence on each implausible number; none if unusual numbers are declared as such.

    Parameters
    ----------
    section : the section, whose settings may declare unusual numbers
    earthquake, triggering : tables of the input
    """
    if section.unusual:
        return []
    return [*_of_the_earthquake(earthquake), *_of_the_rods(triggering), *implausible_tests(triggering.borings)]


def _of_the_earthquake(earthquake: EarthquakeSettings) -> Iterator[str]:
    for key, limits in (("depth", DEPTH), ("distance", DISTANCE), ("vs30", VS30)):
        value = getattr(earthquake, key)
        if value is not None and not within(value, limits):
            yield sentence(f"earthquake, {key}", value, limits)


def _of_the_rods(triggering: TriggeringSettings) -> Iterator[str]:
    if not within(triggering.rods_above, RODS):
        yield sentence("triggering, rods_above", triggering.rods_above, RODS)
