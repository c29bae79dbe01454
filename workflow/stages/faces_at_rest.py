"""Finds the factors of safety of the faces of structures by finite elements, in ground with another strength or pore
pressure than that of the input."""

from typing import TYPE_CHECKING

from workflow.config import Config
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import structures_of
from workflow.results.faces import FaceAtRest, FaceValue
from workflow.results.slices import CirclesAtRest
from workflow.stages.face_values import FaceTask, face_value, unchanged_value, unwanted

if TYPE_CHECKING:
    from meshes.section.section import Section


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
