"""Effective masses against a closed form and against the mass."""

import numpy as np
import pytest
from rotor_models import TURNED

from sebody import Model
from sebody.analysis import effective_masses, equilibrium
from sebody.fem import Section

LENGTH, RHO, AREA = 1.3, 7800.0, 2e-4
# of an Euler-Bernoulli cantilever: 4 (tanh or coth pair)^2 / (k L)^2 of the mass; first three
SHARES = 0.613076, 0.188302, 0.0647421


def cantilever(clamped=True):
    """A slender bar along an axis in general position."""
    model = Model()
    root = model.node("root", (0.3, -1.0, 2.0))
    tip = model.node("tip", np.array([0.3, -1.0, 2.0]) + LENGTH * TURNED[:, 0])
    model.beam("bar", (root, tip), Section(AREA, 1e-9, 4e-9, 2e-9, 2e11, 0.3, RHO), 40, 1, 30,
               up=TURNED[:, 2])
    if clamped:
        model.fix(root)
    return model


def test_shares_of_a_cantilever():
    found = effective_masses(equilibrium(cantilever(), 1))
    mass = RHO * AREA * LENGTH
    assert found.total == pytest.approx(np.full(3, mass), rel=1e-9)
    along = (found.factors @ TURNED)**2 / mass
    for axis in (1, 2):
        assert np.sort(along[:, axis])[::-1][:3] == pytest.approx(SHARES, rel=2e-3)
    whole = along.sum(axis=0)       # less the modes that are left out, and what the clamp carries
    assert np.all(whole < 1.0) and np.all(whole[1:] > sum(SHARES))
    assert "effective mass z" in repr(found)


def test_masses_of_what_is_free_are_the_whole():
    found = effective_masses(equilibrium(cantilever(False), 1))
    assert found.masses.sum(axis=0) == pytest.approx(found.total, rel=1e-9)
