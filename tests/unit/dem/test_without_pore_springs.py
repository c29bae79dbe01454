"""Tests of the kernel that leaves out the law of pore springs."""

import numpy as np
import pytest

from dem.engine.engine import Engine
from dem.engine.packer import law_of
from dem.springs import Law
from tests.support.dem_cases import same, shaking


@pytest.mark.parametrize("energies", [True, False])
@pytest.mark.parametrize("law", ["paper", "soil"])
def test_kernel_without_pore_springs_has_the_same_bits(
    monkeypatch: pytest.MonkeyPatch, law: Law, energies: bool
) -> None:
    """Discs without a pore spring are computed without its law, with the bits of the whole law."""
    runs = []
    for whole in (False, True):
        model = shaking(law)
        model.cut_pore_springs()
        assert not law_of(model).pores
        if whole:
            monkeypatch.setattr("dem.engine.engine.law_of", lambda of: law_of(of)._replace(pores=True))
        Engine(energies=energies, balance=1.0).run(model, steps=400)
        runs.append(model)
    assert np.any(runs[0].shear != 0.0)
    assert runs[0].energy_sums == pytest.approx(runs[1].energy_sums, rel=1e-12)  # whose order of sums is free
    runs[0].energy_sums = runs[1].energy_sums
    runs[0].energy_known = runs[1].energy_known
    assert same(*runs)
