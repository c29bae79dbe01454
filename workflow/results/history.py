"""Stores settlement, slide, energies and cracks of every slide over time in dem/history.csv."""

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields

from pydantic import TypeAdapter

from dem.slides.slide import Row
from meshes.errors import InputError
from workflow.run.store import OtherVersionError, Store

FILE = "dem/history.csv"
COLUMNS = ["set", "case", *(field.name for field in fields(Row))]


@dataclass(frozen=True)
class SlideHistory:
    """Holds one slide in time.

    Attributes
    ----------
    springs : set of springs: "calibrated" or "table2"
    case : number of the case; 0 is Kh alone
    rows : state of the slide at every recorded time
    """

    springs: str
    case: int
    rows: tuple[Row, ...]


def write_histories(store: Store, slides: Iterable[SlideHistory]) -> None:
    """Write a line for every recorded time of every slide, sorted by set of springs and number of the case.

    Parameters
    ----------
    store : the folder of the run
    slides : all slides of the run
    """
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for slide in sorted(slides, key=lambda written: (written.springs, written.case)):
        for row in slide.rows:
            numbers = (str(v) if isinstance(v, int) else f"{v:.6g}" for v in asdict(row).values())
            table.writerow([slide.springs, slide.case, *numbers])
    store.write_text(FILE, text.getvalue())


def read_histories(store: Store) -> list[SlideHistory]:
    """Return the slides of a folder.

    Parameters
    ----------
    store : the folder of the run

    Returns
    -------
    The slides in the order of the file.

    Raises
    ------
    InputError
        If there is no file of slides.
    OtherVersionError
        If another version of the program wrote the file.
    """
    path = store.folder / FILE
    row_of = TypeAdapter(Row)
    histories: dict[tuple[str, int], list[Row]] = {}
    try:
        with path.open(encoding="utf-8", newline="") as file:
            table = csv.DictReader(file)
            if table.fieldnames != COLUMNS:
                raise OtherVersionError(str(path), [f"expected the columns {', '.join(COLUMNS)}"])
            for line in table:
                histories.setdefault((line["set"], int(line["case"])), []).append(row_of.validate_python(line))
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror}; run the stage slide"]) from None
    except ValueError as error:
        if isinstance(error, OtherVersionError):
            raise
        raise OtherVersionError(str(path), [f"line {table.line_num} is of another version: {error}"]) from None
    return [SlideHistory(springs, case, tuple(rows)) for (springs, case), rows in histories.items()]
