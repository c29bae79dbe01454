"""The stage `faces`: critical Kh and factor of safety of every face of the structures by finite elements and bounds."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from fem.continuum.loads import Direction
from fem.search.strong_zones import StrongZone
from fem.settings import WITHOUT_EFFECT
from meshes.errors import InputError, NoAnswerError
from meshes.executor import Tell
from workflow.config import Config
from workflow.estimates.face_zones import Surface, is_of_face, zones_against
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import Standing, structures_of
from workflow.results.answer import SectionLabel, line
from workflow.results.continuum import FemAnswer
from workflow.results.faces import FacesAnswer, FaceStrength, FaceValue, StrongZonePart
from workflow.results.slices import FacePart, SlicesAnswer
from workflow.run.stage import Job, Stage

if TYPE_CHECKING:
    from fem.search.face_limits import FaceSearch
    from meshes.section.section import Section

Quantity = Literal["critical Kh", "factor of safety"]
SIDES: tuple[tuple[Literal["left", "right"], int], ...] = (("left", LEFT), ("right", RIGHT))
ATTEMPTS = 3  # failures that are excluded one after the other
MOST_STRUCTURES = 2  # whose faces are computed without being asked for
BOUNDS_SHARE = 0.5  # of the work of the bounds of the section, for each face


@dataclass(frozen=True)
class ElementValue:
    """A value by finite elements, and its slip surface (m)."""

    value: float
    davis: float | None
    surface: Surface


@dataclass(frozen=True, eq=False)
class FaceTask:
    """One quantity of one face.

    Attributes
    ----------
    config : of the run.
    structure, side : the face.
    quantity : what is computed.
    first : what the finite elements of the whole section say; None where it has to be computed.
    circle : the critical slip circle of the face; empty without one.
    """

    config: Config
    structure: Standing
    side: int
    quantity: Quantity
    first: ElementValue | None
    circle: Surface


def work(job: Job) -> None:
    """Compute both quantities of all faces; writes fem/faces.json."""
    config = job.config
    fem, slices = FemAnswer.read(job.store), SlicesAnswer.read(job.store)
    parts = {(face.structure, face.towards): face for face in slices.faces}
    places = [(structure, *towards) for structure in structures_of(config.section) for towards in SIDES]
    tasks = [
        task
        for structure, towards, side in places
        if not (part := parts[structure.name, towards]).reason
        for task in _tasks(config, structure, side, part, fem)
    ]

    def heard(place: int, message: str) -> None:
        job.progress(f"{tasks[place].structure.name}, {tasks[place].quantity}: {message}", None)

    answers = job.executor.compute(face_value, tasks, heard)
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


def _tasks(config: Config, structure: Standing, side: int, part: FacePart, fem: FemAnswer) -> list[FaceTask]:
    from fem.continuum.loads import sign_of

    critical = safety = None
    mechanism, full = fem.last_in_equilibrium(), fem.flow == "associated"
    if full and fem.has_kc and mechanism is not None and sign_of(config.section, fem.direction) == side:
        critical = ElementValue(fem.kc, None if fem.davis is None else fem.davis.kc, mechanism.slip_surface)
    for factor in fem.safety_factors if full else ():
        if factor.kh == 0.0 and factor.slip_surface:
            safety = ElementValue(factor.factor, factor.davis, factor.slip_surface)
    circle = part.critical.surface_m if part.critical is not None else ()
    at_rest = next((c.surface_m for group in part.factors if group.kh == 0.0 for c in group.circles), ())
    return [
        FaceTask(config, structure, side, "critical Kh", critical, circle),
        FaceTask(config, structure, side, "factor of safety", safety, at_rest or circle),
    ]


def face_value(task: FaceTask, tell: Tell) -> FaceValue | str:
    """The quantity of a face, with as many strong zones as necessary; or why there is none."""
    zones: tuple[StrongZone, ...] = ()
    result = task.first
    try:
        for attempt in range(ATTEMPTS + 1):
            if result is None:
                tell("finite elements" + (", with strong zones elsewhere" if zones else ""))
                result = _computed(task, zones)
            if is_of_face(task.structure, task.side, result.surface) or attempt == ATTEMPTS:
                break
            more = zones_against(
                task.config.section, task.structure, task.side, result.surface, task.circle, zones,
                task.config.fem.least_depth,
            )  # fmt: skip
            if more is None:
                break
            zones, result = more, None
    except (InputError, NoAnswerError) as error:
        return str(error)
    assert result is not None
    tell("strict bounds")
    low, high = _bounded(task, zones)
    return FaceValue(
        value=result.value,
        davis=result.davis,
        lower=low,
        upper=high,
        slip_surface=tuple((float(x), float(z)) for x, z in result.surface),
        held=tuple(StrongZonePart.model_validate(each) for each in zones),
        reaches_crest=is_of_face(task.structure, task.side, result.surface),
    )


def _direction(task: FaceTask) -> Direction:
    from fem.continuum.loads import sign_of

    return "downhill" if sign_of(task.config.section, "downhill") == task.side else "uphill"


def _computed(task: FaceTask, zones: tuple[StrongZone, ...]) -> ElementValue:
    """The quantity by finite elements; raises InputError, NoAnswerError."""
    search = _search(task, zones)
    limit = search.critical(_direction(task)) if task.quantity == "critical Kh" else search.safety()
    return ElementValue(limit.value, limit.davis, line(limit.surface))


def _bounded(task: FaceTask, zones: tuple[StrongZone, ...]) -> tuple[float | None, float | None]:
    """Strict bounds with ψ = φ in ground with strong zones; those of the section are of faces that fail first."""
    from fem.limit.bounds import kh_bounds
    from fem.limit.safety_bounds import safety_bounds

    config = task.config
    if not zones or not config.faces.bounds or config.bounds.run is False:
        return None, None
    share = config.bounds.changed(seconds=BOUNDS_SHARE * config.bounds.seconds)
    ground, full = _ground(task, zones), config.fem.changed(direction=_direction(task), flow="associated")
    try:
        if task.quantity == "critical Kh":
            of_kh = kh_bounds(ground, full, share)
            return (of_kh.lower if of_kh.stress else None), (of_kh.upper if of_kh.mechanism else None)
        if config.bounds.safety_factor:
            of_factor = safety_bounds(ground, full, share.of_factors, 0.0, smooth_sides=True)
            return of_factor.lower or None, (of_factor.upper if math.isfinite(of_factor.upper) else None)
    except NoAnswerError:
        pass
    return None, None


def _ground(task: FaceTask, zones: tuple[StrongZone, ...]) -> "Section":
    from fem.search.strong_zones import with_strong_zones

    return with_strong_zones(task.config.section, zones) if zones else task.config.section


def _search(task: FaceTask, zones: tuple[StrongZone, ...]) -> "FaceSearch":
    from mpi4py import MPI

    from fem.search.face_limits import FaceSearch

    return FaceSearch(_ground(task, zones), task.config.mesh, task.config.fem, MPI.COMM_SELF)


def unwanted(config: Config) -> str:
    """Why the faces are not computed; empty where they are."""
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
    what="every face of structures by finite elements and bounds",
    work=work,
    needs=("fem", "slices"),
    reads=("mesh", "fem", "bounds", "faces"),
    ignores=lambda config: (
        *WITHOUT_EFFECT, "fem.kh", "fem.rigid_box", "fem.direction", "faces.run", "criteria.factor_of_safety",
        "bounds.davis",
    ),
    results=(FacesAnswer.FILE,),
    read=FacesAnswer.read,
    unwanted=unwanted,
)  # fmt: skip
