"""fem/bounds.json: strict bounds of the critical seismic coefficient by limit analysis."""

from typing import ClassVar, Literal

from pydantic import Field

from fem.continuum.loads import Direction
from fem.settings import BoundsSettings, Sides
from workflow.results.answer import FORCE, Answer, Part, SectionLabel

BoundsVerdict = Literal["bracketed", "wide", "no bracket", "unstable"]


class StressResiduals(Part):
    """Holds the residuals of the lower bound: imbalance of the stress, and its distance to the yield surface."""

    imbalance: float = Field(description="largest body force left over in a cell times its size, over the stress")
    traction_jump: float = Field(description="largest difference of traction across an edge, over the stress")
    yield_slack: float = Field(description="smallest distance of a corner to the yield surface, negative past it")


class VelocityResiduals(Part):
    """Holds the residuals of the upper bound: how far the velocities violate flow rule and boundary conditions."""

    multiplier: float = Field(description="the bound, computed from the velocities alone")
    flow_slack: float = Field(description="smallest volume rate beyond what the flow rule asks for, where φ > 0")
    volume: float = Field(description="largest volume rate where φ = 0, over the strain rate")
    boundary: float = Field(description="largest velocity of a component that is held, over the largest velocity")
    jump: float = Field(description="largest difference of velocity at a common node, over the largest velocity")


class Residuals(Part):
    """Holds the residuals of both bounds, None if a bound is missing."""

    lower: StressResiduals | None
    upper: VelocityResiduals | None


class BoundsRound(Part):
    """Holds the bounds on one mesh of a sequence, in which each mesh is finer than the one before."""

    cells: int
    lower: float | None
    upper: float | None
    notes: tuple[str, ...]
    work: float = Field(description="counted, in seconds of a reference machine")
    fallback: tuple[Literal["lower", "upper"], ...] = Field(
        default=(), description="bounds found by Clarabel, since the program's own solver broke down"
    )


class DirectionPart(Part):
    """Holds the bounds of Kh in one direction of the seismic force."""

    direction: Direction
    towards: Literal["left", "right"] = Field(description="the side of the section towards which it acts")
    lower: float | None
    upper: float | None
    leaves: tuple[Literal["left", "right"], ...] = Field(
        description="sides, where the section was cut off, at which the ground slides out"
    )
    history: tuple[BoundsRound, ...]

    @property
    def words(self) -> str:
        """Return the bounds in words. If the other direction fails first, the bounds of this direction need not be
        close."""
        to, out = f"{FORCE[self.direction]} (to the {self.towards})", self.way_out
        match self.lower, self.upper:
            case None, None:
                return f"{to} no bound was found{out}"
            case None, float() as upper:
                return f"{to} it fails at {upper:.4f} at the latest{out}"
            case float() as lower, None:
                return f"{to} it stands up to {lower:.4f} at least{out}"
            case lower, upper:
                return f"{to} it is {lower:.4f} to {upper:.4f}{out}"

    @property
    def way_out(self) -> str:
        """Return a clause on the sides at which the ground slides out; empty if there are none."""
        return f", where the ground slides out at the {' and the '.join(self.leaves)} side" if self.leaves else ""


class BracketPart(Part):
    """Holds both bounds for one flow rule, with their residuals and the bounds on every mesh."""

    lower: float | None = Field(description="the section stands at every Kh below this one, in every direction")
    upper: float | None = Field(description="the section fails at every Kh above this one, in one direction")
    direction: Direction = Field(description="direction of the seismic force with the smallest bounds")
    directions: tuple[DirectionPart, ...] = Field(
        description="each direction that was asked for, the one that fails first in front"
    )
    gap: float | None = Field(description="(upper - lower) over their mean")
    verdict: BoundsVerdict
    reason: str
    words: str = Field(description="the bracket as a person reads it")
    cells: int = Field(description="triangles of the last mesh")
    residuals: Residuals
    history: tuple[BoundsRound, ...] = Field(description="of the direction that fails first")

    def towards(self, direction: Direction) -> DirectionPart | None:
        """Return the bounds in one direction; None if there are none."""
        return next((part for part in self.directions if part.direction == direction), None)


class ShallowBoundPart(Part):
    """Holds a cohesionless face that fails at a smaller Kh than the whole slope."""

    stratum: str
    start: float = Field(description="x of its left end (m)")
    end: float = Field(description="x of its right end (m)")
    kh: float = Field(description="seismic coefficient of the shallow failure")

    def is_edge(self, least_depth: float) -> bool:
        """Return whether the face is only the edge of an outcropping layer, narrower than the least depth (m) of
        failures."""
        return self.end - self.start < least_depth


class SafetyPart(Part):
    """Holds the strict bounds of the factor of safety at one Kh, ψ = φ."""

    kh: float
    lower: float | None = Field(description="the section stands with its strength divided by this")
    upper: float | None = Field(description="the section fails with its strength divided by this")
    cells: int = Field(description="triangles of the last mesh")
    shallow_failure: float | None = Field(
        default=None,
        description="factor at which at most a face, or shallow ground where two meet, fails; the bounds are of "
        "the slope as a whole",
    )
    direction: Direction | None = Field(default=None, description="of the seismic force with which it fails")
    reason: str = Field(default="", description="why the bounds are no closer, if less close than asked for")
    work: float = Field(default=0.0, description="counted, in seconds of a reference machine")

    @property
    def words(self) -> str:
        """Return the bracket in words."""
        low = "" if self.lower is None else f"{self.lower:.3f} <= "
        high = "" if self.upper is None else f" <= {self.upper:.3f}"
        between = f"{low}FS{high}" if low or high else "none found of FS"
        at = self.shallow_failure
        rolling = (
            "" if at is None else f"; shallow ground, of one face or where two meet, fails before, at {at:.3f} at most"
        )
        force = f", force {FORCE[self.direction]}" if self.direction else ""
        return f"{between} at Kh = {self.kh:g}{force}, {self.cells} triangles{rolling}"


class BoundsAnswer(BracketPart, Answer):
    """Holds the bounds of Kh with ψ = φ and the bounds of factors of safety. The upper bound of Kh also holds for every
    smaller ψ.
    """

    FILE: ClassVar[str] = "fem/bounds.json"

    section: SectionLabel
    flow: str = Field(description="which flow rule the bounds are for, in words")
    substitute: BracketPart | None = Field(description="bounds with Davis's reduced strength, where ψ < φ")
    safety: tuple[SafetyPart, ...] = Field(default=(), description="factors of safety, where they were asked for")
    shallow_failures: tuple[ShallowBoundPart, ...] = Field(
        description="faces that fail first; the bounds are of the slope as a whole"
    )
    shallow: float | None = Field(
        default=None, description="Kh at which ground above that depth slips at the latest, where two such faces meet"
    )
    load_ends: tuple[float, ...] = Field(
        default=(), description="x of ends of loads on bare sand (m), where the ground was given a cohesion"
    )
    least_depth: float = Field(description="how deep failures of such faces, and at such ends, are left out (m)")
    sides: Sides
    vertical: float = Field(description="vertical seismic coefficient, positive upwards")
    seconds: float = Field(description="computing time")
    settings: BoundsSettings

    @property
    def strengthened_faces(self) -> bool:
        """Return whether the bounds are of ground whose bare faces were given a cohesion."""
        return bool(self.shallow_failures) or self.shallow is not None

    @property
    def strengthened(self) -> bool:
        """Return whether the bounds are of ground in which bare faces, or the ends of loads, were given a cohesion."""
        return self.strengthened_faces or bool(self.load_ends)
