"""What is doubtful in a report: one doubt a line, the most important first, cases of which the same is said in one."""

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from workflow.report.contradictions import contradictions
from workflow.report.numbers import coefficient, listed
from workflow.results.discs import SlipSurfaces
from workflow.results.results import Results

CALIBRATED_FAR = 2.0  # times, or divided by it: a factor on the discs beyond this is told
SURFACES_APART = 0.25  # of the height of the section: slip surfaces farther apart than this are told
DECIDE = 1.15  # times, or divided by it: other sides that change the critical Kh by more decide it
OPEN = 1.1  # times: a critical Kh that may be so much larger than the one the discs are brought to is told
# A number in a note, and what is none though it has digits: what stands in quotation marks, and names as Ac1.
NUMBER = re.compile(r'("[^"]*")|(?<![\w.])(\d+(?:\.\d+)?)(?![\w.]*\w)')


def doubtful(results: Results) -> list[str]:
    """Every doubt as a sentence: what contradicts an answer, the ground, the discs, and then their slides."""
    return [f"{told[0].upper()}{told[1:].rstrip('.')}." for told in _doubts(results)]


def of_cases(numbers: Sequence[int]) -> str:
    """Cases as a sentence names them."""
    return f"case{'s' if len(numbers) > 1 else ''} {listed([str(number) for number in numbers])}"


def _doubts(results: Results) -> Iterator[str]:
    config, fem, discs = results.config, results.fem, results.dem
    if fem is not None and fem.verdict == "undecided":
        yield f"the path of the finite elements ended undecided ({fem.reason})"
    for doubt in results.doubts:
        if doubt.contradiction:
            yield f"{doubt.what.rstrip('.')}: {doubt.remedy}"
    if results.response is not None and results.response.doubt:
        yield f"response of the layers to {results.response.record}: {results.response.doubt}"
    yield from _sides(results)
    if config.section.reconstruction:
        yield "the ground is a reconstruction"
    yield from _doubts_of_calibration(results)
    like = results.like_discs
    if like is not None and discs is not None and like.kc_upper > OPEN * like.kc:
        yield (
            f"the finite elements that the discs are held against ({like.terms}) fail at Kh of "
            f"{coefficient(like.kc)} to {coefficient(like.kc_upper)}; discs that fail between are taken as they are"
        )
    yield from _held(results)
    yield from contradictions(results)
    _, cases = results.case_set()
    escaped = [number for number, case in cases.items() if case.escaped]
    if escaped:
        yield f"discs have left the section in {of_cases(escaped)}"
    yield from joined({number: case.notes for number, case in cases.items()})
    if discs is not None:
        yield from _elsewhere(discs.slip_surface, float(np.ptp(config.section.outline()[:, 1])))
    if discs is not None and discs.model.packing != "random":
        yield "the discs lie in rows, which must climb over each other to slide"


def _sides(results: Results) -> Iterator[str]:
    """That the critical Kh hangs on what is assumed where the section was cut off."""
    fem = results.fem
    change = next((one for one in results.variants.variants if one.name == "sides"), None) if results.variants else None
    other = change.of(fem.kc) if change is not None and fem is not None else None
    if fem is None or change is None or other is None or not fem.kc > 0.0:
        return
    if not 1.0 / DECIDE <= other / fem.kc <= DECIDE:
        longer = "a larger beyond" if results.config.section.beyond else 'beyond = "50 m"'
        yield (
            f"with {change.change} the section fails at Kh of about {coefficient(other)}, and not "
            f"{coefficient(fem.kc)}: what is assumed at its ends decides, and {longer} takes them further away"
        )


def _elsewhere(surfaces: SlipSurfaces, height: float) -> Iterator[str]:
    """That discs fail elsewhere than the continuum, in a section of that height (m)."""
    apart, lines = surfaces.mean_distance_m, (surfaces.dem, surfaces.fem)
    if apart is not None and apart > SURFACES_APART * height:
        yield f"discs and finite elements fail along surfaces that lie {apart:.0f} m apart on average"
    elif apart is None and all(lines):
        discs, fem = ([point[0] for point in line] for line in lines)
        yield (
            f"discs fail elsewhere than the finite elements: from x = {min(discs):.0f} to {max(discs):.0f} m, and not "
            f"from {min(fem):.0f} to {max(fem):.0f} m"
        )


def _held(results: Results) -> Iterator[str]:
    """That discs do not stand under a Kh that is held, though they have borne it when they were pushed."""
    discs = results.dem
    if discs is None or discs.after.kc is None:
        return
    fallen = [s.kh for s in discs.states if s.set == "after" and s.verdict == "fails" and s.kh < discs.after.kc_lower]
    if fallen:
        yield (
            f"the calibrated discs fail where Kh = {min(fallen):g} is held, though they bear "
            f"{coefficient(discs.after.kc)} when their displacement is prescribed"
        )


def joined(notes: Mapping[int, Sequence[str]]) -> Iterator[str]:
    """What the notes of cases say, each once, up to its colon, with its cases; numbers that differ become a range.

    Every case has its notes in the order of their weight, and so have all of them.
    """
    found: dict[str, dict[int, list[str]]] = {}
    places: dict[str, int] = {}
    for case, its in notes.items():
        for place, note in enumerate(its):
            fact = note.partition(": ")[0]
            same = NUMBER.sub(lambda match: match[1] or "{}", fact.replace("{", "(").replace("}", ")"))
            found.setdefault(same, {})[case] = [number for quoted, number in NUMBER.findall(fact) if not quoted]
            places[same] = max(place, places.get(same, 0))
    for same in sorted(found, key=lambda words: places[words]):
        its_numbers = zip(*found[same].values(), strict=True)
        yield f"{same.format(*map(_range, its_numbers))} ({of_cases(list(found[same]))})"


def _range(numbers: Sequence[str]) -> str:
    low, high = min(numbers, key=float), max(numbers, key=float)
    return low if float(low) == float(high) else f"{low} to {high}"


def _doubts_of_calibration(results: Results) -> Iterator[str]:
    calibration = results.calibration
    if calibration is None:
        return
    if calibration.verdict == "out of reach":
        yield "no factor on the discs brings them to the critical Kh of the finite elements"
    elif not 1.0 / CALIBRATED_FAR <= calibration.value <= CALIBRATED_FAR:
        name = calibration.parameter.replace("_", " ")
        what = {"all": "all constants", "strength": "the strength"}.get(name, f"the {name}")
        yield (
            f"the discs fail at the Kh of the finite elements only with {what} of their springs times "
            f"{calibration.value:.2g}"
        )
