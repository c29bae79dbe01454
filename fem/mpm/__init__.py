"""Provides the material point method, which computes the continuum in large displacement. The slides by this method are
compared with those of the discs.

`ground_of` makes material points of a section, `MaterialPointEngine` moves them on a background grid, and `PointSlider`
takes them through shaking and liquefaction until the surface is at rest. For problems without a section, such as the
collapse of a column, build `MaterialPoints` and a `BackgroundGrid` directly.
"""

from fem.mpm.engine import MaterialPointEnergy, MaterialPointEngine
from fem.mpm.grid import BackgroundGrid
from fem.mpm.ground import PointGround, ground_of
from fem.mpm.points import MaterialPoints, PointSoil
from fem.mpm.slide import PointSlider, SlideProgramme
from fem.mpm.slide_record import PointSlide
