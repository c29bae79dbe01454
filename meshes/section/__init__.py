"""The ground as a person describes it: strata between lines, quantities with units, water."""
