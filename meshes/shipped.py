"""Finds the sections that come with the program, by name."""

from pathlib import Path

FOLDER = Path(__file__).parent / "sections"


def names() -> list[str]:
    """Return the names of the sections that come with the program, as the files are called."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def file_of(name: str) -> Path:
    """Return the file of a section; the file does not exist if there is no section of this name."""
    return FOLDER / f"{name}.toml"
