"""The pictures of a folder as a report holds them: with captions, and as text within the page."""

import base64
import io
import re
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

from PIL import Image

# Animations beyond this (bytes, all together) stay outside the report.
LARGEST_ANIMATIONS = 12_000_000

# In the order in which the report shows them: a pattern of the name, the part of the report, and what it shows.
CAPTIONS = (
    (r"section", "ground", "The layers. Dotted: liquefiable. Dashed line: water table."),
    (
        r"triggering",
        "triggering",
        "Blow counts and F_L with depth beside each boring; the strata, and the water table.",
    ),
    (r"mesh", "ground", "The mesh of the continuum."),
    (
        r"fem_kh_(\d+\.\d+)",
        "fem",
        "Continuum at Kh = {0}: displacement since gravity, and where the strength is used up.",
    ),
    (r"fem_plateau", "fem", "Continuum at the end of the path: the failure mechanism."),
    (r"fem_curve", "fem", "Continuum: the path of Kh, with every converged step."),
    (r"fem_.*", "fem", "Continuum."),
    (r"bounds_.*", "bounds", "Limit analysis: mechanism, stress field and mesh of the strict bounds."),
    (r"curves", "both", "Kh over displacement, continuum and discs on one sheet. Bands: brackets of the critical Kh."),
    (r"slip_surfaces", "both", "Slip surfaces of the continuum and of the discs."),
    (r"calibration", "dem", "Which parameter moves the critical Kh of the discs, and the trials of the calibration."),
    (r"dem_model", "dem", "The discs by layer, at rest under their weight. Dark: boundary elements."),
    (r"dem_before_kh_(.*)", "dem", "Discs before calibration, Kh = {0}: displacement and pore springs."),
    (r"dem_paper_kh_(.*)", "dem", "The paper's own discs, Kh = {0}: displacement and pore springs."),
    (r"dem_after_kh_(.*)", "dem", "Calibrated discs, Kh = {0}: displacement and pore springs."),
    (r"dem_.*", "dem", "The discs."),
    (r"case(\d+)", "slide", "Case {0}, calibrated discs."),
    (r"case(\d+)_table2", "slide", "Case {0}, springs of Table 2 as printed."),
    (r"case(\d+).*", "slide", "Case {0}."),
    (r"history", "slide", "Settlement and slide in time."),
    (r"sliding_block", "comparison", "The rigid block under the accelerogram, both ways."),
)


@dataclass(frozen=True)
class Picture:
    """A picture within a page: its name, its part of the report, what it shows, and its data as a URI."""

    name: str
    part: str
    caption: str
    data: str
    width: int
    height: int


def collect(names: list[str], folder: Path, width: int, animations: bool = False) -> list[Picture]:
    """The pictures with these names in a folder, at most ``width`` pixels wide, in the report's order."""
    found: list[Picture] = []
    room = LARGEST_ANIMATIONS
    for pattern, part, words in CAPTIONS:
        for name in sorted(names, key=_by_number):
            path = folder / name
            match = re.fullmatch(pattern, path.stem)
            if match is None or any(name == picture.name for picture in found) or not path.is_file():
                continue
            if path.suffix == ".gif":
                size = path.stat().st_size
                if not animations or size > room:
                    continue
                room -= size
                found.append(_animation(path, name, part, words.format(*match.groups()) + " Animation."))
            else:
                found.append(_still(path, name, part, words.format(*match.groups()), width))
    return found


def _by_number(name: str) -> list[tuple[int, float, str]]:
    """A key that sorts names as people count: case 2 before case 10, Kh = 0.2 before 0.25."""
    parts = re.split(r"(\d+(?:\.\d+)?)", name)
    return [(0, float(part), "") if number else (1, 0.0, part) for part, number in zip(parts, cycle((False, True)))]


def _still(path: Path, name: str, part: str, caption: str, width: int) -> Picture:
    """A picture in 256 colours, which is a third of its size and looks the same."""
    with Image.open(path) as image:
        small = image.convert("RGB")
    if small.width > width:
        small = small.resize((width, round(small.height * width / small.width)), Image.Resampling.LANCZOS)
    buffer = io.BytesIO()
    small.quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(buffer, "PNG")
    return Picture(name, part, caption, _uri("png", buffer.getvalue()), *small.size)


def _animation(path: Path, name: str, part: str, caption: str) -> Picture:
    with Image.open(path) as image:
        size = image.size
    return Picture(name, part, caption, _uri("gif", path.read_bytes()), *size)


def _uri(kind: str, data: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
