"""Numbers of blow counts and cones that no test has: slips of the pen, mostly a unit."""

from collections.abc import Iterator, Sequence

from meshes.borings.boring import Boring, Cone, Sample
from meshes.borings.complaints import folded
from meshes.borings.log import DEPTH
from meshes.section.plausibility import UNUSUAL, Range, sentence, within

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
    """One sentence for each number of borings in [triggering] that is beyond what there is."""
    problems: list[str] = []
    for number, boring in enumerate(borings, start=1):
        where = f'triggering, borings {number} "{boring.name}"'
        for place, sample in enumerate(boring.spt, start=1):
            problems += implausible_sample(f"{where}, spt {place}, ", sample, UNUSUAL)
        problems += implausible_cones(f"{where}, cpt, ", boring.cpt, UNUSUAL)
    problems = folded(problems)
    samples = [sample for boring in borings for sample in boring.spt]
    return problems + [f"triggering, borings: {text}{UNUSUAL}" for text in shares_for_percent(samples)]


def implausible_sample(where: str, sample: Sample, remedy: str = "") -> Iterator[str]:
    """One sentence for a blow count beyond what there is; ``where`` goes before the key, the ``remedy`` to the end."""
    for key, limits in OF_A_SAMPLE.items():
        value = getattr(sample, key)
        if value is not None and not within(value, limits):
            yield sentence(f"{where}{key}", value, limits, remedy)


def shares_for_percent(samples: Sequence[Sample]) -> list[str]:
    """A sentence for fines contents, and one for plasticity indices, that are below 1 % in every one of the samples.

    Sand washed of its fines has some per cent of them: such numbers are shares of one where percent were expected.
    """
    sentences = []
    for key, what in (("fines", "fines contents"), ("plasticity", "plasticity indices")):
        values = [value for sample in samples if (value := getattr(sample, key)) is not None]
        if values and 0.0 < max(values) < 1.0:
            sentences.append(f"the {what} are {max(values):g} % at most: shares of one? expected percent, 15 for 15 %")
    return sentences


def implausible_cones(where: str, cones: Sequence[Cone], remedy: str = "", with_units: bool = False) -> Iterator[str]:
    """The same of the deepest reading of a sounding, and of its largest resistance and friction.

    Where a file gave them ``with_units``, no other unit is guessed.
    ``where``: beginning of the sentence; ``cones``: readings; ``remedy``: end of the sentence.
    """
    wrong = False
    for key, limits in (("depth", DEPTH), ("qc", LARGEST_TIP), ("fs", LARGEST_SLEEVE)):
        largest = max((getattr(cone, key) for cone in cones), default=None)
        if largest is not None and not within(largest, limits):
            wrong = True
            limits = limits._replace(slips=()) if with_units else limits
            yield sentence(f"{where}largest {key}", largest, limits, remedy)
    ratios = sorted(cone.fs / cone.qc for cone in cones if cone.qc > 0.0)
    if ratios and not wrong and (ratio := ratios[len(ratios) // 2]) > FRICTION_RATIO:
        yield (
            f"{where}fs: half of the readings are above {100.0 * ratio:.3g} % of qc; expected a friction ratio below "
            f"{100.0 * FRICTION_RATIO:g} %: look at the units of both{remedy}"
        )
