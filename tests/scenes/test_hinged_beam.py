"""The paper's hinged beam against a geometrically exact reference, and its balances."""

from functools import cache

import numpy as np
import pytest
from helpers import order

from sebody import generalized_alpha, hht, simulate
from sebody.scenes.hinged_beam import build
from sebody.verify import references

TORQUE_ENDS = 7.5


@cache
def run(frame="converged_mean", h=0.01, t_end=30.0, alpha=None, tangent="consistent",
        inertia=None):
    scene = build(frame=frame, inertia=inertia)
    scheme = (generalized_alpha(0.9, tangent=tangent) if alpha is None
              else hht(alpha, tangent=tangent))
    return simulate(scene.model, h, t_end, scheme)


def tip_error(result):
    reference = references.reference("hinged_beam")["tip_position"]
    return np.linalg.norm(result["tip.position"] - reference) / np.linalg.norm(reference)


def test_tip_against_geometrically_exact_beam():
    """8e-5 are left with small steps; at 0.005 a part of it and of the error in time cancel."""
    assert tip_error(run()) <= 3e-4
    assert tip_error(run(inertia="material")) <= 9.5e-4
    fine = run(h=0.005)
    exact = references.reference("hinged_beam")["tip_position"]
    assert np.linalg.norm(fine["tip.position"][::2] - exact) <= 1.2e-4 * np.linalg.norm(exact)


def test_node_frame_is_less_accurate_with_option_b():
    """The paper's claim: the frame at the base costs a factor of three (2.9e-3)."""
    assert 2.5e-3 < tip_error(run("node", inertia="material")) < 3.3e-3


@pytest.mark.parametrize("alpha, expected", [(-0.05, 9.3e-4), (-0.1, 9.6e-4)])
def test_hht_tip_error(alpha, expected):
    """With option B in another program, which is not in this repository, and its reference.

    Neither follows from a formula; 5 % allow for the two digits and the other reference.
    """
    assert tip_error(run(alpha=alpha, inertia="material")) == pytest.approx(expected, rel=0.05)


def test_energy_is_constant_after_the_torque():
    """To second order in the step."""
    steps, spreads = (0.01, 0.005, 0.0025), []
    for h in steps:
        result = run(h=h)
        energy = (result["energy.kinetic"] + result["energy.strain"])[result.t > TORQUE_ENDS + h]
        spreads.append(np.ptp(energy) / energy.mean())
    assert spreads[0] <= 2.5e-6 and order(steps, spreads) > 1.8


def test_external_work_against_reference():
    reference = references.reference("hinged_beam")
    assert run()["energy.external_work"][-1] == pytest.approx(
        reference["external_work"][-1], rel=1e-3)


def test_newton_iterations_and_no_cut_steps():
    result = run()
    assert result.iterations_per_step <= 3.0
    assert result.cuts == 0
    assert result.steps == 3000


def test_motion_stays_in_the_plane():
    """Rounding excites the undamped bending out of the plane: 3e-9 of the length in 30 s."""
    assert np.abs(run()["tip.position"][:, 2]).max() < 1e-8 * 141.42


def test_mean_and_converged_mean_agree():
    tips = [run(frame, inertia="material")["tip.position"] for frame in ("mean", "converged_mean")]
    assert np.linalg.norm(tips[0] - tips[1]) / np.linalg.norm(tips[1]) <= 1e-5


def smooth_torque(t):
    """Rises to 1.2e4 over two seconds with eight continuous derivatives at the start."""
    x = min(max(t / 2.0, 0.0), 1.0)
    return 1.2e4 * x**5 * (126.0 - 420.0 * x + 540.0 * x * x - 315.0 * x**3 + 70.0 * x**4)


@pytest.mark.parametrize("torque, t_end, steps, finest", [
    (smooth_torque, 3.0, (0.02, 0.01, 0.005, 0.0025), 0.0003125),
    (None, 1.0, (0.001, 0.0005, 0.00025, 0.000125), 0.00003125)])
def test_second_order_in_the_step(torque, t_end, steps, finest):
    """The kinks of the scene's own torque excite modes that need steps below 0.001."""
    def tip(h):
        scene = build()
        if torque:
            scene.model.loads.clear()
            scene.model.torque("base", (0, 0, 1), torque)
        result = simulate(scene.model, h, t_end, generalized_alpha(0.9, tolerance=1e-10))
        return result["tip.position"][::round(steps[0] / h)]

    fine = tip(finest)
    errors = [np.linalg.norm(tip(h) - fine) for h in steps]
    assert 1.9 <= order(steps, errors) <= 2.1


def test_paper_tangent_gives_the_same_motion_with_more_iterations():
    paper, exact = run(tangent="paper", t_end=5.0), run(t_end=5.0)
    difference = np.abs(paper["tip.position"] - exact["tip.position"]).max()
    assert difference < 1e-3
    assert paper.iterations_per_step >= exact.iterations_per_step - 0.1
