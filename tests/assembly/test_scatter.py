"""Entries of element matrices that the matrix of the system leaves out, with option B."""

import numpy as np
import pytest

from sebody import Model
from sebody.fem import Section, straight_beam
from sebody.generated.options import INERTIA_OPTIONS
from sebody.reduction import ReducedBody, craig_bampton
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import derivative

SECTION = Section(area=9e-4, inertia_y=6.75e-8, inertia_z=5e-8, torsion=1e-7, youngs_modulus=2.1e11,
                  poisson_ratio=0.3, density=7.8e3)
MODES = 24
ENDS = (0.3, -0.1, 0.2), (0.9, 0.4, 0.5)


def normal_modes():
    return craig_bampton(straight_beam(*ENDS, SECTION, elements=8), [(0, "full"), (8, "full")],
                         modes=MODES)


def mixed_modes():
    """The same body in other modes: combinations of them."""
    body = normal_modes()
    n = len(body.mass)
    mixing = np.eye(n)
    mixing[n - MODES:, n - MODES:] += np.random.default_rng(1).normal(size=(MODES, MODES)) / MODES
    return ReducedBody(mixing.T @ body.stiffness @ mixing, mixing.T @ body.mass @ mixing,
                       body.coordinates, body.keeps, MODES)


def mechanism(body, linked=False):
    """Two equal bodies that share a node, or the end of a rigid link on it, moving."""
    model = Model()
    ends = [np.array(end) for end in ENDS]
    base, middle = model.node("base", ends[0]), model.node("middle", ends[1])
    model.superelement("first", body, [base, middle], inertia="material")
    shift = ends[1] - ends[0] + linked * np.array([0.0, 0.05, -0.02])
    root = model.attach("root", ends[0] + shift, middle) if linked else middle
    tip = model.node("tip", ends[1] + shift)
    model.superelement("second", body, [root, tip], inertia="material")
    model.revolute(base, axis=(0, 0, 1))
    model.gravity((0.0, -9.81, 0.0))
    return Simulation(model, h=1e-4).run_to(3e-3)


@pytest.mark.parametrize("linked", [False, True])
def test_entries_left_out_are_zero(linked, monkeypatch):
    """The matrix in a general state with the zeros left out, and with all entries."""
    run = mechanism(normal_modes(), linked)
    monkeypatch.setitem(INERTIA_OPTIONS, "material",
                        INERTIA_OPTIONS["material"]._replace(modes_apart=False))
    whole = mechanism(normal_modes(), linked)
    assert len(run.system.J_entry) < 0.7 * len(whole.system.J_entry)
    assert len(run.system.rows) < 0.7 * len(whole.system.rows)
    whole.state.now[:] = run.state.now
    for weights in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        exact = derivative(whole, *weights)
        assert exact.nnz and abs(derivative(run, *weights) - exact).max() == 0.0


def test_modes_that_are_no_normal_modes_keep_their_entries():
    """Motion does not depend on the choice of the modes; the matrix is full."""
    run, same = mechanism(mixed_modes()), mechanism(normal_modes())
    assert len(run.system.J_entry) > 1.4 * len(same.system.J_entry)
    # iterations end at 1e-8 of the increment; the modes' condition number amplifies it little
    np.testing.assert_allclose(run.result()["tip.position"], same.result()["tip.position"],
                               rtol=1e-9)
