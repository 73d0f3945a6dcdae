"""Unbalances: forces of what turns, at steady and varying spins, wherever models are read."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rotor_models import AXIS, disc
from scipy.integrate import solve_ivp

from sebody import InputError, Model, Simulation, simulate
from sebody.analysis import Ensemble, final, gradient, resume, save_state
from sebody.model.shafts import shaft_axes
from sebody.model.variants import planar
from sebody.results import animate

SIZE, PHASE, COURSE = 2e-4, 0.7, (30.0, 40.0)   # angle 30 t^2 + 40 t
STIFFNESS = 1e4, 1.44e4
ACROSS = shaft_axes(AXIS)


def angle(t):
    return COURSE[0] * t**2 + COURSE[1] * t


def driven(flat=False):
    """A disc of mass 1 in a bearing, whose angle is a quadratic function of time."""
    if flat:
        model = Model(planar=True)
        model.node("o", (0.0, 0.0))
        model.node("d", (0.0, 0.0))
        model.rigid_body("disc", "d", 1.0, 2e-3)
        model.bushing("o", to="d", stiffness=STIFFNESS, damping=4.0)
        model.fix("o")
    else:
        model = disc((1e5, *STIFFNESS))
        model.loads.clear()
        model.bushing("o", to="d", stiffness=(*STIFFNESS, 1e5), damping=4.0, rotation=ACROSS,
                      turning_stiffness=(1e3, 1e3, 0.0))
    model.unbalance("d", SIZE, PHASE)
    model.move("d", 1.0 if flat else AXIS, (
        angle, lambda t: 2.0 * COURSE[0] * t + COURSE[1], lambda t: 2.0 * COURSE[0]),
        "rotation", name="motor")
    start = {"linear": (0.0, 0.0)} if flat else {"linear": (0.0, 0.0, 0.0)}
    model.initial_velocity("d", **start)
    return model


def exact(t):
    """Places across the shaft by an integrator of ordinary differential equations."""
    def rates(time, y):
        psi, rate, second = angle(time) + PHASE, 2 * COURSE[0] * time + COURSE[1], 2 * COURSE[0]
        force = SIZE * (rate**2 * np.array([np.cos(psi), np.sin(psi)])
                        + second * np.array([np.sin(psi), -np.cos(psi)]))
        return [*y[2:], *(force - 4.0 * y[2:] - STIFFNESS * y[:2])]
    return solve_ivp(rates, (0.0, t[-1]), np.zeros(4), "DOP853", t, rtol=1e-10, atol=1e-14).y[:2].T


@pytest.mark.parametrize("flat", [False, True])
def test_an_unbalance_at_a_spin_that_grows(flat):
    """``m y'' + c y' + k y = m r (w^2 e - w' n x e)``, through the spin's own change, too."""
    result = simulate(driven(flat), 2e-4, 0.4)
    wanted = exact(result.t)
    found = result["d.position"] if flat else result["d.position"] @ ACROSS[:, :2]
    # the scheme's error, h^2 w^3 t / 12 of vibrations, is 2e-3; without the spin's change 2e-2
    assert_allclose(found, wanted, atol=1e-3 * np.abs(wanted).max())
    force = np.linalg.norm(result["unbalance at d.d.force"], axis=1) if not flat else None
    rate = 2 * COURSE[0] * result.t + COURSE[1]
    if not flat:        # the node's own acceleration does not act on what has no mass
        assert_allclose(force, SIZE * np.hypot(rate**2, 2 * COURSE[0]), rtol=1e-6)


def test_weight_of_an_unbalance_has_a_moment():
    """A wheel on a horizontal axle swings as one with its mass beside the axle."""
    model = Model(planar=True)
    model.node("d", (0.0, 0.0))
    model.fix("d", "position")
    model.rigid_body("disc", "d", 1.0, 0.01)
    model.unbalance("d", 2e-3, 0.01 - np.pi / 2)
    model.gravity((0.0, -9.81))
    result = simulate(model, 1e-3, 3.0)
    wanted = 0.01 * (np.cos(np.sqrt(9.81 * 2e-3 / 0.01) * result.t) - 1.0)
    assert_allclose(result["d.rotation"].ravel(), wanted, atol=1e-6)


def test_restarts_copies_and_planes_have_unbalances(tmp_path):
    h = 1e-3
    model = driven()
    whole = Simulation(model, h).run_to(0.05).run_to(0.1).result()
    path = save_state(Simulation(model, h).run_to(0.05), tmp_path / "half.npz")
    rest = resume(driven(), path).run_to(0.1).result()
    assert np.array_equal(rest["d.position"][-1], whole["d.position"][-1])
    upright = Model()
    for name in "od":
        upright.node(name, (0, 0, 0))
    upright.fix("o")
    upright.rigid_body("disc", "d", 1.0, (2e-3, 2e-3, 2e-3))
    upright.bushing("o", to="d", stiffness=(*STIFFNESS, 0.0), damping=4.0)
    upright.unbalance("d", SIZE, PHASE, "z")
    upright.rigid_velocity((0, 0, 0), (0, 0, 60.0))
    flat = planar(upright).model
    assert_allclose(simulate(flat, h, 0.1)["d.position"],
                    simulate(upright, h, 0.1)["d.position"][:, :2], atol=1e-9 * SIZE)


def test_unbalances_vary_in_ensembles_and_gradients():
    h, end = 1e-3, 0.1
    factors = np.array([0.5, 1.0, 1.3])
    name = "unbalance at d.mass"
    ensemble = Ensemble(driven(), h)
    places = ensemble.run({name: factors}, end, {"y": final("d.position")})["y"]
    assert_allclose(places / places[1], np.outer(factors, np.ones(3)), rtol=1e-5)
    found = gradient(driven(), h, end, {"y": final("d.position")}, [name])
    assert_allclose(found.matrix.ravel(), places[1], rtol=1e-5)


def test_directions_of_shafts():
    """By hinges and bearings; of the phase from the next axis of space."""
    model = Model()
    for node in "abc":
        model.node(node, (0, 0, 0))
        model.rigid_body(f"body {node}", node, 1.0, (1, 1, 1))
    with pytest.raises(InputError, match="no hinge or bearing of the model tells the direction"):
        model.unbalance("a", 1.0)
    model.revolute("a", (0, 0, -2))
    made = model.unbalance("a", 3.0, np.pi / 2)
    assert_allclose(made.vector("mc"), (0, 3.0, 0), atol=1e-15)
    assert_allclose(model.unbalance("b", 3.0, 0.0, "x").vector("mc"), (0, 3.0, 0), atol=1e-15)
    assert "unbalance at b" in model.summary() and "m r 3" in model.summary()
    model.revolute("c", (1, 0, 0))
    with pytest.raises(InputError, match="have several directions: give axis="):
        model.unbalance("a", 1.0)


def test_pictures_show_unbalances(tmp_path):
    result = simulate(driven(), 1e-3, 0.01)
    animate(result, tmp_path / "page.html")
    assert "unbalance at d" in (tmp_path / "page.html").read_text()
