"""Blow counts as logs write them: numbers, increments, refusals."""

import pytest

from meshes.borings.blows import is_refusal, read_blows


@pytest.mark.parametrize(
    ("count", "blows", "refused"),
    [
        (12, 12, False),
        ("12", 12, False),
        ("12 blows/ft", 12, False),
        ("12/30cm", 12, False),
        ("N=19 (3,4/4,5)", 19, False),
        (">50", 50, True),
        ("50+", 50, True),
        ("50/75mm", 50, True),
        ('50/3"', 50, True),
        ("50 for 75 mm", 50, True),
        ("R", 50, True),
        ("N=50 (25 for 5mm/50 for 15mm)", 50, True),
        ("25,50/75mm", 50, True),
        ("100/150mm", 100, True),
        ("30/250mm", 36, True),
        ("30/150mm", 50, True),
        ("25 for 0mm", 50, True),
        ("50/0.2ft", 50, True),
        ("WOH", 0, False),
        ("1,2/3,4,5,6 N=18", 18, False),
        ("(C) 34", 34, False),
        ("12*", 12, False),
        ('50-4"', 50, True),
        ("Refus", 50, True),
        ("12/30", 12, False),  # in cm, as in Japan: no refusal after 12 blows and 30 mm
        ("50/10", 50, True),
        ("30 (for 60 mm)", 50, True),
        ("50/5in.", 50, True),
        ("50 pour 5 cm", 50, True),
        ("50 (R)", 50, True),
        ("R60", 60, True),
        ("N=R", 50, True),
        ("N=*18", 18, False),
        ('WOH/18"', 0, False),
    ],
)
def test_refusals_count_as_the_least_that_n_can_be(count: str | float, blows: float, refused: bool) -> None:
    """36 = 300/250 of 30 blows; a refusal with fewer than 50 blows counts at most as 50 (ASTM D1586)."""
    found = read_blows(count)
    assert (float(found), is_refusal(found)) == (pytest.approx(blows), refused)
    assert read_blows(found.written) == found  # as it stands in a section


@pytest.mark.parametrize("count", ["much", ">x", "-3", 501, True, None, "50/", "2,3,4", "12/25", "C", float("nan")])
def test_what_is_no_count_is_told_with_what_was_expected(count: object) -> None:
    with pytest.raises(ValueError, match=r'expected the blow count for 30 cm .* ">50", "50/75 mm" or "R"'):
        read_blows(count)
