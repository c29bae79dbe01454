"""Collects displacements by other methods for the report."""

from workflow.estimates.comparison import estimates
from workflow.estimates.estimate import Estimate
from workflow.estimates.flow_failure import with_flow_failure
from workflow.results.results import Results


def reported_estimates(results: Results) -> list[Estimate]:
    """Return all estimates of displacement; estimates of lateral spreads state whether they apply to ground that
    flows."""
    config = results.config
    cases = results.liquefied.cases if results.liquefied is not None else ()
    factors = [case.factor for case in cases if case.stands == "flows" and case.factor is not None]
    return with_flow_failure(estimates(config.section, config, results.kc, results.slip_surface), factors)
