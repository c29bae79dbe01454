"""Stages to try the pipeline on."""

import pytest

from tests.support.toy_stages import Toys, stage


@pytest.fixture
def toys() -> Toys:
    """Three stages in a row, and one that tells of all."""
    made = (
        stage("mesh", reads=("mesh",)),
        stage("fem", needs=("mesh",), reads=("fem",)),
        stage("slide", needs=("fem",), leftovers=("dem/*",), partial=lambda job: job.cases is not None),
        stage("report", needs=("mesh", "fem", "slide"), reads=("figures",), of_all=True),
    )
    return Toys({each.name: each for each in made})
