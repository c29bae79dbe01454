"""Stores strict bounds of the critical seismic coefficient by limit analysis in fem/bounds.json."""

from typing import ClassVar, Literal

from pydantic import Field

from fem.continuum.loads import Direction
from fem.settings import BoundsSettings, Sides
from workflow.results.answer import FORCE, Answer, Part, SectionLabel, way_out

LEAST_NUMBER = -1.0  # Kh at or below which an upper bound is no number of an engineer
BoundsVerdict = Literal["bracketed", "wide", "no bracket", "unstable"]


class StressResiduals(Part):
    """Holds the residuals of the lower bound: imbalance of the stress, and its distance to the yield surface."""

    imbalance: float = Field(
        description="largest unbalanced body force of a cell times the size of the cell, over the largest stress"
    )
    traction_jump: float = Field(description="largest jump of the traction across an edge, over the largest stress")
    yield_slack: float = Field(
        description="smallest distance of the stress at a corner to the yield surface, negative beyond the surface"
    )


class VelocityResiduals(Part):
    """Holds the residuals of the upper bound: how far the velocities violate flow rule and boundary conditions."""

    multiplier: float = Field(description="the upper bound, computed from the velocities alone")
    flow_slack: float = Field(
        description="smallest excess of the volumetric strain rate over the rate of the flow rule, where φ > 0"
    )
    volume: float = Field(description="largest volumetric strain rate where φ = 0, over the largest strain rate")
    boundary: float = Field(description="largest velocity of a fixed component, over the largest velocity")
    jump: float = Field(
        description="largest difference of the velocities of two cells at a common node, over the largest velocity"
    )


class Residuals(Part):
    """Holds the residuals of both bounds, None if a bound is missing."""

    lower: StressResiduals | None = Field(description="residuals of the stress field")
    upper: VelocityResiduals | None = Field(description="residuals of the velocity field")


class BoundsRound(Part):
    """Holds the bounds on one mesh of a sequence, in which each mesh is finer than the one before."""

    cells: int = Field(description="number of triangles of the mesh")
    lower: float | None = Field(description="lower bound on this mesh; null if it is missing")
    upper: float | None = Field(description="upper bound on this mesh; null if it is missing")
    notes: tuple[str, ...] = Field(description="reasons why a bound is missing, or did not pass its check")
    work: float = Field(
        description="computing work on this mesh, from the number of iterations, in seconds of a reference machine"
    )
    fallback: tuple[Literal["lower", "upper"], ...] = Field(
        default=(), description="bounds found by Clarabel because the built-in solver broke down"
    )


class DirectionPart(Part):
    """Holds the bounds of Kh in one direction of the seismic force."""

    direction: Direction = Field(description="direction of the seismic force, by the ends of the surface")
    towards: Literal["left", "right"] = Field(description="side of the section towards which the seismic force acts")
    lower: float | None = Field(description="lower bound of Kh in this direction; null if it is missing")
    upper: float | None = Field(description="upper bound of Kh in this direction; null if it is missing")
    leaves: tuple[Literal["left", "right"], ...] = Field(
        description="sides of the section, left or right, that the failing ground reaches"
    )
    history: tuple[BoundsRound, ...] = Field(description="bounds on every mesh")

    @property
    def description(self) -> str:
        """Return the bounds in words. The bounds of the direction that does not fail first need not be close to each
        other."""
        to, out = f"{FORCE[self.direction]} (to the {self.towards})", way_out(self.leaves)
        match self.lower, self.upper:
            case None, None:
                return f"{to} no bound was found{out}"
            case None, float() as upper:
                return f"{to} the section fails at {upper:.4f} at the latest{out}"
            case float() as lower, None:
                return f"{to} the section stands up to {lower:.4f} at least{out}"
            case lower, upper:
                return f"{to} the critical Kh is {lower:.4f} to {upper:.4f}{out}"


class BracketPart(Part):
    """Holds both bounds for one flow rule, with their residuals and the bounds on every mesh."""

    lower: float | None = Field(description="lower bound: the section stands at every smaller Kh, in every direction")
    upper: float | None = Field(description="upper bound: the section fails at every larger Kh, in one direction")
    direction: Direction = Field(description="direction of the seismic force with the smallest bounds")
    directions: tuple[DirectionPart, ...] = Field(
        description="bounds of every requested direction; the direction that fails first is the first"
    )
    gap: float | None = Field(description="gap of the bounds, (upper - lower) over their mean")
    verdict: BoundsVerdict = Field(
        description=(
            '"bracketed"; "wide": the gap is larger than required; "no bracket": a bound is missing; "unstable": the '
            "section fails without a seismic force"
        )
    )
    reason: str = Field(description="reason of the verdict, in words")
    description: str = Field(description="the bounds in words")
    cells: int = Field(description="number of triangles of the last mesh")
    residuals: Residuals = Field(description="how exactly both bounds fulfil the conditions of limit analysis")
    history: tuple[BoundsRound, ...] = Field(description="bounds on every mesh, for the direction that fails first")

    def towards(self, direction: Direction) -> DirectionPart | None:
        """Return the bounds in one direction; None if there are none."""
        return next((part for part in self.directions if part.direction == direction), None)


class ShallowBoundPart(Part):
    """Holds a cohesionless face that fails at a smaller Kh than the whole slope."""

    stratum: str = Field(description="stratum of the face")
    start: float = Field(description="x of the left end of the face (m)")
    end: float = Field(description="x of the right end of the face (m)")
    kh: float = Field(description="critical Kh of the shallow failure of the face")

    def is_edge(self, least_depth: float) -> bool:
        """Return whether the face is only the edge of an outcropping layer, narrower than the least depth (m) of
        failures."""
        return self.end - self.start < least_depth


class SafetyPart(Part):
    """Holds the strict bounds of the factor of safety at one Kh, ψ = φ."""

    kh: float = Field(description="seismic coefficient at which the factor of safety is bounded")
    lower: float | None = Field(description="lower bound: the section stands if its strength is divided by this factor")
    upper: float | None = Field(description="upper bound: the section fails if its strength is divided by this factor")
    cells: int = Field(description="number of triangles of the last mesh")
    shallow_failure: float | None = Field(
        default=None,
        description=(
            "factor at which a cohesionless face, or shallow ground where two faces meet, fails at the "
            "latest; the bounds are those of the whole slope"
        ),
    )
    direction: Direction | None = Field(default=None, description="direction of the seismic force at failure")
    after_shaking: bool = Field(
        default=False, description="whether the excess pore pressure of shaking acts, though Kh is 0"
    )
    reason: str = Field(default="", description="reason why the gap of the bounds is larger than required")
    work: float = Field(
        default=0.0, description="computing work, from the number of iterations, in seconds of a reference machine"
    )

    @property
    def description(self) -> str:
        """Return the bracket in words."""
        return self.bracket_words + self._shallow_words

    @property
    def bracket_words(self) -> str:
        """Return the bracket in words, without the failure of shallow ground."""
        low = "" if self.lower is None else f"{self.lower:.3f} <= "
        high = "" if self.upper is None else f" <= {self.upper:.3f}"
        between = f"{low}FS{high}" if low or high else "none found of FS"
        force = f", force {FORCE[self.direction]}" if self.direction else ""
        after = " after shaking, with its excess pore pressure" if self.after_shaking else ""
        return f"{between} at Kh = {self.kh:g}{after}{force}, {self.cells} triangles"

    @property
    def _shallow_words(self) -> str:
        """Return what is known of shallow ground in words. Where it is not proven to fail before the slope as a whole,
        its factor is the upper bound."""
        at, ground = self.shallow_failure, "shallow ground, of one face or where two meet,"
        if at is None:
            return ""
        if self.upper is not None and at >= self.upper:
            return f"; {ground} may fail before: no bound close to these was found for it"
        return f"; {ground} fails before, at {at:.3f} at most"


class BoundsAnswer(BracketPart, Answer):
    """Holds the bounds of Kh with ψ = φ and the bounds of factors of safety.

    The upper bound of Kh also holds for every smaller ψ (Radenkovic 1961).
    """

    FILE: ClassVar[str] = "fem/bounds.json"

    section: SectionLabel = Field(description="section to which the bounds belong")
    flow: str = Field(description="flow rule of the bounds, in words")
    substitute: BracketPart | None = Field(description="bounds with Davis's reduced strength, if ψ < φ")
    safety: tuple[SafetyPart, ...] = Field(
        default=(), description="bounds of the factors of safety, if they were requested"
    )
    after_shaking: SafetyPart | None = Field(
        default=None,
        description="bounds of the factor of safety at Kh = 0 with the excess pore pressure of shaking, if any",
    )
    shallow_failures: tuple[ShallowBoundPart, ...] = Field(
        description="cohesionless faces that fail first; the bounds are those of the whole slope"
    )
    shallow: float | None = Field(
        default=None,
        description="Kh at which ground above the least depth slips at the latest, where two cohesionless faces meet",
    )
    load_ends: tuple[float, ...] = Field(
        default=(), description="x of ends of loads on bare sand (m), at which the ground was given a cohesion"
    )
    water_exits: tuple[float, ...] = Field(
        default=(), description="x where water comes out of bare sand (m), at which the ground was given a cohesion"
    )
    least_depth: float = Field(
        description=(
            "depth (m) up to which failures of cohesionless faces, at ends of loads and where water comes out of bare "
            "sand are disregarded"
        )
    )
    sides: Sides = Field(description="boundary condition of the sides")
    vertical: float = Field(description="vertical seismic coefficient, positive upwards")
    seconds: float = Field(description="computing time (s)")
    settings: BoundsSettings = Field(description="settings of the search, the table [bounds]")

    @property
    def fails_at_rest(self) -> bool:
        """Return whether a mechanism proves that the section fails without a seismic force."""
        return self.upper is not None and self.upper < 0.0

    @property
    def upper_number(self) -> float | None:
        """Return the upper bound of Kh if it is a number of an engineer. Where no horizontal force could stabilise the
        section, the search ends at a Kh far below -1, which is none."""
        return None if self.upper is None or self.upper <= LEAST_NUMBER else self.upper

    @property
    def fails_with_smooth_sides(self) -> bool:
        """Return whether a mechanism that proves failure without a seismic force is also one between sides held
        horizontally: at free-field sides it must not move through a side."""
        if not self.fails_at_rest:
            return False
        failing = [part for part in self.directions if part.upper is not None and part.upper < 0.0]
        return self.sides != "free-field" or any(not part.leaves for part in failing)

    @property
    def has_interval(self) -> bool:
        """Return whether there are both bounds of any quantity: of a critical Kh, with the seismic force in one
        direction at least, or of a factor of safety."""
        substitute = self.substitute.directions if self.substitute is not None else ()
        ends = [(self.lower, self.upper)]
        ends += [(part.lower, part.upper) for part in (*self.directions, *substitute)]
        ends += [(part.lower, part.upper) for part in self.factors]
        return any(lower is not None and upper is not None for lower, upper in ends)

    @property
    def factors(self) -> tuple[SafetyPart, ...]:
        """Return the bounds of all factors of safety, the one after shaking last."""
        return (*self.safety, *(() if self.after_shaking is None else (self.after_shaking,)))

    @property
    def strengthened_faces(self) -> bool:
        """Return whether the bounds are of ground whose bare faces were given a cohesion."""
        return bool(self.shallow_failures) or self.shallow is not None

    @property
    def strengthened(self) -> bool:
        """Return whether the bounds are of ground in which bare faces, the ends of loads, or the points where water
        comes out of bare sand, were given a cohesion."""
        return self.strengthened_faces or bool(self.load_ends or self.water_exits)
