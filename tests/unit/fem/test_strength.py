"""Strength reduction and Davis's substitute against their closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fem.continuum.strength import davis_factor, davis_words, flow_of, is_associated, strength_of
from meshes.section.section import Section
from tests.support.fem_problems import soil
from tests.support.sections import layer, slope

ANGLES = st.floats(0.0, math.radians(50.0))


def test_without_dilation_the_factor_is_cos_phi():
    """tan φ* = sin φ and c* = c cos φ for ψ = 0 (Davis 1968): 45° gives 0.7071."""
    strength = strength_of([soil(c=6e3, phi=45.0, psi=0.0)], "davis")
    assert strength.cohesion[0] == pytest.approx(6e3 * math.sqrt(0.5))
    assert math.tan(strength.friction[0]) == pytest.approx(math.sqrt(0.5))
    assert strength.dilation[0] == strength.friction[0]


@given(ANGLES, st.floats(0.0, 1.0))
def test_davis_never_adds_strength_and_takes_none_where_the_flow_is_associated(friction, share):
    phi, psi = np.array([friction]), np.array([share * friction])
    assert davis_factor(phi, phi)[0] == pytest.approx(1.0)
    assert math.cos(friction) - 1e-12 <= davis_factor(phi, psi)[0] <= 1.0 + 1e-12


@given(ANGLES, st.floats(0.0, 1.0))
def test_all_three_forms_are_the_same_without_reduction(friction, share):
    law = soil(c=1e4, phi=math.degrees(friction), psi=math.degrees(share * friction))
    a, b, c = (strength_of([law], "davis", form=form) for form in "ABC")
    assert a.friction[0] == pytest.approx(b.friction[0]) == pytest.approx(c.friction[0])
    assert a.cohesion[0] == pytest.approx(b.cohesion[0]) == pytest.approx(c.cohesion[0])


@pytest.mark.parametrize(
    ("form", "beta"),
    [("A", 0.7071068), ("B", 0.8320503), ("C", 0.8320503)],
)
def test_forms_at_a_factor_of_one_and_a_half(form, beta):
    """φ = 45°, ψ = 0, λ = 1.5: A keeps cos 45°, B and C take cos(atan(1 / 1.5)) (Tschuchnigg et al. 2015)."""
    strength = strength_of([soil(c=6e3, phi=45.0, psi=0.0)], "davis", 1.5, form)
    assert strength.cohesion[0] == pytest.approx(beta * 6e3 / 1.5, rel=1e-6)
    assert math.tan(strength.friction[0]) == pytest.approx(beta / 1.5, rel=1e-6)


def test_form_c_is_associated_once_the_reduced_friction_is_below_the_dilation():
    strength = strength_of([soil(c=6e3, phi=30.0, psi=20.0)], "davis", 2.0, "C")
    assert math.tan(strength.friction[0]) == pytest.approx(math.tan(math.radians(30.0)) / 2.0)
    assert strength.cohesion[0] == pytest.approx(3e3)


def test_flow_as_given_keeps_dilation_below_the_reduced_friction():
    strength = strength_of([soil(phi=30.0, psi=20.0)], "non-associated", 2.0)
    assert strength.dilation[0] == strength.friction[0] == pytest.approx(math.atan(math.tan(math.radians(30.0)) / 2.0))


def test_the_flow_is_with_psi_equal_to_phi_unless_a_dilation_angle_below_phi_is_given():
    def stratum(**keys):
        return Section.parse(slope() | {"strata": [layer("a", friction_angle="30 deg", **keys)]}).strata[0]

    silent, none, full = stratum(), stratum(dilation_angle="0 deg"), stratum(dilation_angle="30 deg")
    assert flow_of([silent, full], "auto") == "associated"
    assert flow_of([silent, none], "auto") == "davis"
    for flow in ("davis", "associated", "non-associated"):
        assert flow_of([silent, none], flow) == flow
    assert davis_words([0.0, 0.0]) == "Davis's estimate for ψ = 0"
    assert davis_words([0.0, 0.1]) == "Davis's estimate for the given ψ"
    clay = Section.parse(slope() | {"strata": [layer("a", friction_angle="0 deg", dilation_angle="0 deg")]}).strata
    assert flow_of(clay, "auto") == "associated"  # 0 is what psi = phi is


def test_only_flow_as_given_can_be_non_associated():
    sand, clay = soil(phi=30.0, psi=0.0), soil(phi=0.0, psi=0.0)
    assert not is_associated([sand, clay], "non-associated")
    assert is_associated([clay], "non-associated")
    assert is_associated([sand], "davis")
    assert is_associated([sand], "associated")
