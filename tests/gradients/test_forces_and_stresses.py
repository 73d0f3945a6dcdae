"""Gradients of forces of joints and of stresses, against differences of runs."""

import differentiated as scenes
import numpy as np
import pytest

from sebody import InputError, simulate
from sebody.analysis import at_time, final, gradient, integral, soft_maximum
from sebody.fem.stress import von_mises


def test_forces_of_joints():
    """Of multipliers the runs themselves have more noise: differences over larger steps."""
    run = scenes.joined(), 0.005, 0.1, {"rope": final("rope.force"), "m": final("cross.moment")}, [
        "ball.mass", "gravity.y"]
    found, apart = scenes.both(*run)
    assert apart < 1e-10
    expected = scenes.differences(*run, relative=3e-2)
    assert (np.abs(found.matrix - expected) / scenes.rows(expected)).max() < 3e-6


def test_stresses():
    """Differences of runs have the noise of Newton's tolerance, 1e-13, over steps of 1e-3.

    Of the largest section force that noise is 1e-10; the axial force is 100 times smaller, and is
    a difference of large ones.
    """
    run = scenes.hinged(modes=2), 0.005, 0.1
    parameters = ["torque.amplitude", "beam.mass", "gravity"]
    objectives = {"largest": final("beam.node0.von_mises"), "xx": final("beam.node0.stress.xx"),
                  "norm": final("beam.node2.stress.norm"),
                  "soft": soft_maximum("beam.node0.von_mises"),
                  "sections": final("beam.node2.section_forces")}
    found = gradient(*run, objectives, parameters, scheme=scenes.EXACT)
    expected = scenes.differences(*run, objectives, parameters)
    apart = np.abs(found.matrix - expected) / scenes.rows(expected)
    assert apart[:4].max() < 1e-7 and apart[4:].max() < 5e-6


def test_stresses_beside_the_place_where_another_fibre_takes_over():
    """Up to it the derivative is that of the fibre at hand, here by runs with stresses of this one.

    Gravity along the hinge bends the beam to one or the other side; where the largest stress moves
    to another place of the section is found by bisection.
    """
    def model(g):
        m = scenes.hinged(modes=2)
        m.gravity(-9.81 * scenes.Y + g * scenes.Z)
        return m

    def fibres(g):
        field = simulate(model(g), 0.005, 0.1, scenes.EXACT).field("beam")
        return von_mises(field.at(0).fibre_stress[-1])
    low, high = -5.6, -2.0
    while high - low > 1e-6:
        middle = (low + high) / 2
        same = fibres(middle).argmax() == fibres(high).argmax()
        low, high = (low, middle) if same else (middle, high)
    assert fibres(low).argmax() != fibres(high).argmax()
    step = 1e-4
    for g in (low, high):
        fibre = fibres(g).argmax()
        expected = (fibres(g + step) - fibres(g - step))[fibre] / (2 * step)
        found = gradient(model(g), 0.005, 0.1, {"largest": final("beam.node0.von_mises")},
                         ["gravity"], scheme=scenes.EXACT).matrix[0] @ scenes.Z
        assert found == pytest.approx(expected, rel=1e-6)


def test_stresses_that_are_equal_by_symmetry():
    """A beam that bends in a plane: corners on both sides of the plane are stressed alike."""
    m = scenes.hinged(modes=2)
    m.gravity(-9.81 * scenes.Y)
    m.loads = [one for one in m.loads if one.name != "spring"]
    run = m, 0.005, 0.1, {"largest": final("beam.node0.von_mises")}, ["torque.amplitude"]
    expected = scenes.differences(*run)
    assert gradient(*run, scheme=scenes.EXACT).matrix == pytest.approx(expected, rel=1e-7)


def test_stresses_without_derivative():
    run = scenes.hinged(modes=2), 0.005, 0.1
    run[0].gravity((0.0, 0.0, 0.0))     # so nothing is stressed at the start
    run[0].loads = [one for one in run[0].loads if one.name == "torque"]
    with pytest.raises(InputError, match="von_mises' has no derivative at t = 0: the stress is zero"
                       " there, .* give section forces, or another time"):
        gradient(*run, {"mean": integral("beam.node0.von_mises")}, ["torque.amplitude"])


def test_a_length_that_is_zero_has_no_derivative():
    with pytest.raises(InputError, match="displacement.norm' has no derivative at t = 0: it is not "
                       "smooth there, .* give its components"):
        gradient(scenes.hinged(modes=2), 0.005, 0.05, {
            "bent": at_time("beam.node0.displacement.norm", 0.0)}, ["beam.mass"])
