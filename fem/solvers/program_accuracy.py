"""Defines how exactly the cone programs of bounds and of finite elements are solved."""

from dataclasses import dataclass

import numpy as np

from fem.settings import LEAST_KH
from fem.solvers.convergence import STALLED_RESIDUAL, Tolerance

# Residual of the equations of Clarabel: at 1e-8 what corrects it led out of the yield surface by more than the margin;
# and where a cut-off leaves a bare surface no room for a margin.
FEASIBILITY, FEASIBILITY_AT_CUT_OFF = 1e-9, 1e-11
# Regularisation of Clarabel's pivots, for mechanisms the solver's own first. Where ground next to rock has hardly any
# strength, it is open which of many mechanisms forms, factorisations break down, and more regularisation helps;
# iterative refinement takes it out of the answer. For stress fields 1e-8 is too little from the start: of 180 programs
# of benches with seams, random slopes and layers of clay a quarter ended in "NumericalError" or met their tolerances
# only almost, with 1e-7 none, in as many iterations.
REGULARISATIONS, REGULARISATIONS_OF_STRESS = (1e-8, 1e-7, 1e-6), (1e-7, 1e-6)
# The same for elements, whose answer is no bound: at 1e-8 they often break down, and a residual of 1e-7 is met in three
# quarters of the iterations and changes the answer by 0.03 % at most, as a rule (0.1 % in 1 of 10 published cases).
REGULARISATIONS_OF_ELEMENTS, FEASIBILITY_OF_ELEMENTS, STALLED_RESIDUAL_OF_ELEMENTS = (1e-7, 1e-6), 1e-7, 3e-7
# Relative gaps of the built-in interior-point method. The middle of the bracket of elements is off by less than half of
# their gap, which is a tenth of the accuracy that is asked for of the discretisation.
INTERIOR_GAP, INTERIOR_GAP_OF_ELEMENTS = 3e-4, 1e-3
# No stress balances the dead load where velocities prove that the multiplier is below this number: a Kh below -1 has no
# meaning, and a share of loads is positive.
LEAST_MULTIPLIER = -10.0


@dataclass(frozen=True)
class ProgramAccuracy:
    """Holds how exactly a program is solved.

    Attributes
    ----------
    tolerance : criteria of the built-in interior-point method
    regularisations : of Clarabel, which is called again with the next one if it ends without an answer, or almost meets
        its tolerances but with large residuals
    feasibility, feasibility_at_cut_off : residual of the equations of Clarabel, and the same with tension cut-offs
    in_the_middle : whether the multiplier is the mean of the bracket of the solver
    """

    tolerance: Tolerance
    regularisations: tuple[float, ...]
    feasibility: float
    feasibility_at_cut_off: float
    in_the_middle: bool = False


def accuracy_of_bounds(
    regularisations: tuple[float, ...] = REGULARISATIONS, stalled_residual: float = STALLED_RESIDUAL
) -> ProgramAccuracy:
    """Return the accuracy of a bound.

    Parameters
    ----------
    regularisations : regularisations of Clarabel's pivots, which are tried in this order (-)
    stalled_residual : residual of the equations that is accepted where iterations no longer reduce it (-)

    Returns
    -------
    Criteria of both solvers; the width of the bracket is a share of the multiplier, or of 0.2 if the multiplier is
    smaller.
    """
    tolerance = Tolerance(INTERIOR_GAP, LEAST_KH, stalled_residual=stalled_residual, floor=LEAST_MULTIPLIER)
    return ProgramAccuracy(tolerance, regularisations, FEASIBILITY, FEASIBILITY_AT_CUT_OFF)


def accuracy_of_elements(least: float = 1.0, floor: float = -np.inf) -> ProgramAccuracy:
    """Return the accuracy of a finite element limit analysis, which is less than that of a bound.

    Parameters
    ----------
    least : multiplier below which the width of the bracket is a share of this number instead of the multiplier (-)
    floor : multiplier below which the built-in method ends, since no stress balances the dead load (-)

    Returns
    -------
    Criteria of both solvers; the multiplier is the middle of the bracket.
    """
    feasibility = FEASIBILITY_OF_ELEMENTS
    tolerance = Tolerance(INTERIOR_GAP_OF_ELEMENTS, least, feasibility, STALLED_RESIDUAL_OF_ELEMENTS, floor)
    return ProgramAccuracy(tolerance, REGULARISATIONS_OF_ELEMENTS, feasibility, feasibility, in_the_middle=True)


BOUNDS = accuracy_of_bounds()
