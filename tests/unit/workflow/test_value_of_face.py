"""Which method gives the value of a face."""

import pytest

from workflow.results.faces import FaceValue
from workflow.results.governing import value_of_face


@pytest.mark.parametrize(
    ("elements", "expected"),
    [
        (None, (0.2, False)),
        (FaceValue(value=0.1), (0.1, True)),
        (FaceValue(value=0.1, upper=0.09), (0.09, True)),
        (FaceValue(value=0.1, reaches_crest=False), (0.2, False)),
    ],
)
def test_the_slip_circle_counts_where_the_failure_of_the_elements_has_no_crest(
    elements: FaceValue | None, expected: tuple[float, bool]
) -> None:
    assert value_of_face(elements, 0.2) == expected
