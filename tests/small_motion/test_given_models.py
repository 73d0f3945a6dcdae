"""Linear analyses of a model: about its equilibrium, as of the equilibrium's result."""

import numpy as np
import pytest

from sebody import Model, Simulation, SimulationError
from sebody.analysis import (
    effective_masses,
    equilibrium,
    frequency_response,
    linearize,
    modes,
    random_response,
    state_space,
    vibrations,
)
from sebody.fem import circle

ROUND = circle(0.004, 2e11, 0.3, 7800.0)


def sagging(damping=2e-3):
    """An inclined cantilever of three bodies that its weight and a load bend."""
    model = Model()
    model.gravity((0.6, -2.0, -9.0))
    nodes = [model.node(f"n{k}", np.array([0.2, -0.1, 0.3]) + 0.5 * k * np.array([0.8, 0.0, 0.6]))
             for k in range(4)]
    for k in range(3):
        model.beam(f"b{k}", nodes[k:k + 2], ROUND, 4, 1, 3, damping=damping)
    model.fix(nodes[0])
    model.force(nodes[3], (0.0, 1.0, 0.0), 3.0, name="pull")
    return model


def test_a_model_is_seen_in_its_equilibrium():
    model, rest = sagging(), equilibrium(sagging())
    omega = vibrations(rest, 6).omega
    assert np.array_equal(vibrations(model, 6).omega, omega)
    built = vibrations(Simulation(model, 1e-3), 6).omega
    assert np.abs(built / omega - 1.0).max() > 1e-3         # what the bend changes
    for way in (linearize, modes, effective_masses):
        for one, other in zip(way(model), way(rest), strict=True):
            if isinstance(one, np.ndarray):
                assert np.array_equal(one, other)
    at = np.linspace(1.0, 60.0, 7)
    assert np.array_equal(frequency_response(model, "pull", "n3.position", at)["n3.position"],
                          frequency_response(rest, "pull", "n3.position", at)["n3.position"])
    for one, other in zip(state_space(model, "pull", "n3.velocity")[:4],
                          state_space(rest, "pull", "n3.velocity")[:4], strict=True):
        assert np.array_equal(one, other)
    flat = {"pull": [(0.1, 2.0), (80.0, 2.0)]}
    assert random_response(model, flat, "n3.acceleration").rms == random_response(
        rest, flat, "n3.acceleration").rms


def test_a_pendulum_built_aside_swings_about_its_lowest_place():
    length, g = 0.7, 9.81
    model = Model()
    model.gravity((0.0, 0.0, -g))
    pivot = model.node("pivot", (0.1, 0.2, -0.3))
    model.rigid_body("arm", pivot, 2.0, np.zeros((3, 3)),
                     centre=(0.1 + 0.6 * length, 0.2, -0.3 - 0.8 * length))
    model.revolute(pivot, (0.0, 1.0, 0.0), name="hinge")
    assert vibrations(model).omega == pytest.approx([np.sqrt(g / length)], rel=1e-9)


def test_a_spin_is_that_of_the_equilibrium():
    model = sagging()
    spin = (0.0, 0.0, 4.0)
    assert np.array_equal(modes(model, spin=spin).values,
                          modes(equilibrium(model, spin=spin), spin=spin).values)


def test_a_hub_away_from_the_origin_is_on_the_axis_of_the_equilibrium():
    """The same model, shifted: its modes are those about the axis through its hub."""
    def turning(shift):
        model = Model()
        hub = model.node("hub", shift)
        model.rigid_body("boss", hub, 5.0, (0.1, 0.1, 0.2))
        model.revolute(hub, (0.0, 0.0, 1.0))
        for k in range(3):
            way = np.array([np.cos(2.1 * k), np.sin(2.1 * k), 0.2])
            end = model.node(f"end{k}", shift + way)
            model.beam(f"arm{k}", (hub, end), ROUND, 4, 1, 2)
        return model
    spin, away = (0.0, 0.0, 30.0), np.array([2.0, -1.5, 0.4])
    here, there = turning(np.zeros(3)), turning(away)

    def vibrating(found):
        return found.omega[found.omega > 1.0]       # not the free turn, of one value or two
    expected = vibrating(modes(here, spin, "turning"))
    assert vibrating(modes(there, spin, "turning", hub="hub")) == pytest.approx(expected, rel=1e-6)
    rest = modes(equilibrium(there, spin=spin, hub="hub"), spin, "turning", hub="hub")
    assert np.array_equal(modes(there, spin, "turning", hub="hub").values, rest.values)


def test_a_model_without_equilibrium_is_refused():
    model = Model()
    ball = model.node("ball", (0.1, 0.2, 0.3))
    model.rigid_body("mass", ball, 2.0, np.eye(3))
    model.force(ball, (1.0, 0.0, 0.0), 1.0)
    with pytest.raises(SimulationError, match="small motion is that about its equilibrium: .*Give "
                                              r"Simulation\(model, h\) for the state as built"):
        modes(model)
