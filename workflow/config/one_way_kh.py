"""Reports faces of the ground from which a constant Kh, which acts to one side, drives no slide."""

import numpy as np

from dem.settings import SlideSettings
from meshes.section.polyline import downhill

LEAST_HEIGHT, LEAST_SHARE = 1.0, 0.2  # m, and of the relief of the section: a lower rise of the ground is no face


def faces_without_kh(ground: np.ndarray, slide: SlideSettings) -> list[str]:
    """Return a notice if the ground has a face towards the side to which the constant Kh of slides does not act, and
    the settings do not say to which side it acts; else an empty list.

    Parameters
    ----------
    ground : points (n, 2) of the ground surface (m), x ascending
    slide : settings of the slides
    """
    if slide.kh == 0.0 or slide.kh_towards or slide.kh_cycles is not None or slide.accelerogram:
        return []
    along = ground[:: downhill(ground), 1]  # as Kh acts
    rise = float((along - np.minimum.accumulate(along)).max())
    if rise < max(LEAST_HEIGHT, LEAST_SHARE * float(np.ptp(along))):
        return []
    towards, other = ("right", "left") if downhill(ground) > 0 else ("left", "right")
    return [
        f"slide, kh: a constant Kh acts towards the {towards} alone, but the ground also falls by {rise:.1f} m towards "
        f'the {other}, where it may slide farther: compute this side, too, with kh_towards = "{other}", or give '
        "kh_cycles and kh_period"
    ]
