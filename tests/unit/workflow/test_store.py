"""Files that appear whole or not at all, and what is said of those that do not."""

from pathlib import Path

import pytest

from meshes.errors import InputError
from workflow.run.store import Store


def test_a_file_appears_whole_or_not_at_all(tmp_path: Path) -> None:
    store = Store(tmp_path)

    def stop_halfway() -> None:
        with store.writing("a/b.txt") as path:
            path.write_text("half")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        stop_halfway()
    assert not list((tmp_path / "a").iterdir())
    assert store.write_text("a/b.txt", "whole").read_text() == "whole"


def test_what_cannot_be_written_and_what_cannot_be_read_are_told_apart(tmp_path: Path) -> None:
    store = Store(tmp_path)
    with (
        pytest.raises(InputError, match=r"lost\.csv.*\n.*cannot be read: No such file"),
        store.writing("a.csv") as path,
    ):
        path.write_bytes((tmp_path / "lost.csv").read_bytes())
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(InputError, match=r"file/a\.csv.*\n.*cannot be written: "):
        store.write_text("file/a.csv", "text")


def test_names_come_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    store = Store(tmp_path)
    for name in ("case10.png", "case2.png", "case2_table2.png", "case1/0.vtp"):
        store.write_text(name, "")
    assert store.matching(["case*", "case*/*"]) == ["case1/0.vtp", "case2.png", "case2_table2.png", "case10.png"]


def test_what_is_removed(tmp_path: Path) -> None:
    store = Store(tmp_path)
    for name in ("keep.txt", "case1/0.vtp", "case1.pvd"):
        store.write_text(name, "")
    store.remove(["case*", "case*/*"])
    assert store.matching(["**/*"]) == ["keep.txt"]
