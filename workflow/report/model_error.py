"""States the interval of a predicted slide, by the error of the model on known slides."""

from collections.abc import Iterator, Sequence

from dem.settings import SlideMethod
from workflow.estimates.slide_error import slide_error
from workflow.report.numbers import rough_range
from workflow.results.results import Results

NAMES: dict[SlideMethod, str] = {"discs": "these discs", "mpm": "material points"}


def model_error(results: Results) -> Iterator[str]:
    """Yield the sentence on the slides of a run: their range over cases and packings, and the error of the model."""
    _, cases = results.case_set()
    slides = [case.slide_max_m for case in cases.values()]
    random = results.cases.random if results.cases is not None else None
    for case in random.cases.values() if random is not None else ():
        slides += case.slide_max_m.values
    known = {case.flows for case in cases.values()}
    flows = known.pop() if len(known) == 1 else None
    if sentence := error_sentence(slides, flows):
        yield sentence
    cases_of_points = results.mpm.cases.values() if results.mpm is not None else ()
    points = [end for case in cases_of_points for end in (case.slide_max_low_m, case.slide_max_high_m)]
    if sentence := error_sentence(points, flows, "mpm"):
        yield sentence


def error_sentence(slides: Sequence[float], flows: bool | None, method: SlideMethod = "discs") -> str:
    """Return the error of discs or material points on known slides, and the interval of the given slides (m) with this
    error.

    The sentence is empty if the collection has no comparable slides, or nothing slides. flows: whether the slides flow
    by their weight alone; None if this is not known.
    """
    error = slide_error(flows, method)
    moved = [max(slide, 0.0) for slide in slides]
    if error is None or not any(moved):
        return ""
    if 2 * error.within < error.cases:
        return f"{error.sentence()}: the slide of such ground is not predicted by {NAMES[method]}."
    if not error.bounds_slides:
        half = f"half of them within a factor of {error.middle:.2g}"
        return f"{error.sentence()}, {half}: use the slide as an order of magnitude."
    interval = rough_range(*error.interval(min(moved), max(moved)))
    return f"{error.sentence()}; with this error the largest slide is {interval}."
