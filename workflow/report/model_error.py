"""States the interval of a predicted slide, by the error of the model on known slides."""

from collections.abc import Iterator

from dem.settings import SlideMethod
from workflow.report.numbers import rough_range
from workflow.results.governing import MethodSlides, slides_by_weight
from workflow.results.results import Results

NAMES: dict[SlideMethod, str] = {"discs": "discs", "mpm": "material points"}


def model_error(results: Results) -> Iterator[str]:
    """Yield the sentence on the slides of a run by each method, discs first: their range over cases and packings, and
    the error of the model."""
    for slides in sorted(slides_by_weight(results), key=lambda slides: list(NAMES).index(slides.method)):
        if sentence := error_sentence(slides):
            yield sentence


def error_sentence(slides: MethodSlides) -> str:
    """Return the error of a method on known slides, and the interval of its slides with this error. The sentence is
    empty if the collection has no comparable slides, or nothing slides.
    """
    error, interval = slides.error, slides.interval
    if error is None or interval is None:
        return ""
    if 2 * error.within < error.cases:
        these = "these discs" if slides.method == "discs" else NAMES[slides.method]
        return f"{error.sentence()}: the slide of such ground is not predicted by {these}."
    if not error.bounds_slides:
        half = f"half of them within a factor of {error.middle:.2g}"
        return f"{error.sentence()}, {half}: use the slide as an order of magnitude."
    return f"{error.sentence()}; with this error the largest slide is {rough_range(*interval)}."
