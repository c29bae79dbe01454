"""A slide as it went."""

from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np

from dem.slides.rest import moved_lately
from dem.slides.row import Row

MOVES = 2.0  # times what Kh alone does, beyond which a disc of the surface slides


@dataclass
class Slide:
    """The result of a slide: its history, and the reason for its end.

    Attributes
    ----------
    rows : list of Row
        One for every look.
    settled : bool
        Whether the surface has come to rest.
    reason : str
        Why the slide is over.
    escaped : int
        Discs outside of the rigid lines.
    loose_share : float
        Share of the mass that has left the connected ground: flown, or rolled away.
    slide_max_at_x_m : float
        Where the surface slid furthest (m).
    slide : list of float
        How far each disc of the surface slid, smoothed, from uphill to downhill (m).
    slide_along : list of [x, slide]
        The same from left to right, over where the disc was before (m).
    surface_before, surface_after : list of [x, z]
        Tops of the discs that are the surface then (m).
    seconds_simulated : float
        Since the onset (s).
    step_share : float
        Time step over the stable one.
    overlap : float
        Deepest overlap of two discs at any look, over their mean radius.
    area_lost_share : float
        Share of the ground's area that is gone beyond what drained away and what springs gave way.
    slide_by_weight_m : float or None
        How far the same case slides at most without any shaking, where that was looked at (m).
    flows : bool or None
        Whether that is a flow failure.
    stopped_by : str or None
        "left" or "right", the side of the box that the slide ran up against.
    notes : list of str
        What a reader must know to believe the numbers, what weighs most first: that it flows without shaking, sides
        that take part, discs in the walls, ground that was lost, discs that are too strong, layers too thin.
    """

    rows: list[Row] = field(default_factory=list)
    settled: bool = False
    reason: str = ""
    escaped: int = 0
    loose_share: float = 0.0
    slide_max_at_x_m: float = 0.0
    slide: list[float] = field(default_factory=list)
    slide_along: list[list[float]] = field(default_factory=list)
    surface_before: list[list[float]] = field(default_factory=list)
    surface_after: list[list[float]] = field(default_factory=list)
    seconds_simulated: float = 0.0
    step_share: float = 0.3
    overlap: float = 0.0
    area_lost_share: float = 0.0
    slide_by_weight_m: float | None = None
    flows: bool | None = None
    stopped_by: str | None = None
    notes: list[str] = field(default_factory=list)

    def as_json(self, alone: "Slide | None" = None) -> dict[str, Any]:
        """The numbers of a case. alone: the same ground under Kh alone, to tell sliding from giving way."""
        last = asdict(self.rows[-1])
        kept = {key: last[key] for key in last if key.startswith(("settlement", "slide", "crack_"))}
        out = {
            **kept,
            **{item.name: getattr(self, item.name) for item in fields(self) if item.name not in ("rows", "slide")},
            "cracked_pore_springs": self.rows[-1].cracked,
            "moved_lately_m": moved_lately([row.time_s for row in self.rows], [row.slide_max_m for row in self.rows]),
        }
        if alone is not None:
            moving = np.array(self.slide) > MOVES * np.maximum(np.array(alone.slide), 0.0)
            half = len(moving) // 2
            out["slides_over_share"] = float(moving.mean())
            out["slides_over_share_uphill"] = float(moving[:half].mean())
            out["slides_over_share_downhill"] = float(moving[half:].mean())
        return out
