"""Gives reasons not to trust an answer, and checks that compare the answer with other numbers."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

# Relative differences that cause a warning: of two numbers in the wrong order, and of two computations of one number.
ORDER_TOLERANCE, REPEAT_TOLERANCE = 0.005, 0.03
# Difference by which the answer of finite elements may exceed a strict upper bound, which is their discretisation
# error: as a share, and of Kh where Kh is small.
BOUND_TOLERANCE, KH_TOLERANCE = 0.005, 0.002


# Bound of Kh below which a difference from the bound is stated in Kh: as a share of nearly nothing it says nothing.
SMALL_KH = 0.02


def difference_words(value: float, bound: float) -> str:
    """Return how far a critical Kh or a factor of safety lies from a bound.

    Parameters
    ----------
    value : critical Kh, or factor of safety (-)
    bound : the bound (-)

    Returns
    -------
    The difference as a percentage of the bound, or in Kh if the bound is small.
    """
    difference = abs(value - bound)
    return f"{difference:.3f}" if bound < SMALL_KH else f"{100.0 * difference / bound:.1f} %"


@dataclass(frozen=True)
class ResultWarning:
    """Holds a reason not to trust an answer.

    Attributes
    ----------
    observation : what was observed, a sentence with its numbers
    remedy : advice on what the user can change
    contradiction : whether the observation contradicts the answer; if not, it is a note
    """

    observation: str
    remedy: str
    contradiction: bool = True


@dataclass(frozen=True)
class ComparedKh:
    """Holds a critical Kh that was computed in another way, for comparison.

    Attributes
    ----------
    change : the change that was made, such as "cells of half the size"
    kc : critical Kh (-)
    decisive : whether a difference contradicts the answer, as a difference on a finer mesh does and one with a poorer
        element does not
    kc_without : critical Kh without the change, if the critical Kh with and without the change were computed on another
        mesh than the answer; None if the answer is the critical Kh without the change
    """

    change: str
    kc: float
    decisive: bool = True
    kc_without: float | None = None


def of_bounds(
    kc: float,
    lower: float | None,
    upper: float | None,
    same_flow: bool,
    quantity: str = "critical Kh",
    mesh_error: float = 0.0,
) -> Iterator[ResultWarning]:
    """Compare a critical Kh or a factor of safety with strict bounds.

    If the value has a smaller ψ than the bounds, only the upper bound is used: ground that dilates less does not resist
    more.

    Parameters
    ----------
    kc : the value that is checked (-)
    lower, upper : the bounds (-); None if there is none
    same_flow : whether the bounds have the flow rule of the value, and not ψ = φ
    quantity : name of the value in the warnings
    mesh_error : error of the value by the sequence of its meshes, by which it may be too large (-)

    Yields
    ------
    Warnings. A difference within `REPEAT_TOLERANCE`, or above the upper bound within ``mesh_error``, is a note; a
    larger one is a contradiction.
    """
    whose = "" if same_flow else " with ψ = φ, which no smaller ψ can exceed"
    if upper is not None and kc > upper + max(BOUND_TOLERANCE * upper, KH_TOLERANCE):
        yield ResultWarning(
            f"The {quantity} of {kc:.3f} lies {difference_words(kc, upper)} above the strict upper bound{whose}, "
            f"{upper:.3f}.",
            f"take {upper:.3f} as an upper limit and refine the mesh",
            contradiction=kc > upper + max(REPEAT_TOLERANCE * upper, KH_TOLERANCE, mesh_error),
        )
    if same_flow and lower is not None and kc < lower - max(ORDER_TOLERANCE * lower, KH_TOLERANCE):
        yield ResultWarning(
            f"The {quantity} of {kc:.3f} lies below the strict lower bound, {lower:.3f}.",
            f"take {lower:.3f} as a lower limit and refine the mesh",
            contradiction=kc < lower - max(REPEAT_TOLERANCE * lower, KH_TOLERANCE),
        )


def of_others(kc: float, others: Iterable[ComparedKh]) -> Iterator[ResultWarning]:
    """Compare a critical Kh with those by another mesh or element.

    Parameters
    ----------
    kc : the critical Kh that is checked (-)
    others : the other critical Kh

    Yields
    ------
    Warnings of differences of more than 3 % that are also more than 0.002.
    """
    for other in others:
        without = other.kc_without or kc
        change = other.kc / without - 1.0
        if abs(change) > REPEAT_TOLERANCE and abs(other.kc - without) > KH_TOLERANCE:
            yield ResultWarning(
                f"With {other.change} the critical Kh is {other.kc:.3f} instead of {without:.3f}, "
                f"{100.0 * change:+.0f} %.",
                "refine the mesh until the difference vanishes, or run the bounds",
                contradiction=other.decisive,
            )


def contradict_answer(warnings: Iterable[ResultWarning]) -> bool:
    """Return whether any of the warnings contradicts the answer.

    Parameters
    ----------
    warnings : warnings of an answer

    Returns
    -------
    False if all of them are notes, or if there are none.
    """
    return any(warning.contradiction for warning in warnings)
