"""The ground as a discretised continuum: elements, loads, strengths, fields."""
