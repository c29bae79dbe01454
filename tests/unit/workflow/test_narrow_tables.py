"""Wide tables on narrow screens: each cell with the heading of its column."""

from workflow.report.narrow_tables import labelled

HEADS = "<tr><th>case</th><th>largest<br>slide</th><th>at x</th><th>cracks</th><th>at rest</th></tr>"


def test_cells_of_wide_tables_carry_the_heading_of_their_column() -> None:
    row = '<tr><td>1</td><td class="n">1.2 m</td><td colspan="2">–</td><td>yes</td></tr>'
    text = labelled(f"<table>{HEADS}{row}</table>")
    assert text.startswith('<table class="wide"><tr class="heads">')
    assert '<td data-label="">1</td><td class="n" data-label="largest slide">1.2 m</td>' in text
    assert '<td colspan="2" data-label="">–</td><td data-label="at rest">yes</td>' in text


def test_tables_that_fit_are_unchanged() -> None:
    table = "<table><tr><th>a</th><th>b</th></tr><tr><td>1</td><td>2</td></tr></table>"
    assert labelled(table) == table
    pairs = "<table><tr><th>Mesh</th><td>611</td></tr></table>"
    assert labelled(pairs) == pairs
    warnings = f'<table class="warnings">{HEADS}</table>'
    assert labelled(warnings) == warnings
