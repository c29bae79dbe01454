"""States in the estimates of lateral spreads whether they apply to ground that flows after liquefaction."""

from collections.abc import Iterable, Sequence

from workflow.estimates.estimate import Estimate, EstimateKind

SPREADS: tuple[EstimateKind, ...] = ("spread", "regression", "regression as printed")


def with_flow_failure(estimates: Iterable[Estimate], factors: Sequence[float]) -> list[Estimate]:
    """Return the estimates, with an additional sentence in those of lateral spreads if the liquefied ground does not
    stand without shaking.

    The data of lateral spreads are of ground that stands once shaking ends: it moves in each half cycle of the shaking,
    up to its strain potential. Ground with a factor of safety below 1 moves by its weight until it is as flat as its
    residual strength allows. No relation for lateral spreads has ground that flows in its data (Youd, Hansen & Bartlett
    2002 exclude flow failures; Idriss & Boulanger 2008, section 4.4).

    Parameters
    ----------
    estimates : iterable of Estimate
        Estimates of all methods.
    factors : sequence of float
        Factors of safety without shaking of the cases of liquefied ground that flow; empty if none flows.

    Returns
    -------
    list of Estimate
    """
    rows = list(estimates)
    if not factors:
        return rows
    low, high = f"{min(factors):.2f}", f"{max(factors):.2f}"
    factor = low if low == high else f"{low} to {high}"
    words = (
        f"does not apply: the liquefied ground does not stand without shaking (factor of safety {factor}), so that it "
        "flows until it is flat enough, and lateral spreads move only while the ground shakes"
    )
    return [
        row.with_words(f"{row.words}; {words}") if row.kind in SPREADS and row.displacement_m is not None else row
        for row in rows
    ]
