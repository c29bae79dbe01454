"""Defines the stage `faces`: critical Kh and factor of safety of every face of the structures by finite elements and
bounds."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from fem.continuum.loads import Direction
from fem.search.strong_zones import StrongZone
from fem.settings import WITHOUT_EFFECT
from meshes.errors import InputError, NoAnswerError
from meshes.executor import Tell
from workflow.config import Config
from workflow.estimates.face_zones import Surface, is_of_face, zones_against
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import CrestedStructure, structures_of
from workflow.results.answer import SectionLabel, line
from workflow.results.continuum import FemAnswer
from workflow.results.faces import FacesAnswer, FaceStrength, FaceValue, StrongZonePart
from workflow.results.finished_parts import FinishedParts
from workflow.results.slices import FacePart, SlicesAnswer
from workflow.run.stage import Job, Stage

if TYPE_CHECKING:
    from fem.search.face_limits import FaceLimit
    from meshes.section.section import Section

Quantity = Literal["critical Kh", "factor of safety"]
SIDES: tuple[tuple[Literal["left", "right"], int], ...] = (("left", LEFT), ("right", RIGHT))
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


def work(job: Job) -> None:
    """Compute the critical Kh and the factor of safety of all faces; writes fem/faces.json."""
    config = job.config
    fem, slices = FemAnswer.read(job.store), SlicesAnswer.read(job.store)
    parts = {(face.structure, face.towards): face for face in slices.faces}
    places = [(structure, *towards) for structure in structures_of(config.section) for towards in SIDES]
    sliding = [place for place in places if not parts[place[0].name, place[1]].reason]
    unchanged = _unchanged(job, fem, [side for _, _, side in sliding])
    tasks = [
        task
        for structure, towards, side in sliding
        for task in _tasks(config, structure, side, parts[structure.name, towards], unchanged)
    ]

    def heard(place: int, message: str) -> None:
        job.progress(f"{tasks[place].structure.name}, {tasks[place].quantity}: {message}", None)

    values_of_faces: FinishedParts[FaceValue | str] = FinishedParts(job.store, "fem/faces", FaceValue | str)
    answers = values_of_faces.compute(job.executor, face_value, tasks, heard)
    faces = []
    for structure, towards, side in places:
        of_face = {task.quantity: value for task, value in zip(tasks, answers, strict=True)
                if (task.structure.name, task.side) == (structure.name, side)}  # fmt: skip
        values = {name: value if isinstance(value, FaceValue) else None for name, value in of_face.items()}
        faces.append(
            FaceStrength(
                structure=structure.name,
                towards=towards,
                critical=values.get("critical Kh"),
                safety=values.get("factor of safety"),
                reasons=tuple(f"{name}: {value}" for name, value in of_face.items() if isinstance(value, str)),
            )
        )
    FacesAnswer(section=SectionLabel.of(config.section), faces=tuple(faces)).write(job.store)
    values_of_faces.remove()


def _unchanged(job: Job, fem: FemAnswer, sides: Sequence[int]) -> dict[tuple[Quantity, int], "FaceLimit | str"]:
    """Return critical Kh and factor of safety of the section without strong zones towards ``sides``. Critical Kh and
    factor of safety are each computed once, or taken from the stage `fem` if its flow rule is ψ = φ.
    """
    values: dict[tuple[Quantity, int], FaceLimit | str] = dict(_of_elements(job.config, fem))
    wanted: list[tuple[Quantity, int]] = [("critical Kh", side) for side in dict.fromkeys(sides)]
    wanted += [("factor of safety", side) for side in sides[:1] if ("factor of safety", side) not in values]
    tasks = [key for key in wanted if key not in values]

    def heard(place: int, message: str) -> None:
        job.progress(f"unchanged section, {tasks[place][0]}: {message}", None)

    computed = job.executor.compute(partial(unchanged_value, job.config), tasks, heard)
    for (quantity, towards), value in zip(tasks, computed, strict=True):
        for side in (LEFT, RIGHT) if quantity == "factor of safety" else (towards,):
            values[quantity, side] = value
    return values


def _of_elements(config: Config, fem: FemAnswer) -> "Iterator[tuple[tuple[Quantity, int], FaceLimit]]":
    """Yield the quantities that the stage of the finite elements has with ψ = φ, by side."""
    from fem.continuum.loads import sign_of
    from fem.search.face_limits import FaceLimit

    if fem.flow != "associated":
        return
    mechanism = fem.last_in_equilibrium()
    if fem.has_kc and mechanism is not None and mechanism.slip_surface:
        low = None if fem.davis is None else fem.davis.kc
        towards = sign_of(config.section, fem.direction)
        yield ("critical Kh", towards), FaceLimit(fem.kc, low, np.array(mechanism.slip_surface), (towards,))
    for factor in fem.safety_factors:
        if factor.kh == 0.0 and (factor.slip_surface or factor.extent_m is not None):
            surface = np.array(factor.slip_surface).reshape(-1, 2)
            sides = tuple(LEFT if side == "left" else RIGHT for side in factor.slides_to)
            limit = FaceLimit(factor.factor, factor.davis, surface, sides, factor.extent_m)
            yield from ((("factor of safety", side), limit) for side in (LEFT, RIGHT))


def unchanged_value(config: Config, task: tuple[Quantity, int], tell: Tell) -> "FaceLimit | str":
    """Return a quantity of the section without strong zones, towards a side, or the reason why there is none."""
    tell("finite elements")
    try:
        return _computed(config, *task, ())
    except (InputError, NoAnswerError) as error:
        return str(error)


def _tasks(
    config: Config,
    structure: CrestedStructure,
    side: int,
    part: FacePart,
    unchanged: Mapping[tuple[Quantity, int], "FaceLimit | str"],
) -> list[FaceTask]:
    circle = part.critical.surface_m if part.critical is not None else ()
    at_rest = next((c.surface_m for group in part.factors if group.kh == 0.0 for c in group.circles), ())
    return [
        FaceTask(config, structure, side, "critical Kh", unchanged["critical Kh", side], circle),
        FaceTask(config, structure, side, "factor of safety", unchanged["factor of safety", side], at_rest or circle),
    ]


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


STAGE = Stage(
    name="faces",
    description="every face of structures by finite elements and bounds",
    work=work,
    needs=("fem", "slices"),
    reads=("mesh", "fem", "bounds", "faces"),
    ignores=lambda config: (
        *WITHOUT_EFFECT, "fem.kh", "fem.rigid_box", "fem.direction", "faces.run", "criteria.factor_of_safety",
        "bounds.davis",
    ),
    results=(FacesAnswer.FILE,),
    read=FacesAnswer.read,
    leftovers=("fem/faces_part*.json",),
    unwanted=unwanted,
)  # fmt: skip
