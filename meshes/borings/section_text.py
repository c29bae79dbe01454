"""Writes a section made from borings as TOML with comments, for the user to complete."""

import json
import math
from collections.abc import Iterator, Sequence

import numpy as np

from meshes.borings.blows import is_refusal
from meshes.borings.boring import Sample
from meshes.borings.connect import ConnectedBorings, PlacedBoring
from meshes.borings.log import Log, LogLayer

CLAYEY = 50.0  # % of fines from which a layer is taken for cohesive
STEEPEST = 45.0  # degrees
WIDER = 1.5  # heights of the section by which it extends beyond the borings, so that its sides are far from a slide


def text_of(connected: ConnectedBorings, name: str) -> str:
    """Return the section of connected borings as TOML.

    Parameters
    ----------
    connected : strata between the borings
    name : name of the section

    Returns
    -------
    Text of the file. Quantities that were not measured are comments, which the user has to replace by values.
    """
    return "\n".join([*_head_lines(connected, name), *_strata(connected), *_borings(connected)]) + "\n"


def _head_lines(connected: ConnectedBorings, name: str) -> Iterator[str]:
    logs = [boring.log for boring in connected.borings]
    yield "# Section from borings: " + ", ".join(log.name for log in logs) + "."
    yield "# Layers are connected by name; a layer that the next boring has not ends half-way, fill of an"
    yield "# embankment at the next boring. Correct what is wrong."
    for boring in (*connected.borings, *connected.soundings):
        if boring.off_line:
            yield f"# Boring {boring.log.name} stood {abs(boring.off_line):.1f} m beside the line of the section."
    yield from (f"# {text[0].upper()}{text[1:]}." for text in connected.notices)
    yield ""
    yield f"name = {json.dumps(name)}"
    yield f"surface = {_points(connected.x[::2], connected.ground[::2])}"
    above = connected.bottoms[-2] if len(connected.names) > 1 else connected.ground
    base = min(min(log.bottom for log in logs), float(above.min()) - 1.0)  # the lowest stratum is somewhere 1 m thick
    yield f"base = {{ elevation = {math.floor(base * 10.0) / 10.0:g} }}     # the deepest boring; firm ground is better"
    wide = 10.0 * math.ceil(WIDER * (max(log.ground_level for log in logs) - base) / 10.0)
    yield f'beyond = "{wide:g} m"                 # ground, layers and water continue level this far'
    yield ""
    yield from water_lines(connected.borings, float(connected.x[0]), float(connected.x[-1]))


def water_lines(borings: Sequence[PlacedBoring], left: float, right: float) -> Iterator[str]:
    """Yield the lines of a water table from x ``left`` to ``right`` (m) through the levels that borings report."""
    water = [(boring.x, boring.log.water_level) for boring in borings if boring.log.water_level is not None]
    yield "[water]"
    if len(water) > 1:
        x, level = np.array(water).T
        across = np.unique([left, *x, right])
        comment = "     # level beyond the borings that report it" if len(across) > len(x) else ""
        yield f"table = {_points(across, np.interp(across, x, level))}{comment}"
    elif water:
        yield f"table = {_exact(water[0][1])}"
    else:
        yield "# table = 0.0                     # no boring reports the water level"
    yield ""


def _strata(connected: ConnectedBorings) -> Iterator[str]:
    logs = [boring.log for boring in connected.borings]
    for k, name in enumerate(connected.names):
        yield "[[strata]]"
        yield f"name = {json.dumps(name, ensure_ascii=False)}"
        if k + 1 < len(connected.names):
            yield f"bottom = {{ elevation = {_points(connected.x, connected.bottoms[k])} }}"
        yield from soil_lines([(layer, log) for log in logs for layer in log.layers if layer.name == name])
        yield ""


def soil_lines(layers: Sequence[tuple[LogLayer, Log]]) -> Iterator[str]:
    """Yield the lines of a soil that borings met in ``layers``, each with its boring: description, density, and what
    the blow counts let estimate."""
    counts = [sample for layer, log in layers for sample in log.samples if layer.top <= sample.depth <= layer.bottom]
    described = next((layer.description for layer, _ in layers if layer.description), "")
    if described:
        yield f"description = {json.dumps(' '.join(described.split())[:120], ensure_ascii=False)}"
    weights = list(dict.fromkeys(layer.unit_weight for layer, _ in layers if layer.unit_weight))
    if weights:
        more = f"      # other borings report {', '.join(weights[1:])}" if len(weights) > 1 else ""
        yield f"density = {_quantity(weights[0])}{more}"
    else:
        yield '# density = "18 kN/m^3"           # not measured: give it'
    yield from _strength(counts)


def _strength(counts: list[Sample]) -> Iterator[str]:
    """Yield lines with stiffness and strength estimated from the mean blow count. Each line states the estimate beside
    the value. Refusals are left out where the layer has other tests: one stone in a soft clay would raise the mean."""
    if not counts:
        for key, value in (("youngs_modulus", '"20 MPa"'), ("poissons_ratio", "0.33"), ("cohesion", '"0 kPa"'),
                           ("friction_angle", '"30 deg"')):  # fmt: skip
            yield f"# {key} = {value:<18}   # no blow count: give it"
        return
    counted = [sample.N for sample in counts if not is_refusal(sample.N)]
    left_out = len(counts) - len(counted) if counted else 0
    blows = float(np.mean(counted or [sample.N for sample in counts]))
    without = f", without {left_out} refusal{'s' if left_out > 1 else ''}" if left_out else ""
    fines = [sample.fines for sample in counts if sample.fines is not None]
    clayey = bool(fines) and float(np.mean(fines)) >= CLAYEY
    stiff = max(2.8 * blows, 1.0)
    yield f'youngs_modulus = "{stiff:.3g} MPa"      # estimated: 2800 kPa times N = {blows:.3g}{without} (highway code)'
    yield f"poissons_ratio = {0.45 if clayey else 0.33}              # estimated"
    if clayey:
        yield f'cohesion = "{max(6.25 * blows, 1.0):.3g} kPa"          # estimated: 6.25 kPa times N (Terzaghi & Peck)'
        yield 'friction_angle = "0 deg"'
    else:
        yield 'cohesion = "0 kPa"'
        angle = min(STEEPEST, 15.0 + math.sqrt(15.0 * blows))
        yield f'friction_angle = "{angle:.1f} deg"      # estimated: 15 + √(15 N), at most 45 (highway code)'
        yield '# liquefies_in = "triggered"      # with a table [earthquake]'


def _borings(connected: ConnectedBorings) -> Iterator[str]:
    yield "[slide]"
    yield "# kh = 0                          # slides under the weight alone; else Kh by [earthquake], or 0.1"
    yield '# accelerogram = "record.AT2"     # or a record of the motion of the base'
    yield ""
    yield "# [earthquake]"
    yield "# magnitude = 7.5"
    yield '# peak_acceleration = "250 gal"'
    everything = sorted([*connected.borings, *connected.soundings], key=lambda boring: boring.x)
    if any(boring.log.cones for boring in everything):
        yield ""
        yield "# [triggering]"
        yield '# method = "boulanger_idriss_2014"     # uses the cones; the default uses blow counts'
    yield from boring_lines(everything)


def boring_lines(borings: Sequence[PlacedBoring]) -> Iterator[str]:
    """Yield the tables of the borings that have tests."""
    for boring in borings:
        if not boring.log.samples and not boring.log.cones:
            continue
        yield ""
        yield "[[triggering.borings]]"
        yield f"name = {json.dumps(boring.log.name, ensure_ascii=False)}"
        yield f"x = {_exact(boring.x)}"
        yield from _tests(boring.log)


def _tests(log: Log) -> Iterator[str]:
    if log.samples:
        yield "spt = ["
        for sample in log.samples:
            more = f", fines = {sample.fines:g}" if sample.fines is not None else ""
            more += f", plasticity = {sample.plasticity:g}" if sample.plasticity is not None else ""
            more += f', d50 = "{1000.0 * sample.d50:g} mm"' if sample.d50 is not None else ""
            more += f", energy_ratio = {sample.energy_ratio:g}" if sample.energy_ratio is not None else ""
            refused = (
                f"     # at least: {' '.join(str(getattr(sample.N, 'written', '')).split())}"
                if is_refusal(sample.N)
                else ""
            )
            yield f"  {{ depth = {sample.depth:g}, N = {sample.N:g}{more} }},{refused}"
        yield "]"
    if log.cones:
        yield "cpt = ["
        for cone in log.cones:
            more = f", fines = {cone.fines:g}" if cone.fines is not None else ""
            yield f'  {{ depth = {cone.depth:g}, qc = "{cone.qc / 1e6:g} MPa", fs = "{cone.fs / 1e3:g} kPa"{more} }},'
        yield "]"


def _points(x: np.ndarray, z: np.ndarray) -> str:
    """Return the points of a line, without points that lie on a straight line between their neighbours."""
    keep = [0]
    for i in range(1, len(x) - 1):
        a = keep[-1]
        straight = z[a] + (z[i + 1] - z[a]) * (x[i] - x[a]) / (x[i + 1] - x[a])
        if abs(straight - z[i]) > 1e-6:
            keep.append(i)
    keep.append(len(x) - 1)
    return "[" + ", ".join(f"[{_exact(x[i])}, {_exact(z[i])}]" for i in keep) + "]"


def _exact(coordinate: float) -> str:
    """Return a coordinate (m) to the millimetre, those of national grids, too."""
    return f"{coordinate:.3f}".rstrip("0").rstrip(".")


def _quantity(written: str) -> str:
    try:
        return f"{float(written):g}"
    except ValueError:
        return json.dumps(written)
