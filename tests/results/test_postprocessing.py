"""Reactions, boundary forces, residuals of constraints and what the summary says of a run."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.fem import planar_beam, straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes import heavy_top, slider_crank
from sebody.scenes.hinged_beam import SECTION

FINE = generalized_alpha(0.9, 1e-11)
MASS = SECTION.density * SECTION.area * 60.0


def hanging_beam(planar):
    """A beam clamped at its base, loaded at its tip, moving."""
    d = 2 if planar else 3
    beam = planar_beam if planar else straight_beam
    body = craig_bampton(beam(np.zeros(d), np.array([60.0, 0.0, 0.0])[:d], SECTION, 8),
                         [(0, "full"), (8, "full")], 4)
    model = Model(planar=planar)
    model.superelement("beam", body.damped(0.3), [model.node("base", np.zeros(d)),
                                      model.node("tip", np.array([60.0, 0.0, 0.0])[:d])])
    model.fix("base")
    model.gravity([0.0, -9.81, 0.0][:d])
    model.force("tip", [3.0, 40.0, 5.0][:d])
    return model


@pytest.mark.parametrize("planar", [False, True])
def test_reaction_balances_momentum_weight_and_load(planar):
    """Momentum = impulse of support, load and weight, and its moment likewise, at every instant."""
    result = simulate(hanging_beam(planar), 5e-4, 0.2, FINE)
    d = 2 if planar else 3
    load, weight = np.array([3.0, 40.0, 5.0]), np.array([0.0, -9.81 * MASS, 0.0])
    if planar:
        load[2] = 0.0
    support, tip = np.zeros((2, len(result.t), 3))
    support[:, :d], tip[:, :d] = result["base.reaction"], result["tip.position"]
    moment = result["base.reaction_moment"].reshape(len(tip), -1)
    # nothing else is at the base; at the tip there is the load, and on the body its damping
    assert np.abs(result["beam.base.force"] - result["base.reaction"]).max() < 1e-9
    assert np.abs(result["beam.base.moment"].reshape(moment.shape) - moment).max() < 1e-9
    assert np.abs(result["beam.tip.force"] - load[:d]).max() < 1e-3
    assert result["beam.forces"][:, :d] == pytest.approx(result["beam.base.force"])
    moment = np.column_stack([0 * tip[:, :2], moment]) if planar else moment
    moment = moment + np.cross(tip, load) + np.cross([30.0, 0.0, 0.0], weight)
    for rate, momentum in ((support + load + weight, result["momentum"]),
                           (moment, result["angular_momentum"])):
        impulse = cumulative_trapezoid(rate, result.t, axis=0, initial=0.0)
        assert np.abs(impulse - momentum).max() < 2e-3 * np.abs(momentum).max()
    assert np.abs(support).max() > 50.0


def test_boundary_forces_of_neighbours_are_opposite():
    """Two welded superelements: what one gives the other gets, the load at the end included."""
    result = simulate(divided(), 1e-3, 0.2, FINE)
    left, right = result["left.forces"], result["right.forces"]
    # planar f2: positions of both nodes, then angles
    scale = np.abs(left).max()
    assert np.abs(left[:, 2:4] + right[:, 0:2]).max() < 1e-6 * scale
    assert np.abs(left[:, 5] + right[:, 4]).max() < 1e-6 * scale
    assert np.abs(right[:, 2:4] - [0.0, -20.0]).max() < 1e-6 * scale
    assert np.abs(left[:, 0:2] - result["base.reaction"]).max() < 1e-9 * scale


def divided():
    model = Model(planar=True)
    nodes = [model.node(n, (30.0 * k, 0.0)) for k, n in enumerate(("base", "middle", "tip"))]
    for name, a, b in (("left", nodes[0], nodes[1]), ("right", nodes[1], nodes[2])):
        body = craig_bampton(planar_beam(a.point, b.point, SECTION, 4),
                             [(0, "full"), (4, "full")], 0)
        model.superelement(name, body, [a, b])
    model.fix("base")
    model.force("tip", (0.0, -20.0))
    return model


def test_constraints_hold_in_place_and_rate():
    """A mass on a rod, whose constraint is not linear."""
    found = []
    for h in (0.01, 0.005):
        model = Model(planar=True)
        model.gravity((0.0, -9.81))
        model.fix(model.node("hinge", (0.0, 0.0), keeps="translation"), "position")
        model.point_mass("bob", model.node("bob", (-1.0, 0.0), keeps="translation"), 1.0)
        model.distance("hinge", "bob")
        result = simulate(model, h, 2.0, FINE)
        # the last corrections of both coordinates are within the tolerance of the increment
        increment = h * np.abs(result["bob.velocity"]).max()
        assert result["constraints.position"].max() < np.sqrt(2) * 1e-11 * increment
        found.append(result["constraints.velocity"][result.t > 0.1].max())
    # velocities are not projected: second order in the step
    assert found[1] == pytest.approx(found[0] / 4, rel=0.05) and found[1] < 1e-3


def test_summary_names_works_and_constraints():
    scene = slider_crank.build()
    text = simulate(scene.model, scene.h, 0.01).summary()
    assert "constraints          largest residual" in text
    assert "by motion of pin.position" in text and "by motion 2 of pin.position" in text
    assert "momentum at the end" in text
    assert "solved for" not in text
    text = simulate(heavy_top.build(True).model, 1e-3, 0.01).summary()
    assert "solved for           initial velocity of centre.position (by 4.62)" in text


def test_what_has_no_reaction_is_refused():
    result = simulate(heavy_top.build().model, 1e-3, 0.01)
    with pytest.raises(InputError, match="centre.position is free: only fixed and prescribed"):
        result["centre.reaction"]           # it hangs on the pivot
    with pytest.raises(InputError, match="'constraints.acceleration' is unknown: nodes are"):
        result["constraints.acceleration"]


def test_a_free_node_has_no_reaction():
    result = simulate(hanging_beam(True), 1e-3, 0.01)
    with pytest.raises(InputError, match="tip.position is free: only fixed and prescribed nodes"):
        result["tip.reaction"]


def test_reading_results_leaves_the_run_alone():
    """Recorded states are evaluated in the place of the one that the run has reached, later ones.

    With every seventh step recorded, the last row is not where the run goes on from.
    """
    def halfway():
        return Simulation(divided(), 1e-3, output_every=7).run_to(0.05)
    read, unread = halfway(), halfway()
    result = read.result()
    assert result.t[-1] < read.time
    for name in ("energy.kinetic", "base.reaction", "constraints.position"):
        assert np.isfinite(result[name]).all()
    assert np.array_equal(read.state.now, unread.state.now)
    assert np.array_equal(read.run_to(0.1).result().rows, unread.run_to(0.1).result().rows)


def test_moment_of_a_support_is_in_global_axes():
    """An arm turned by 0.7 rad about the vertical and held there bears the weight at its end.

    About the base ``r x m g`` upwards, with r turned: across the arm, in the horizontal plane.
    """
    mass, length, angle = 2.0, 1.5, 0.7
    model = Model()
    model.gravity((0.0, 0.0, -9.81))
    base = model.node("base", (0, 0, 0))
    model.rigid_body("arm", base, mass, (0.1, 0.2, 0.3), centre=(length, 0.0, 0.0))
    model.fix(base, "position")
    model.move(base, (0.0, 0.0, 1.0), [(0.0, 0.0), (1.0, angle)], "rotation")
    # a second body, since something has to move
    model.point_mass("ball", model.node("ball", (9, 9, 9), keeps="translation"), 1.0)
    result = simulate(model, 0.01, 1.5)
    expected = mass * 9.81 * length * np.array([np.sin(angle), -np.cos(angle), 0.0])
    assert result["base.reaction_moment"][-1] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert result["base.reaction"][-1] == pytest.approx([0.0, 0.0, mass * 9.81], abs=1e-9)
