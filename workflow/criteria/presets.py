"""Published criteria by name. A preset is here only if its text was read; nothing else is printed under its name."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Preset = Literal["hynes_griffin_franklin_1984", "nchrp_611"]


@dataclass(frozen=True)
class PublishedCriterion:
    """A factor of safety under a share of the peak acceleration, and the displacement that it stands for.

    Attributes
    ----------
    factor : least factor of safety
    share : Kh over the peak acceleration of the ground over gravity
    displacement : m, up to which ground moves that has this factor
    source : where that is published, and what it holds for
    """

    factor: float
    share: float
    displacement: float
    source: str


PRESETS: Mapping[Preset, PublishedCriterion] = {
    # 350 records and more: a factor above 1 under half of the peak acceleration keeps earth dams to about 1 m.
    "hynes_griffin_franklin_1984": PublishedCriterion(
        1.0, 0.5, 1.0,
        "M. E. Hynes-Griffin & A. G. Franklin, US Army Waterways Experiment Station, MP GL-84-13 (1984); earth dams "
        "that do not liquefy, with strengths lowered for the pore pressure of shaking",
    ),
    # C/D ratio of 1.1 under half of the site-adjusted peak acceleration: less than 1 to 2 inches.
    "nchrp_611": PublishedCriterion(
        1.1, 0.5, 0.05,
        "D. G. Anderson et al., NCHRP Report 611 (2008), chapter 8; slopes that do not liquefy, peak acceleration of "
        "the site",
    ),
}  # fmt: skip
