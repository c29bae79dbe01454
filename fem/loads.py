"""Direction of the seismic load, and strength and flow rule of the strata: for finite elements and limit analysis."""

from fem.settings import FemSettings
from meshes.errors import InputError
from meshes.section.section import Section, Stratum


def push(section: Section, settings: FemSettings) -> int:
    """Direction of the horizontal load: +1 to the right, -1 to the left."""
    return downhill(section) * (1 if settings.direction == "downhill" else -1)


def downhill(section: Section) -> int:
    """+1 if the ground falls to the right, -1 if it falls to the left, from one end of its surface to the other."""
    return 1 if section.surface[0][1] >= section.surface[-1][1] else -1


def soils(section: Section, settings: FemSettings) -> tuple[Stratum, ...]:
    """The strata with the flow rule that the settings ask for; raises InputError for one without strength."""
    weak = [
        f'strata {k} "{s.name}": cohesion and friction angle are both 0; expected some strength'
        for k, s in enumerate(section.strata, start=1)
        if s.cohesion == 0.0 and s.friction_angle == 0.0
    ]
    if weak:
        raise InputError(section.name, weak)
    if settings.flow == "associated":
        return tuple(s.model_copy(update={"dilation_angle": s.friction_angle}) for s in section.strata)
    return section.strata
