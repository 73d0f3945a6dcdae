"""Continuous controllers in general position: many sensors and motors, axes that turn, springs."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import (
    Model,
    Simulation,
    generalized_alpha,
    simulate,
)
from sebody.analysis import modes, state_space
from sebody.fem import StiffnessSection, straight_beam
from sebody.reduction import craig_bampton

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
SHIFT = np.array([2.0, -1.0, 0.5])
SECTION = StiffnessSection(axial=1e4, bending_y=3.0, bending_z=2.0, torsion=1.5, mass=1.0,
                           inertia_x=0.02, inertia_y=0.01, inertia_z=0.01)
SENSED = ("base.angle", "elbow.angle", "elbow.rate", "tip.velocity.x", "tip.angular_velocity.y",
          "beam.modes.0", "beam.mode_rates.1", "end.position.z", "slide.displacement",
          "groove.displacement", "groove.speed")
MOTORS = ("base motor", "elbow motor", "rope", "wind", "thrust")
GAIN = np.random.default_rng(3).uniform(-1.0, 1.0, (5, 11))
ENTERS, LEAVES = (np.random.default_rng(4).uniform(-1.0, 1.0, shape) for shape in ((2, 11), (5, 2)))
INNER = np.array([[-3.0, 1.0], [0.5, -4.0]])        # of the law's own states


def mechanism(start=None):
    """A flexible arm, a rigid one with a rigid link, and a slide: turned, shifted, moving."""
    model = Model()

    def node(name, *point, **options):
        return model.node(name, SHIFT + TURN @ point, **options)
    root, tip, arm = node("root", 0, 0, 0), node("tip", 1, 0, 0), node("arm", 1, 0, 0)
    car = node("car", -0.5, 0.2, 0.4, keeps="translation")
    reduced = craig_bampton(straight_beam(root.point, tip.point, SECTION, elements=4),
                            [(0, "full"), (4, "full")], modes=3)
    model.superelement("beam", reduced, [root, tip])
    model.rigid_body("forearm", arm, 0.7, np.diag([0.02, 0.03, 0.025]))
    end = model.attach("end", SHIFT + TURN @ (1.2, 0.7, 0.3), to="arm")
    model.point_mass("load", end, 0.3)
    model.point_mass("car", car, 1.3)
    axis = TURN @ (0.3, 0.5, 0.8)
    model.revolute(root, axis=axis, name="base")
    model.revolute(arm, to=tip, axis=TURN @ (0.0, 0.6, 0.8), name="elbow")
    model.slider(car, axis=TURN @ (0.8, 0.0, 0.6), name="slide")
    bead = node("bead", 1.25, 0.35, -0.2, keeps="translation")
    model.point_mass("bead", bead, 0.2)
    model.slider(bead, to=arm, axis=TURN @ (0.5, 0.7, -0.4), name="groove")
    model.rigid_velocity((0.0, 0.0, 0.0), 0.9 * axis, about=root.point,
                         nodes=["root", "tip", "arm", "end", "bead"])
    values = np.zeros(5) if start is None else start
    model.actuator("base motor", joint="base", ratio=2.0, start=values[0])
    model.actuator("elbow motor", joint="elbow", start=values[1])
    model.actuator("rope", between=("end", "car"), start=values[2])
    model.actuator("wind", node="tip", direction=(0.2, -1.0, 0.4), start=values[3])
    model.actuator("thrust", joint="groove", start=values[4])
    model.torque("tip", (1.0, 0.0, 0.0), 0.0, name="push")
    return model


def test_the_closed_loop_of_a_mechanism():
    """Matrices of the closed loop are ``A + B K C`` and so on of the open one.

    The open-loop matrices come from the actuators' pushes and from differences of the results'
    quantities, the closed ones from the law's own tangents.
    """
    offset = np.array([0.7, -0.4, 0.5, 0.3, -0.6])
    open_loop = state_space(Simulation(mechanism(offset), 1e-3), MOTORS, SENSED)
    y0 = open_loop.values

    def law(t, y, x, rates, u, parameters):
        for i in range(5):
            u[i] = offset[i]
            for j in range(11):
                gap = y[j] - y0[j]
                u[i] += parameters[0] * GAIN[i, j] * (gap + parameters[1] * gap**3)
            for j in range(2):
                u[i] += LEAVES[i, j] * x[j]
        for i in range(2):
            for j in range(11):
                rates[i] += ENTERS[i, j] * (y[j] - y0[j])
            for j in range(2):
                rates[i] += INNER[i, j] * x[j]
    model = mechanism(offset)
    model.controller("loop", law, SENSED, MOTORS, states=np.zeros(2),
                     parameters=[1.0, 3.0])
    run = Simulation(model, 1e-3)
    closed = state_space(run, ["push"], ["loop.states", *SENSED])
    A, B, C = open_loop[:3]
    names = [*open_loop.states, "loop.states.0", "loop.states.1"]
    order = [closed.states.index(name) for name in names]
    expected = np.block([[A + B @ GAIN @ C, B @ LEAVES], [ENTERS @ C, INNER]])
    # relative to the fastest pole: what differences leave of the readings
    assert_allclose(closed.A[np.ix_(order, order)], expected, rtol=0,
                    atol=1e-8 * np.abs(expected).max())
    assert_allclose(closed.C[2:, order[:len(A)]], C, rtol=0, atol=1e-8 * np.abs(C).max())
    found, values = modes(run).values, np.linalg.eigvals(expected)
    assert len(found) == np.sum(values.imag >= 0)
    for value in found:
        assert np.abs(values - value).min() < 1e-6 * np.abs(values).max()
    # T is that of long steps: the iteration converges as without the law
    plain = Simulation(mechanism(offset), 0.01).run_to(0.2).result()
    weak = mechanism(offset)
    weak.controller("loop", law, SENSED, MOTORS, states=np.zeros(2),
                    parameters=[0.02, 0.0])
    result = Simulation(weak, 0.01).run_to(0.2).result()
    assert result.iterations_per_step < plain.iterations_per_step + 1.0


def test_a_law_equals_springs_and_dampers():
    """Torques of a joint between two moving bodies, against the kernel of torsion springs."""
    def law(t, y, x, rates, u, parameters):
        u[0] = -parameters[0] * y[0] - parameters[1] * y[1]

    def derivatives(t, y, x, D, parameters):
        D[0, 0], D[0, 1] = -parameters[0], -parameters[1]
    found = []
    for case in range(3):
        model = mechanism()
        if case == 0:
            model.torsion_spring("arm", to="tip", axis=TURN @ (0.0, 0.6, 0.8), stiffness=4.0,
                                 damping=0.3)
        else:
            model.controller("loop", law, ["elbow.angle", "elbow.rate"], ["elbow motor"],
                             parameters=[4.0, 0.3],
                             derivatives=derivatives if case == 2 else None)
        model.gravity((0.0, -9.81, 0.0))
        found.append(simulate(model, 2e-3, 0.6, generalized_alpha(tolerance=1e-12)))
    for name in ("end.position", "tip.velocity", "elbow.moment"):
        for own in found[1:]:
            # reactions are left with some thousand times the tolerance of the increments
            assert_allclose(own[name], found[0][name], rtol=0,
                            atol=1e-7 * np.abs(found[0][name]).max())
    assert abs(found[1].iterations_per_step - found[0].iterations_per_step) < 0.3
    work = found[1]["elbow motor.work"][-1]
    assert work == pytest.approx(-np.trapezoid(
        found[1]["elbow motor.value"] * -found[1]["elbow.rate"], found[1].t), rel=1e-3)


@pytest.mark.parametrize("planar", [True, False])
def test_a_sensor_in_axes_that_turn(planar):
    """Velocity in the axes of a hinged node, against a law that turns it by the angle itself."""
    e = np.array((0.0, 0.0, 1.0)) if planar else TURN @ (0.48, 0.6, 0.64)

    def turns(t, y, x, rates, u, parameters):
        u[0] = 0.5 - 0.8 * y[0]

    def by_angle(t, y, x, rates, u, parameters):
        c, s = np.cos(y[0]), np.sin(y[0])
        v = y[1:]
        across = e[1] * v[2 % v.size] * (v.size == 3) - e[2] * v[1]
        along = e[0] * v[0] + e[1] * v[1] + (e[2] * v[2 % v.size] if v.size == 3 else 0.0)
        u[0] = 0.5 - 0.8 * (c * v[0] - s * across + (1 - c) * along * e[0])
    found, matrices = [], []
    for own in (True, False):
        model = Model(planar=planar)
        size = model.dimension
        hub = model.node("hub", SHIFT[:size])
        tip = model.attach("tip", SHIFT[:size] + np.array((0.6, -0.5, 0.7))[:size], to=hub)
        model.rigid_body("arm", hub, 1.0, 0.1 if planar else np.diag([0.1, 0.2, 0.15]))
        model.point_mass("load", tip, 0.4)
        model.revolute(hub, **({} if planar else {"axis": e}), name="hinge")
        model.actuator("motor", joint="hinge")
        model.torque(hub, 1.0 if planar else e, 0.0, name="push")
        model.sensor("own", "tip.velocity.x", axes="hub")
        inputs = ["own"] if own else ["hinge.angle", *(f"tip.velocity.{i}" for i in "xyz"[:size])]
        model.controller("loop", turns if own else by_angle, inputs, ["motor"])
        found.append(Simulation(model, 0.01).run_to(1.5))
        matrices.append(state_space(found[-1], "push", "hinge.angle").A)
    rows = [run.result() for run in found]
    assert np.ptp(rows[0]["hinge.angle"]) > 0.5
    assert_allclose(rows[0]["tip.position"], rows[1]["tip.position"], rtol=0, atol=1e-7)
    assert_allclose(matrices[0], matrices[1], rtol=0, atol=1e-6 * np.abs(matrices[0]).max())
