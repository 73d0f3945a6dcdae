"""Structural damping of superelements: decay of vibrations, none of rigid motion."""

import numpy as np
import pytest
from scipy.linalg import eigh

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.fem import planar_beam, straight_beam
from sebody.reduction import ReducedBody, craig_bampton
from sebody.scenes.hinged_beam import SECTION

LENGTH = 100.0
UNDAMPED = generalized_alpha(1.0, 1e-11)


def body(planar=True, modes=4):
    fe_model = (planar_beam((0, 0), (LENGTH, 0), SECTION, 10) if planar else
                straight_beam((0, 0, 0), (LENGTH, 0, 0), SECTION, 10))
    return craig_bampton(fe_model, [(0, "full"), (10, "full")], modes)


@pytest.mark.parametrize("options, ratio_of", [
    ({"ratio": 0.03}, lambda w: 0.03), ({"stiffness": 1e-3}, lambda w: 5e-4 * w),
    ({"mass": 0.4}, lambda w: 0.2 / w)])
def test_free_modes_decay_as_asked(options, ratio_of):
    """Each vibration mode of the free body has its ratio; rigid ones none."""
    damped = body().damped(**options)
    squares, shapes = eigh(damped.stiffness, damped.mass)
    modal = shapes.T @ damped.damping @ shapes
    omega = np.sqrt(squares[3:])
    expected = np.diag(np.r_[np.zeros(3), 2 * np.array([ratio_of(w) for w in omega]) * omega])
    assert np.abs(modal - expected).max() < 1e-8 * expected.max()


def test_vibration_of_a_free_beam_decays():
    """The lowest mode set going in a free beam: logarithmic decrement of its ratio."""
    damped = body().damped(0.02)
    squares, shapes = eigh(damped.stiffness, damped.mass)
    omega, shape = np.sqrt(squares[3]), shapes[:, 3]
    model = Model(planar=True)
    nodes = [model.node("base", (0, 0)), model.node("tip", (LENGTH, 0))]
    beam = model.superelement("beam", damped, nodes)
    for node, at in zip(nodes, (0, 2), strict=True):
        node.position.rate = 1e-3 * shape[at:at + 2]
    for node, at in zip(nodes, (4, 5), strict=True):
        node.rotation.rate = 1e-3 * shape[at:at + 1]
    beam.mode_rates[:] = 1e-3 * shape[6:]
    period = 2 * np.pi / omega
    result = simulate(model, period / 400, 5 * period, UNDAMPED)
    energy = result["energy.kinetic"] + result["energy.strain"]
    assert np.log(energy[0] / energy[-1]) == pytest.approx(2 * 0.02 * omega * 5 * period, rel=2e-2)
    assert result.energy_balance() < 1e-4
    assert result["damping of beam.work"][-1] == pytest.approx(energy[-1] - energy[0], rel=1e-3)


def test_rigid_motion_is_not_damped():
    """A free spinning beam, stiff enough to stay straight, keeps its spin and its energy."""
    model = Model()
    nodes = [model.node("base", (0, 0, 0)), model.node("tip", (LENGTH, 0, 0))]
    model.superelement("beam", body(planar=False).damped(0.5), nodes)
    model.rigid_velocity((1.0, 0.0, 0.0), (0.02, 0.01, 0.05), about=(LENGTH / 2, 0, 0))
    result = simulate(model, 0.01, 20.0)
    energy = result["energy.kinetic"] + result["energy.strain"]
    assert (energy[0] - energy[-1]) / energy[0] < 1e-4
    H = result["angular_momentum"]
    assert np.abs(H - H[0]).max() < 1e-3 * np.linalg.norm(H[0])


@pytest.mark.parametrize("make, message", [
    (lambda b: b.damped(-0.1), "damping: ratio is -0.1: give a finite number >= 0"),
    (lambda b: b.damped(stiffness=np.nan), "damping: stiffness is nan"),
    (lambda b: with_damping(b, -b.stiffness), "damping is negative .*: it would put|put energy in"),
    (lambda b: with_damping(b, b.mass), "damping resists rigid motion .*; use damped"),
    (lambda b: with_damping(b, b.mass[:3]), "damping has shape")])
def test_wrong_damping(make, message):
    with pytest.raises(InputError, match=message):
        make(body())


def with_damping(b, damping):
    return ReducedBody(b.stiffness, b.mass, b.coordinates, b.keeps, b.modes, damping)
