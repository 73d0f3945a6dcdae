"""Rigid links in the plane: remembered cosines and sines always belong to the angles at hand."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation
from sebody.engine.links import place_dependent, pull_back
from sebody.scenes import four_bar


def crank() -> Model:
    """A bar on a shaft with two further points, and a second bar on a point of the first."""
    model = Model(planar=True)
    model.gravity((1.0, -9.81))
    foot = model.node("foot", (0.3, -0.2))
    model.fix(foot, "position")
    model.rigid_body("crank", foot, 1.3, 0.4, centre=(0.6, 0.1))
    model.attach("elbow", (1.1, 0.4), foot)
    model.attach("side", (-0.4, 0.9), foot)
    fore = model.node("fore", (1.1, 0.4), at="elbow")
    model.rigid_body("fore", fore, 0.7, 0.1, centre=(1.6, 0.2))
    model.attach("hand", (2.0, -0.3), fore)
    return model


def placed(run: Simulation) -> np.ndarray:
    """The state after its dependent positions are set, and forces that are pulled back."""
    state, system = run.state, run.system
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    forces = np.arange(1.0, state.q.size + 1)
    pull_back(system.links, state.q, state.R, state.turns, forces)
    return np.concatenate([state.q, state.v, state.a, forces])


def by_complex_numbers(run: Simulation) -> np.ndarray:
    """The same with every arm turned by a product with exp(i angle)."""
    links, (q, v, a) = run.system.links, (x.copy() for x in (
        run.state.q, run.state.v, run.state.a))
    forces = np.arange(1.0, q.size + 1)
    for x, root, first, last in links.dependent:
        for values in (q, v, a):
            values[x:x + 2] = values[root:root + 2]
        forces[root:root + 2] += forces[x:x + 2]
        for (_, c), r in zip(links.arms[first:last], links.arm_vectors[first:last], strict=True):
            arm = complex(*r) * np.exp(1j * q[c])
            for values, part in ((q, arm), (v, 1j * v[c] * arm),
                                 (a, (1j * a[c] - v[c] ** 2) * arm)):
                values[x:x + 2] += part.real, part.imag
            forces[c] += (arm.conjugate() * complex(*forces[x:x + 2])).imag
    return np.concatenate([q, v, a, forces])


def test_angles_may_be_set_from_outside():
    """All of them, one of them, and those of an earlier state once more."""
    run = Simulation(crank(), 1e-3).run_to(0.05)
    state, rng = run.state, np.random.default_rng(4)
    angles = np.unique(run.system.links.arms[:, 1])
    assert len(angles) == 2 and state.turns.size == 3 * state.q.size
    earlier = state.now.copy()
    first = placed(run)
    for change in (lambda: state.q.__setitem__(angles, rng.uniform(-9, 9, 2)),
                   lambda: state.q.__setitem__(angles[1], -2.5),
                   lambda: state.q.__setitem__(angles, 0.0),
                   lambda: state.now.__setitem__(slice(None), earlier)):
        change()
        found, other = placed(run), by_complex_numbers(run)
        assert np.abs(found - other).max() < 1e-13 * np.abs(other).max()    # of a dozen operations
    assert np.array_equal(found, first)


def test_forces_are_pulled_back_by_the_angles_they_are_given():
    """Positions were placed at other angles before."""
    run = Simulation(crank(), 1e-3)
    state, links = run.state, run.system.links
    placed(run)
    state.q[links.arms[:, 1]] += 0.7
    forces = np.arange(1.0, state.q.size + 1)
    pull_back(links, state.q, state.R, state.turns, forces)
    other = by_complex_numbers(run)[-state.q.size:]
    assert np.abs(forces - other).max() < 1e-13 * np.abs(other).max()


@pytest.mark.parametrize("angle", [0.0, 0.4, np.nan])
def test_what_is_remembered_does_not_change_a_run(angle):
    """Before every stop the memory is emptied, or gets the same angle for all coordinates."""
    model = four_bar.build(2).model
    whole, other = Simulation(model, 1e-3), Simulation(model, 1e-3)
    for t in (0.02, 0.03, 0.05):
        whole.run_to(t)
        other.state.turns.reshape(-1, 3)[:] = angle, np.cos(angle), np.sin(angle)
        other.run_to(t)
    assert np.array_equal(whole.state.now, other.state.now)


def test_models_that_turn_no_arms_in_the_plane_remember_nothing():
    spatial, free = Model(), Model(planar=True)
    base = spatial.node("base", (0, 0, 0))
    spatial.rigid_body("body", base, 1.0, np.eye(3))
    spatial.attach("end", (1.0, 0, 0), base)
    free.rigid_body("body", free.node("base", (0, 0)), 1.0, 1.0)
    for model in (spatial, free):
        assert Simulation(model, 1e-3).state.turns.size == 0


def test_rates_in_space_are_derivatives_of_a_motion():
    """Central differences of places while the root moves and turns with constant accelerations."""
    model = Model()
    foot = model.node("foot", (0.3, -0.2, 0.7))
    model.rigid_body("crank", foot, 1.3, 0.4 * np.eye(3), centre=(0.6, 0.1, 0.2))
    model.attach("elbow", (1.1, 0.4, -0.3), foot)
    model.rigid_body("end", "elbow", 0.3, 0.1 * np.eye(3))
    run = Simulation(model, 1e-3)
    state, links, rng = run.state, run.system.links, np.random.default_rng(8)
    (x, root, first, last), = links.dependent
    (matrix, c), = links.arms[first:last]
    turn = Rotation.random(random_state=3)
    state.R[9 * matrix:9 * matrix + 9] = turn.as_matrix().ravel()
    for part in (state.q, state.v, state.a):
        part[:] = rng.uniform(-1.0, 1.0, part.size)
    q, v, a = (part[root:root + 3].copy() for part in (state.q, state.v, state.a))
    rate, change, arm = state.v[c:c + 3].copy(), state.a[c:c + 3].copy(), links.arm_vectors[first]
    place_dependent(links, state.q, state.v, state.a, state.R, state.turns)

    def place(t):
        turned = turn * Rotation.from_rotvec(rate * t + change * t**2 / 2)
        return q + v * t + a * t**2 / 2 + turned.apply(arm)
    h = 1e-3
    before, now, after = place(-h), place(0.0), place(h)
    assert state.q[x:x + 3] == pytest.approx(now, abs=1e-14)
    assert state.v[x:x + 3] == pytest.approx((after - before) / (2.0 * h), abs=1e-5)
    assert state.a[x:x + 3] == pytest.approx((after - 2.0 * now + before) / h**2, abs=1e-5)
