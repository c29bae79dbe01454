"""Sections as tables for people."""

import math
from collections.abc import Iterator

from meshes.section.section import Section

STRATA_HEADS = (
    "stratum", "area\nm²", "thickness\nm", "from-to x\nm", "E\nMPa", "ν\n", "ρ ord/seis\nt/m³", "c\nkPa", "φ/ψ\ndeg",
)  # fmt: skip


def strata_rows(section: Section) -> Iterator[list[str]]:
    """Every stratum as a person reads it: name, area, thickness, reach, and its parameters."""
    layers = section.layering
    at_left, at_right = layers.thickness()
    for k, (stratum, area) in enumerate(zip(section.strata, layers.areas(), strict=True)):
        here = layers.present()[:, k]
        ends = [*at_left[here, k], *at_right[here, k]]
        start, end = layers.x[:-1][here].min(), layers.x[1:][here].max()
        yield [
            stratum.name,
            f"{area:.1f}",
            f"{min(ends):.1f}-{max(ends):.1f}",
            f"{start:.4g}-{end:.4g}",
            f"{stratum.youngs_modulus / 1e6:.4g}",
            f"{stratum.poissons_ratio:g}",
            f"{stratum.density_ordinary / 1e3:.4g}/{stratum.density_seismic / 1e3:.4g}",
            f"{stratum.cohesion / 1e3:.4g}",
            f"{math.degrees(stratum.friction_angle):.3g}/{math.degrees(stratum.dilation_angle):.3g}",
        ]
