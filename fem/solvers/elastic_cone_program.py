"""Solves the second-order cone program of one elastoplastic step by Clarabel in quadratic form.

Stresses S at corners k, [xx, yy, xy], each times a weight w, and a multiplier λ solve

    min ½ (S - S0)·C (S - S0) - d λ  such that  Gᵀ S = b0 + λ b1,  |((Sxx - Syy)/2, Sxy)| <= w k + sin ψ P,

with P = -(Sxx + Syy)/2, the compliance C, the stress S0 before the step and the displacement d in the direction of b1
(Krabbenhoft, Lyamin, Sloan & Wriggers 2007, Int. J. Numer. Meth. Engng 69, 592). Strengths w k may change from solution
to solution, all other data are set once.
"""

from functools import partial

import clarabel
import numpy as np
from scipy import sparse

from fem.solvers.cone_program import CONVERGED_STATUSES, COST_EXPONENT, COST_NONZEROS, COST_SECONDS
from meshes.executor import interruptible

# Tolerances of gap and equations: the pressures that follow from the stress are compared to 0.2 %.
TOLERANCE = 1e-6
REGULARISATION = 1e-7


class ElasticConeProgram:
    """Solves the cone program of one elastoplastic step; all quantities are dimensionless.

    Attributes
    ----------
    work : float
        Computing work of all solutions so far, in seconds on the reference machine of ``cone_program``.
    """

    def __init__(
        self,
        strain: sparse.csr_matrix,
        compliance: np.ndarray,
        sine: np.ndarray,
        loads: tuple[np.ndarray, np.ndarray],
        before: np.ndarray,
        displacement: float,
    ) -> None:
        """Set up the program from the strain rates ``strain`` (3 k, n), the ``compliance`` (k, 3, 3), the ``sine`` of ψ
        (k,), the ``loads`` b0 and b1 (n,), the stress S0 (k, 3) ``before`` the step, and the ``displacement`` d. If d
        is 0 the load is b0 alone.
        """
        corners = len(sine)
        self._corners, self._dead, self.work = corners, loads[0], 0.0
        # The multiplier is the last unknown. The sum is divided by d, so that λ has the coefficient of one.
        scale = 1.0 / displacement if displacement > 0.0 else 1.0
        blocks = sparse.block_diag(list(scale * compliance), format="csc")
        quadratic = sparse.triu(sparse.block_diag([blocks, sparse.csc_matrix((1, 1))]), format="csc")
        linear = np.append(-(blocks @ before.ravel()), -1.0 if displacement > 0.0 else 0.0)
        live = -loads[1] if displacement > 0.0 else np.zeros_like(loads[1])
        balance = sparse.hstack([strain.T, sparse.csr_matrix(live[:, None])])
        fixed = sparse.csr_matrix(([1.0], ([0], [3 * corners])), shape=(1, 3 * corners + 1))
        rows = [balance, self._cones(sine)] if displacement > 0.0 else [balance, fixed, self._cones(sine)]
        self._equations = len(loads[0]) + (0 if displacement > 0.0 else 1)
        cones = [clarabel.ZeroConeT(self._equations), *[clarabel.SecondOrderConeT(3)] * corners]
        settings = clarabel.DefaultSettings()
        settings.verbose, settings.presolve_enable = False, False
        settings.static_regularization_constant = REGULARISATION
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
        settings.direct_solve_method = "qdldl"
        offset = self._offset(np.ones(corners))
        self._solver = clarabel.DefaultSolver(quadratic, linear, sparse.vstack(rows).tocsc(), offset, cones, settings)
        nonzeros = self._solver.get_info().linsolver.nnzL
        self._cost = COST_SECONDS * (nonzeros / COST_NONZEROS) ** COST_EXPONENT

    def solve(self, strength: np.ndarray) -> tuple[float, np.ndarray] | None:
        """Return the multiplier and the stress (k, 3) for the ``strength`` w k (k,); None if the solver ends without an
        answer."""
        self._solver.update(b=self._offset(strength))
        end = interruptible(partial(self._solver.solve))
        self.work += self._cost * end.iterations
        if str(end.status) not in CONVERGED_STATUSES:
            return None
        x = np.asarray(end.x)
        return float(x[-1]), x[:-1].reshape(self._corners, 3)

    def _offset(self, strength: np.ndarray) -> np.ndarray:
        offset = np.zeros((self._corners, 3))
        offset[:, 0] = strength
        return np.concatenate([self._dead, np.zeros(self._equations - len(self._dead)), offset.ravel()])

    def _cones(self, sine: np.ndarray) -> sparse.csr_matrix:
        """Return the rows of the yield conditions on the unknowns."""
        first = 3 * np.arange(self._corners)
        half = np.full(self._corners, 0.5)
        rows = np.concatenate([first, first, first + 1, first + 1, first + 2])
        columns = np.concatenate([first, first + 1, first, first + 1, first + 2])
        values = np.concatenate([0.5 * sine, 0.5 * sine, -half, half, -2.0 * half])
        return sparse.csr_matrix((values, (rows, columns)), shape=(3 * self._corners, 3 * self._corners + 1))
