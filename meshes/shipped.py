"""The sections that come with the program, by name."""

from pathlib import Path

FOLDER = Path(__file__).parent / "sections"


def names() -> list[str]:
    """Their names, as the files are called."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def file_of(name: str) -> Path:
    """The file of a section; it is not there if there is no section of this name."""
    return FOLDER / f"{name}.toml"
