"""Defines the stage `faces`: critical Kh and factor of safety of every face of the structures by finite elements and
bounds."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from fem.settings import WITHOUT_EFFECT
from workflow.config import Config
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import CrestedStructure, structures_of
from workflow.results.answer import SectionLabel
from workflow.results.continuum import FemAnswer
from workflow.results.faces import FaceAtRest, FacesAnswer, FaceStrength, FaceValue
from workflow.results.finished_parts import FinishedParts
from workflow.results.slices import FacePart, SlicesAnswer
from workflow.run.stage import Job, Stage
from workflow.stages.face_values import FaceTask, Quantity, face_value, faces_at_rest, unchanged_value, unwanted

if TYPE_CHECKING:
    from fem.search.face_limits import FaceLimit

SIDES: tuple[tuple[Literal["left", "right"], int], ...] = (("left", LEFT), ("right", RIGHT))


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
    FacesAnswer(
        section=SectionLabel.of(config.section), faces=tuple(faces), after_shaking=_after_shaking(job, slices)
    ).write(job.store)
    values_of_faces.remove()


def _after_shaking(job: Job, slices: SlicesAnswer) -> tuple[FaceAtRest, ...]:
    """Return the factors of safety of the faces in ground with the excess pore pressure of shaking."""
    if slices.after_shaking is None:
        return ()
    job.progress("factor of safety after shaking", None)
    return faces_at_rest(job.config.section.after_shaking(), job.config, slices.after_shaking)


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


STAGE = Stage(
    name="faces",
    description="every face of structures by finite elements and bounds",
    work=work,
    needs=("fem", "slices"),
    reads=("mesh", "fem", "bounds", "faces"),
    ignores=lambda config: (
        *WITHOUT_EFFECT, "fem.kh", "fem.rigid_box", "fem.direction", "faces.run", "bounds.davis",
        "criteria.factor_of_safety",
    ),
    results=(FacesAnswer.FILE,),
    read=FacesAnswer.read,
    leftovers=("fem/faces_part*.json",),
    unwanted=unwanted,
)  # fmt: skip
