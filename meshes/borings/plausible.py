"""Finds impossible numbers of blow counts and cone tests, which usually have a wrong unit."""

from collections.abc import Iterator, Sequence

from meshes.borings.boring import Boring, Cone, Sample
from meshes.borings.complaints import folded
from meshes.borings.log import DEPTH
from meshes.section.plausibility import UNUSUAL, Range, is_within, sentence

# From clay to the coarsest sand with gravel that a sampler of 35 mm brings up whole; a refusal to rock; bentonite; from
# mud to hard rock.
GRAIN = Range(1e-5, 10.0, "mm", 1e-3, ((1e-3, "mm"), (1e-6, "µm")))
BLOWS = Range(0.0, 200.0, "blows", 1.0, ())
PLASTICITY = Range(0.0, 200.0, "%", 1.0, ())
# Of a whole sounding: single readings of soft ground are as small as noise.
LARGEST_TIP = Range(0.02, 200.0, "MPa", 1e6, ((1e6, "MPa"), (1e3, "kPa"), (1e-3, "Pa")))
LARGEST_SLEEVE = Range(0.2, 5000.0, "kPa", 1e3, ((1e3, "kPa"), (1e6, "MPa"), (1e-3, "Pa")), or_none=True)
FRICTION_RATIO = 0.2  # of sleeve to tip, in the middle of a sounding: peat has some 10 %
OF_A_SAMPLE = {"depth": DEPTH, "N": BLOWS, "plasticity": PLASTICITY, "d50": GRAIN}


def implausible_tests(borings: Sequence[Boring]) -> list[str]:
    """Find impossible numbers of borings in the table [triggering].

    Parameters
    ----------
    borings : borings with blow counts and cone resistances

    Returns
    -------
    One sentence for each impossible number, with its key.
    """
    problems: list[str] = []
    for number, boring in enumerate(borings, start=1):
        key = f'triggering, borings {number} "{boring.name}"'
        for place, sample in enumerate(boring.spt, start=1):
            problems += implausible_sample(f"{key}, spt {place}, ", sample, UNUSUAL)
        problems += implausible_cones(f"{key}, cpt, ", boring.cpt, UNUSUAL)
    problems = folded(problems)
    samples = [sample for boring in borings for sample in boring.spt]
    return problems + [f"triggering, borings: {text}{UNUSUAL}" for text in shares_for_percent(samples)]


def implausible_sample(where: str, sample: Sample, remedy: str = "") -> Iterator[str]:
    """Return a sentence for an impossible blow count; the text ``where`` precedes the key, the ``remedy`` ends the
    sentence."""
    for key, limits in OF_A_SAMPLE.items():
        value = getattr(sample, key)
        if value is not None and not is_within(value, limits):
            yield sentence(f"{where}{key}", value, limits, remedy)


def shares_for_percent(samples: Sequence[Sample]) -> list[str]:
    """Return a sentence for fines contents, and a sentence for plasticity indices, that are below 1 % in every sample.

    Even washed sand contains some per cent of fines: numbers below 1 are probably fractions instead of per cent.
    """
    sentences = []
    for key, what in (("fines", "fines contents"), ("plasticity", "plasticity indices")):
        values = [value for sample in samples if (value := getattr(sample, key)) is not None]
        if values and 0.0 < max(values) < 1.0:
            sentences.append(
                f"the {what} are {max(values):g} % at most: these may be fractions; expected percent, "
                "such as 15 for 15 %"
            )
    return sentences


def implausible_cones(where: str, cones: Sequence[Cone], remedy: str = "", with_units: bool = False) -> Iterator[str]:
    """Return one sentence for an impossible deepest reading of a sounding, and for an impossible largest resistance or
    friction.

    If a file gave the numbers ``with_units``, no other unit is suggested. ``where``: beginning of the sentence;
    ``cones``: readings; ``remedy``: end of the sentence.
    """
    wrong = False
    for key, limits in (("depth", DEPTH), ("qc", LARGEST_TIP), ("fs", LARGEST_SLEEVE)):
        largest = max((getattr(cone, key) for cone in cones), default=None)
        if largest is not None and not is_within(largest, limits):
            wrong = True
            limits = limits._replace(slips=()) if with_units else limits
            yield sentence(f"{where}largest {key}", largest, limits, remedy)
    ratios = sorted(cone.fs / cone.qc for cone in cones if cone.qc > 0.0)
    if ratios and not wrong and (ratio := ratios[len(ratios) // 2]) > FRICTION_RATIO:
        yield (
            f"{where}fs: half of the readings are above {100.0 * ratio:.3g} % of qc; expected a friction ratio below "
            f"{100.0 * FRICTION_RATIO:g} %: check the units of both{remedy}"
        )
