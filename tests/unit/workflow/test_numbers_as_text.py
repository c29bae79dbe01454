"""Numbers as text: the same digits in sentences, headlines and tables."""

import pytest

from workflow.report.numbers import coefficient, range_of, rough, rough_range, slides_in_words, span
from workflow.results.lengths import metres
from workflow.texts.report_texts import listed


@pytest.mark.parametrize(
    ("value", "words"),
    [(39.53, "40 m"), (19.3, "19 m"), (7.13, "7.1 m"), (3.23, "3.2 m"), (1.44, "1.4 m"), (0.853, "0.85 m")],
)
def test_a_slide_has_the_same_digits_in_sentences_headlines_and_tables(value: float, words: str) -> None:
    assert (slides_in_words([value]), span([value, value]), metres(value)) == (words, words, words)


def test_numbers_in_sentences() -> None:
    assert slides_in_words([39.53, 19.3, 7.13]) == "40, 19 and 7.1 m"
    assert (span([7.13, 39.5]), span([2.1, 2.2])) == ("7.1 to 40 m", "2.1 to 2.2 m")
    assert (rough_range(0.33, 7.13), rough_range(3.1, 2.9)) == ("0.3 to 7 m", "3 m")
    assert rough(0.0) == 0.0
    assert [coefficient(kh) for kh in (0.2345, 0.0341, 1.5, 0.0996)] == ["0.234", "0.034", "1.500", "0.100"]
    assert (range_of([0.2345, 0.2387]), range_of([0.231, 0.232])) == ("0.234 to 0.239", "0.231 to 0.232")
    assert [listed(words) for words in ([], ["a"], ["a", "b"], ["a", "b", "c"])] == ["", "a", "a and b", "a, b and c"]
    assert [metres(value) for value in (None, 0.0, 0.33, -1.047, 39.53)] == ["–", "0 m", "0.33 m", "-1.0 m", "40 m"]
