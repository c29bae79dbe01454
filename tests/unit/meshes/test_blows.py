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
        ("N=17 (2 for 75mm/3,3,5,6)", 17, False),  # the seating is no refusal
        ("35 (25 for 70mm/15,5,7,8)", 35, False),
        ("N=30 (2,3/8,9,7,6 for 70mm)", 30, False),  # the last quarter of four, of 295 mm
        ("26 (12,12/26 for 75mm)", 50, True),
        ("38 (5,6/10,12,16 for 20mm)", 50, True),  # 38 blows for 170 mm are 67 for 300
        ("6,19/18,21,10,1 for 25mm", 50, True),
        ("3,4/5,6,7,2 for 25mm", 24, True),  # 20 blows for 250 mm
        ("(32,50 for 55mm)", 50, True),
        ("(4,18/50 for 0mm)", 50, True),
        ("0 (55 for 125mm/,,,)", 50, True),
        ("50/75mm (14,14,50,0,0,0)", 50, True),
        ("30/250mm (3,4,9,8,8,5)", 36, True),
        ("50/0mm (25/0,50/0)", 50, True),
        ("47/235mm - Abandoned", 50, True),
        ("2,2/3,5,6,13 SPT N=27", 27, False),
        ("25/50 SPT =25*/0=50/75", 50, True),
        ("8,10/15,14,13,6 SPT =48/260", 50, True),
        ("N>50 (4,5/8,13,18,26 for 25mm)", 50, True),
        ("50*/70", 50, True),
        ("N=50/280", 50, True),
        ("18/75*", 50, True),
        ("25/0*", 50, True),
        ("39/0.255", 39 * 300 / 255, True),
    ],
)
def test_refusals_count_as_the_least_that_n_can_be(count: str | float, blows: float, refused: bool) -> None:
    """36 = 300/250 of 30 blows; a refusal with fewer than 50 blows counts at most as 50 (ASTM D1586).

    The longer ones are written as AGS files of the British Geological Survey have them.
    """
    quantity = read_blows(count)
    assert (float(quantity), is_refusal(quantity)) == (pytest.approx(blows), refused)
    assert read_blows(quantity.written) == quantity  # as it stands in a section


@pytest.mark.parametrize("count", ["much", ">x", "-3", 501, True, None, "50/", "2,3,4", "12/25", "C", float("nan")])
def test_what_is_no_count_is_told_with_what_was_expected(count: object) -> None:
    with pytest.raises(ValueError, match=r'expected the blow count for 30 cm .* ">50", "50/75 mm" or "R"'):
        read_blows(count)
