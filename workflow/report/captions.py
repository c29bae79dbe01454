"""Collects the pictures of a report: with captions, and embedded in the page as data."""

import base64
import io
import re
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from typing import NamedTuple

from PIL import Image

from workflow.texts.report_texts import Texts

COLOURS = 64  # of a drawing without smooth shades


class Caption(NamedTuple):
    """Holds a pattern of file names, the section of the report for these pictures, and their caption.

    Pictures that are not ``main`` stand at the end of the page, and are not printed.
    """

    pattern: str
    section: str
    description: str
    main: bool = False


# In the order in which the report shows them.
CAPTIONS = (
    Caption(
        r"front",
        "front",
        "The section in true proportions, with its layers and the direction of the seismic force; with water, borings, "
        "the slip surface at the critical Kh, and the surface after the largest slide, if there are any.",
        True,
    ),
    Caption(r"section", "ground", "The layers. Dotted: liquefiable. Dashed line: water table.", True),
    Caption(r"weights", "ground", "Unit weight of the ground, surcharges and pore pressure, without shaking.", True),
    Caption(r"site_response", "response", "Response of the layers to the record of the rock, against depth."),
    Caption(
        r"triggering",
        "triggering",
        "Blow counts and F_L against depth at each boring, with the strata and the water table.",
        True,
    ),
    Caption(r"mesh", "ground", "The mesh of the continuum."),
    Caption(
        r"curves",
        "both",
        "Kh against displacement of the continuum and of the discs. Bands: brackets of the critical Kh of discs and of "
        "paths. The critical Kh of soil discs, which harden and have no plateau, is the largest moving average of Kh "
        "up to the displacement at the vertical line; each average spans a fifth of the displacement at this line.",
        True,
    ),
    Caption(
        r"slip_surfaces",
        "both",
        "Slip surfaces of the continuum and of the discs. Slip surfaces of soil discs are drawn when a shear band has "
        "formed, at a larger displacement than that of their critical Kh.",
        True,
    ),
    Caption(
        r"fem_plateau",
        "fem",
        "Continuum at the last step of the path: displacement, mobilised strength and slip surface.",
        True,
    ),
    Caption(
        r"fem_kh_(\d+\.\d+)",
        "fem",
        "Continuum at Kh = {0}: displacement since gravity, and mobilised strength.",
    ),
    Caption(r"fem_curve", "fem", "Continuum: Kh and displacement of every converged step as Kh rises."),
    Caption(r"fem_safety", "fem", "Continuum: slip surface with the strength divided by the factor of safety."),
    Caption(r"fem_.*", "fem", "Continuum."),
    Caption(r"bounds_mechanism", "bounds", "Limit analysis: mechanism of the strict upper bound."),
    Caption(
        r"bounds_stress",
        "bounds",
        "Limit analysis: mobilised strength in the stress field of the strict lower bound.",
    ),
    Caption(r"bounds_.*", "bounds", "Limit analysis: triangles of the strict bounds."),
    Caption(r"slip_circles", "bounds", "Limit equilibrium: the critical slip circles by Bishop's simplified method."),
    Caption(r"case(\d+)", "slide", "Case {0}, calibrated discs.", True),
    Caption(r"mpm_case(\d+)", "slide", "Case {0}, material points."),
    Caption(r"mpm", "slide", "The ground surface before and after the slide by the material point method.", True),
    Caption(r"history", "slide", "Settlement and slide in time.", True),
    Caption(
        r"profiles",
        "slide",
        "The ground surface before and after the slide on all random packings: median, and range of the packings.",
        True,
    ),
    Caption(r"case(\d+)_table2", "slide", "Case {0}, discs with the springs of the paper's Table 2."),
    Caption(r"case(\d+).*", "slide", "Case {0}."),
    Caption(
        r"calibration",
        "dem",
        "Influence of each parameter on the critical Kh of the discs, and trials of the calibration.",
    ),
    Caption(r"dem_model", "dem", "The discs by layer, at rest under their weight. Dark: fixed boundary discs."),
    Caption(r"dem_before_kh_(.*)", "dem", "Discs before calibration, Kh = {0}: displacement."),
    Caption(r"dem_paper_kh_(.*)", "dem", "The discs of the paper, Kh = {0}: displacement and pore springs."),
    Caption(r"dem_after_kh_(.*)", "dem", "Calibrated discs, Kh = {0}: displacement."),
    Caption(r"dem_.*", "dem", "The discs."),
    Caption(r"displacements", "comparison", "Displacements by all methods.", True),
    Caption(
        r"study_fails",
        "study",
        "The critical Kh of all samples, and the probability that the critical Kh is below a given Kh.",
        True,
    ),
    Caption(r"study_effects", "study", "Effect of each uncertain number on the results: rank correlations.", True),
    Caption(r"study_fragility", "study", "Probability that a slide exceeds a length.", True),
    Caption(r"study_samples", "study", "Every sample: the first result against each uncertain number."),
    Caption(
        r"study_samples_case(\d+)", "study", "Case {0} of every sample: largest slide against each uncertain number."
    ),
    Caption(r"sliding_block", "comparison", "The rigid block under the accelerogram, in both directions.", True),
)

# Captions of pictures that show discs, if there are any, where there are none.
WITHOUT_DISCS = {
    "curves": "Kh against displacement of the continuum. Line: limit load. Band: bracket of the critical Kh of a path.",
    "slip_surfaces": "Slip surface of the continuum.",
}
OF_DISCS = r"(dem_|case\d).*"  # pictures that are there if discs are


@dataclass(frozen=True)
class Picture:
    """Holds a picture of the report: its name, section, caption, and data as a URI."""

    name: str
    section: str
    main: bool
    caption: str
    data: str
    width: int
    height: int


def collect(names: Sequence[str], folder: Path, width: int, texts: Texts | None = None) -> list[Picture]:
    """Return the pictures with these names in a folder, at most ``width`` pixels wide, in the report's order; captions
    in the language of ``texts``."""
    captions = list(_captioned(names, folder, texts or Texts()))
    with ThreadPoolExecutor() as threads:  # Pillow lets go of Python's lock
        return list(threads.map(lambda each: _picture(folder / each[0], each[0], each[1], each[2], width), captions))


def _captioned(names: Sequence[str], folder: Path, texts: Texts) -> Iterator[tuple[str, Caption, str]]:
    """Yield every picture in the folder with the first caption whose pattern matches its name."""
    left = sorted((name for name in set(names) if name.endswith(".png") and (folder / name).is_file()), key=_by_number)
    without = {} if any(re.match(OF_DISCS, Path(name).name) for name in left) else WITHOUT_DISCS
    for caption in CAPTIONS:
        for name in list(left):
            match = re.fullmatch(caption.pattern, Path(name).stem)
            if match is not None:
                left.remove(name)
                yield name, caption, texts(without.get(caption.pattern, caption.description)).format(*match.groups())


def _by_number(name: str) -> list[tuple[int, float, str]]:
    """Return a sort key by the numbers in a name: case 2 before case 10, Kh = 0.2 before 0.25."""
    parts = re.split(r"(\d+(?:\.\d+)?)", name)
    return [(0, float(part), "") if number else (1, 0.0, part) for part, number in zip(parts, cycle((False, True)))]


def _picture(path: Path, name: str, caption: Caption, words: str, width: int) -> Picture:
    with Image.open(path) as image:
        small = image.convert("RGB")
    if small.width > width:
        small = small.resize((width, round(small.height * width / small.width)), Image.Resampling.LANCZOS)
    data = f"data:image/webp;base64,{base64.b64encode(compressed(small)).decode()}"
    return Picture(name, caption.section, caption.main, words, data, *small.size)


def compressed(image: Image.Image) -> bytes:
    """Compress a picture as lossless WebP with few colours: half the size of lossy WebP for drawings.

    Pillow's default effort takes 1.7 times as long for pictures 1 % smaller.
    """
    buffer = io.BytesIO()
    few = image.quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).convert("RGB")
    few.save(buffer, "WEBP", method=2, lossless=True, quality=50)
    return buffer.getvalue()
