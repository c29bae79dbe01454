"""States the numerical error of the critical Kh in words."""

import math

from workflow.report.numbers import between
from workflow.results.accuracy import Accuracy

LEAST = 0.001  # numerical errors are told as no less


def rounded_up(value: float) -> float:
    """Return a positive number rounded up to one digit: 0.0043 becomes 0.005."""
    value = max(value, LEAST)
    power = 10.0 ** math.floor(math.log10(value) + 1e-9)
    return float(f"{math.ceil(value / power - 1e-6) * power:.3g}")


def numerical_error(estimate: Accuracy | None, kc: float) -> str:
    """Return the numerical error of ``kc`` in a sentence."""
    if estimate is None:
        return (
            "The numerical error of the critical Kh is not known, since there is one mesh and no strict bound of the "
            'same flow rule; variants.which = ["mesh"] computes it.'
        )
    error = f"{rounded_up(estimate.error(kc)):g}"
    if not estimate.sure:
        return (
            f"The sequence of meshes has not converged: the numerical error may be {error}, with the critical Kh "
            f"anywhere from {between([estimate.low, estimate.high])}."
        )
    return f"The numerical error of the critical Kh is below {error}, {estimate.by}."
