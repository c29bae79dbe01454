"""Adapts wide tables of a page to narrow screens: every cell carries the heading of its column."""

import re
from html import escape, unescape

TABLE = re.compile(r"<table\b([^>]*)>(.*?)</table>", re.DOTALL)
ROW = re.compile(r"<tr\b([^>]*)>(.*?)</tr>", re.DOTALL)
CELL = re.compile(r"<(t[hd])\b([^>]*)>(.*?)</\1>", re.DOTALL)
SPAN = re.compile(r'colspan="(\d+)"')
BREAK, TAG = re.compile(r"<br */?>"), re.compile(r"<[^>]*>")
MOST_COLUMNS = 4  # of a table that fits on a narrow screen


def labelled(html: str) -> str:
    """Mark tables of more than `MOST_COLUMNS` columns as wide, and write the headings into their cells.

    Style sheets show the headings where the screen is too narrow for the columns.
    """
    return TABLE.sub(_table, html)


def _table(match: re.Match[str]) -> str:
    rows = ROW.findall(match[2])
    heads = [TAG.sub("", BREAK.sub(" ", text)) for _, _, text in CELL.findall(rows[0][1])] if rows else []
    if len(heads) <= MOST_COLUMNS or "<td" in rows[0][1] or "class=" in match[1]:
        return match[0]
    body = ROW.sub(lambda row: _row(row, heads), match[2])
    return f'<table{match[1]} class="wide">{body}</table>'


def _row(match: re.Match[str], heads: list[str]) -> str:
    if "<td" not in match[2]:
        return f'<tr{match[1]} class="heads">{match[2]}</tr>'
    column, cells = 0, []
    for tag, attributes, text in CELL.findall(match[2]):
        span = SPAN.search(attributes)
        label = "" if column == 0 or span else " ".join(heads[column].split()) if column < len(heads) else ""
        column += int(span[1]) if span else 1
        cells.append(f'<{tag}{attributes} data-label="{escape(unescape(label))}">{text}</{tag}>')
    return f"<tr{match[1]}>{''.join(cells)}</tr>"
