"""Counts agree with their noun and verb."""

from meshes.section.sentences import counted


def test_one_is_told_in_the_singular() -> None:
    assert [counted(count, "disc has", "discs have") for count in (0, 1, 2)] == [
        "0 discs have", "1 disc has", "2 discs have",
    ]  # fmt: skip
