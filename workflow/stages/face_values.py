"""Computes the critical Kh or the factor of safety of one face of a structure, by finite elements and bounds: with as
many strong zones elsewhere as its failure takes to contain the crest. Also computes the factors of safety of all faces
in ground with another strength or pore pressure than that of the input.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from fem.continuum.loads import Direction
from fem.search.strong_zones import StrongZone
from meshes.errors import InputError, NoAnswerError
from meshes.executor import Tell
from workflow.config import Config
from workflow.estimates.face_zones import Surface, is_of_face, zones_against
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import CrestedStructure, structures_of
from workflow.results.answer import line
from workflow.results.faces import FaceAtRest, FaceValue, StrongZonePart
from workflow.results.slices import CirclesAtRest

if TYPE_CHECKING:
    from fem.search.face_limits import FaceLimit
    from meshes.section.section import Section

Quantity = Literal["critical Kh", "factor of safety"]
ATTEMPTS = 3  # failures that are excluded one after the other
MOST_STRUCTURES = 2  # whose faces are computed by default
BOUNDS_SHARE = 0.5  # of the work of the bounds of the section, for each face
NO_SURFACE = (
    "the ground that fails at {value:.3g} in finite elements has no slip surface, so that it is open whether a crest "
    "is part of this failure"
)


@dataclass(frozen=True, eq=False)
class FaceTask:
    """Identifies the critical Kh or the factor of safety of one face, which is to be computed.

    Attributes
    ----------
    config : config of the run.
    structure, side : the structure, and the side of the face.
    quantity : name of the quantity to compute.
    without_zones : the value in the section without strong zones, or the reason why there is none.
    circle : critical slip circle of the face; empty without one.
    """

    config: Config
    structure: CrestedStructure
    side: int
    quantity: Quantity
    without_zones: "FaceLimit | str"
    circle: Surface


def unchanged_value(config: Config, task: tuple[Quantity, int], tell: Tell) -> "FaceLimit | str":
    """Return a quantity of the section without strong zones, towards a side, or the reason why there is none."""
    tell("finite elements")
    try:
        return _computed(config, *task, ())
    except (InputError, NoAnswerError) as error:
        return str(error)


def face_value(task: FaceTask, tell: Tell) -> FaceValue | str:
    """Return the quantity of a face, with as many strong zones as necessary, or the reason why there is none."""
    zones: tuple[StrongZone, ...] = ()
    if isinstance(task.without_zones, str):
        return task.without_zones
    result = task.without_zones
    try:
        for attempt in range(ATTEMPTS + 1):
            moving = result.moving(task.config.section)
            if not len(moving):
                return NO_SURFACE.format(value=result.value)
            if is_of_face(task.structure, task.side, moving, result.sides) or attempt == ATTEMPTS:
                break
            more = zones_against(
                task.config.section, task.structure, task.side, moving, task.circle, zones,
                task.config.fem.least_depth, result.sides,
            )  # fmt: skip
            if more is None:
                break
            zones = more
            tell("finite elements, with strong zones elsewhere")
            result = _computed(task.config, task.quantity, task.side, zones)
    except (InputError, NoAnswerError) as error:
        return str(error)
    low, high = _bounded(task, zones, tell)
    return FaceValue(
        value=result.value,
        davis=result.davis,
        lower=low,
        upper=high,
        slip_surface=line(result.surface),
        strong_zones=tuple(StrongZonePart.model_validate(each) for each in zones),
        reaches_crest=is_of_face(task.structure, task.side, result.moving(task.config.section), result.sides),
    )


def _direction(config: Config, side: int) -> Direction:
    from fem.continuum.loads import sign_of

    return "downhill" if sign_of(config.section, "downhill") == side else "uphill"


def _computed(config: Config, quantity: Quantity, side: int, zones: tuple[StrongZone, ...]) -> "FaceLimit":
    """Return a quantity by finite elements, in ground with strong zones; raise InputError, NoAnswerError."""
    from fem.search.face_limits import critical_of_face, safety_of_face

    ground = _ground(config, zones)
    if quantity == "critical Kh":
        return critical_of_face(ground, config.mesh, config.fem, _direction(config, side))
    return safety_of_face(ground, config.mesh, config.fem)


def _bounded(task: FaceTask, zones: tuple[StrongZone, ...], tell: Tell) -> tuple[float | None, float | None]:
    """Return strict bounds with ψ = φ in ground with strong zones, and tell when they are computed. Return None without
    strong zones: faces that fail first have the bounds of the section."""
    from fem.limit.bounds import ProvenUnstableError, kh_bounds
    from fem.limit.safety_bounds import safety_bounds

    config = task.config
    if not zones or not config.faces.bounds or config.bounds.run is False:
        return None, None
    share = config.bounds.changed(seconds=BOUNDS_SHARE * config.bounds.seconds)
    ground, full = (
        _ground(config, zones),
        config.fem.changed(direction=_direction(config, task.side), flow="associated"),
    )
    try:
        if task.quantity == "critical Kh":
            tell("strict bounds")
            try:
                of_kh = kh_bounds(ground, full, share)
            except ProvenUnstableError as error:  # a bound below 0 counts as any other
                of_kh = error.bounds
            return (of_kh.lower if of_kh.stress else None), (of_kh.upper if of_kh.mechanism else None)
        if config.bounds.safety_factor:
            tell("strict bounds")
            of_factor = safety_bounds(ground, full, share.of_factors, 0.0, smooth_sides=True)
            return of_factor.lower or None, (of_factor.upper if math.isfinite(of_factor.upper) else None)
    except NoAnswerError:
        pass
    return None, None


def _ground(config: Config, zones: tuple[StrongZone, ...]) -> "Section":
    from fem.search.strong_zones import with_strong_zones

    return with_strong_zones(config.section, zones) if zones else config.section


def unwanted(config: Config) -> str:
    """Return the reason why the faces are not computed; empty if they are."""
    count = len(structures_of(config.section))
    if not count:
        return "there are no structures"
    if config.faces.run is False:
        return "faces.run is false"
    if config.faces.run == "auto" and count > MOST_STRUCTURES:
        return f"there are {count} structures, more than {MOST_STRUCTURES}: faces.run = true computes their faces"
    return ""


def faces_at_rest(section: "Section", config: Config, circles: CirclesAtRest | None) -> tuple[FaceAtRest, ...]:
    """Return the factor of safety of every face that has a slip circle, by finite elements on one mesh, in a
    ``section`` after shaking or liquefaction; nothing if the stage `faces` is not wanted.

    ``circles``: the circles of the faces in this section.
    """
    if circles is None or not circles.faces or unwanted(config):
        return ()
    ground = config.model_copy(update={"section": section})
    ground = ground.with_settings("fem", accuracy=0.0, kh=()).with_settings("faces", bounds=False)
    whole = unchanged_value(ground, ("factor of safety", LEFT), _silent)
    answers = []
    for structure in structures_of(config.section):
        ends = structure.crest.start, structure.crest.end
        for face in circles.faces:
            if (face.start_m, face.end_m) != ends:
                continue
            side = LEFT if face.towards == "left" else RIGHT
            task = FaceTask(ground, structure, side, "factor of safety", whole, face.circle.surface_m)
            value = face_value(task, _silent)
            answers.append(
                FaceAtRest(
                    structure=structure.name,
                    towards=face.towards,
                    safety=value if isinstance(value, FaceValue) else None,
                    reason="" if isinstance(value, FaceValue) else value,
                )
            )
    return tuple(answers)


def _silent(message: str) -> None:
    """Report nothing: the stage names the case that it computes."""
