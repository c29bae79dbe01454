"""Draws acceleration, shear strain, shear stress and average acceleration with depth, side by side."""

from meshes.section.section import Section
from workflow.figures.canvas import CONTINUUM, INK, Frames
from workflow.figures.colours import soil_colours
from workflow.results.site_response import SiteResponseAnswer

HEIGHT = 5.0  # inches


def draw(section: Section, answer: SiteResponseAnswer) -> Frames:
    """Draw four frames over the strata: acceleration, shear strain, shear stress and average acceleration with depth.

    Parameters
    ----------
    section : the section, for its heading and the colours of the strata
    answer : response of a column of the section to a record

    Returns
    -------
    The picture.
    """
    picture = Frames(HEIGHT, f"{section.heading}: response at x = {answer.x_m:g} m to {answer.record}")
    names = [stratum.name for stratum in section.strata]
    layers = answer.layers
    tops, bottoms = [layer.top_m for layer in layers], [layer.bottom_m for layer in layers]
    middles = [0.5 * (layer.top_m + layer.bottom_m) for layer in layers]
    curves = (
        ("largest acceleration (gal)", [layer.acceleration_gal for layer in layers], tops),
        ("largest shear strain (%)", [100.0 * layer.strain for layer in layers], middles),
        ("largest shear stress (kPa)", [layer.stress_kPa for layer in layers], bottoms),
        ("k_max of the ground above (-)", [layer.k_max for layer in layers], bottoms),
    )
    for axes, (label, values, depths) in zip(picture.figure.subplots(1, 4, sharey=True), curves, strict=True):
        for layer in layers:
            colour = soil_colours(names)[names.index(layer.stratum)]
            axes.axhspan(layer.top_m, layer.bottom_m, color=colour, alpha=0.75, linewidth=0)
        axes.plot(values, depths, color=CONTINUUM, marker="o", markersize=2.5)
        axes.set_xlabel(label, fontsize=8, color=INK, parse_math=False)
        axes.set_xlim(left=0.0)
        axes.tick_params(labelsize=7, colors=INK)
        axes.grid(color="white", linewidth=0.5)
    first = picture.figure.axes[0]
    first.set_ylim(bottoms[-1], 0.0)
    first.set_ylabel("depth (m)", fontsize=8, color=INK)
    return picture
