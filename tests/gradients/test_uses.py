"""What gradients are for: functions of a vector for optimizers, and calibration."""

import differentiated as scenes
import numpy as np
import pytest
from scipy.optimize import minimize

from sebody import InputError, LimitWarning, Model, simulate
from sebody.analysis import ValueAndGradient, calibrate, final, gradient, integral, rms
from sebody.gradients.point import Point
from sebody.runs.schemes import generalized_alpha

PARAMETERS = ["spring.stiffness", "beam.mass", "beam.stiffness"]
TRUE = np.array([24.0, 1.1, 0.9])


def measured(noise):
    """Histories of the beam with other numbers than the model's, with noise."""
    m = scenes.hinged("b", modes=2)
    with Point(m, PARAMETERS).at(TRUE):
        run = simulate(m, 0.005, 0.3)
    t, values = run["t"], run["tip.position"]
    random = np.random.default_rng(5)
    return {"tip.position": np.column_stack([t, values + noise * random.standard_normal(
        values.shape)])}


def test_calibration_finds_the_numbers_of_noisy_measurements():
    """Within three standard deviations, which are those of the noise."""
    found = calibrate(scenes.hinged("b", modes=2), 0.005, measured(1e-3), PARAMETERS)
    assert (np.abs(found.value - TRUE) < 3 * found.deviation).all()
    assert found.residual == pytest.approx(1e-3, rel=0.15)      # of 180 numbers
    assert (found.deviation < 0.03 * TRUE).all()


def test_calibration_without_noise_is_exact():
    found = calibrate(scenes.hinged("b", modes=2), 0.005, measured(0.0), PARAMETERS)
    assert found.value == pytest.approx(TRUE, rel=1e-6)


@pytest.mark.parametrize(("rows", "parameters", "words"), [
    ({"tip.position": [[0.1, 1.0]]}, ["gravity.y"], "1 numbers at a time, the quantity 3"),
    ({"tip.position.x": [[0.1, 1.0]]}, ["gravity.y", "beam.mass"], "cannot determine 2"),
    ({"tip.position.x": [[0.1]]}, ["gravity.y"], "give rows"),
    ({"torque.work": [[0.1, 1.0]]}, ["gravity.y"], "power"),
    ({"base.position.x": [[0.1, 1.0], [0.2, 1.0]]}, ["beam.mass"], "do not depend on beam.mass"),
])
def test_wrong_measurements(rows, parameters, words):
    with pytest.raises(InputError, match=words):
        calibrate(scenes.hinged("b", modes=2), 0.005, rows, parameters)


def test_warnings_of_all_runs_are_said_once_and_name_the_line_of_the_caller():
    m = scenes.hinged("b", modes=2)
    with pytest.warns(LimitWarning) as said:
        found = calibrate(m, 0.005, {"tip.position": measured(0.0)["tip.position"][:20]},
                          ["beam.mass"], scheme=generalized_alpha(tolerance=1e-10, index=2))
    assert found.runs > 2
    assert [one.filename for one in said if "index 2" in str(one.message)] == [__file__]
    assert len({str(one.message) for one in said}) == len(said)


def test_deviations_are_a_dict():
    with pytest.raises(InputError, match="deviations is 3: give a dict"):
        calibrate(scenes.hinged("b", modes=2), 0.005, {"tip.position.x": [[0.0, 1.0]]},
                  ["gravity.y"], deviations=3)


def test_an_optimizer_finds_the_torque_that_reaches_a_place():
    """A pendulum is to stand at an angle: minimum against the torques of a table."""
    m = Model(planar=True)
    a = m.node("a", (0.0, 0.0))
    m.rigid_body("bar", a, 1.0, 0.4, centre=(0.5, 0.0))
    m.revolute(a)
    tip = m.attach("tip", (1.0, 0.0), a)
    target = m.node("target", (0.0, 1.0))
    m.fix(target)
    m.spring(tip, target, stiffness=0.0, damping=0.0, length=0.0, name="way")
    m.torque(a, 1.0, [(0.0, 1.0), (0.3, 1.0), (0.6, 0.5), (1.0, 0.0)], name="motor")
    f = ValueAndGradient(m, 0.02, 1.0, final("tip.position.y"), ["motor.table"])
    found = minimize(lambda x: tuple(-part for part in f(x)), f.base, jac=True,
                     method="L-BFGS-B")
    assert found.fun == pytest.approx(-1.0, abs=1e-6)       # the tip is as high as it can be
    assert f.runs < 30


def test_values_elsewhere_are_those_of_a_model_built_so():
    """Two factors of one body at once, and an entry of a table."""
    m = scenes.hinged("b", modes=2)
    f = ValueAndGradient(m, 0.005, 0.1, rms("tip.position.y"),
                         ["beam.mass", "beam.stiffness", "torque.table"])
    x = f.base + [0.2, -0.1, 0.3, 0.1, -0.2, 0.0]
    value, slope = f(x)
    step = 1e-4
    for k in (0, 3):
        moved = [f(x + at * step * np.eye(len(x))[k])[0] for at in (1, -1, 2, -2)]
        assert slope[k] == pytest.approx(
            (8 * (moved[0] - moved[1]) - moved[2] + moved[3]) / (12 * step), rel=1e-6)
    assert f(f.base)[0] != pytest.approx(value, rel=1e-3)
    assert gradient(m, 0.005, 0.1, rms("tip.position.y"), ["beam.mass"]).value[0] == f(f.base)[0]


def test_several_values_are_no_function():
    f = ValueAndGradient(scenes.hinged("b", modes=2), 0.005, 0.05, final("tip.position"),
                         ["gravity.y"])
    with pytest.raises(InputError, match="3 values.*gradient_at"):
        f(f.base)
    with pytest.raises(InputError, match="x has shape|give 1 numbers"):
        f([1.0, 2.0])
    f = ValueAndGradient(scenes.hinged("b", modes=2), 0.005, 0.05, final("tip.position.x"),
                         ["beam.mass", "gravity.y"])
    with pytest.raises(InputError, match="beam.mass is -0.5: it must be above 0; give .* bounds"):
        f([-0.5, -9.81])


@pytest.mark.filterwarnings("error")
def test_chaotic_runs_are_named():
    """A double pendulum from nearly upright, in both modes."""
    m = Model(planar=True)
    m.gravity((0.0, -9.81))
    way = np.array([np.sin(2.5), -np.cos(2.5)])
    a = m.node("a", (0.0, 0.0))
    m.rigid_body("upper", a, 1.0, 0.33, centre=way / 2)
    m.revolute(a)
    elbow = m.attach("elbow", way, a)
    b = m.node("b", way, at=elbow)
    m.rigid_body("lower", b, 1.0, 0.33, centre=1.5 * way)
    m.attach("tip", 2 * way, b)
    for mode in ("adjoint", "forward"):
        with pytest.warns(LimitWarning, match="unstable or chaotic"):
            gradient(m, 0.01, 16.0, final("tip.position"), ["upper.mass"], mode)
    assert gradient(m, 0.01, 0.5, final("tip.position"), ["upper.mass"]).growth < 10


def test_the_growth_of_a_plain_swing():
    """Integrals too: the last effects on these are of a step, a thousandth of the others."""
    m = Model(planar=True)
    m.gravity((0.3, -9.81))
    m.rigid_body("rod", m.node("a", (1.0, 2.0)), 1.0, 0.1, centre=(2.0, 2.1))
    m.attach("tip", (3.0, 2.2), "a")
    m.revolute("a")
    m.torsion_spring("a", 0.5, name="spring")
    for objective in (final("tip.position"), integral("tip.position")):
        for h in (0.01, 0.001):
            for mode in ("adjoint", "forward"):
                assert gradient(m, h, 2.0, objective, ["spring.stiffness"], mode).growth < 50


@pytest.mark.parametrize("amplitude", [2.0, 0.0])
def test_gradient_by_an_amplitude_at_other_values(amplitude):
    """Of a load that jumps off the grid; at zero there is no value to scale."""
    f = ValueAndGradient(scenes.struck(), 0.01, 0.12, final("b.position.x"), ["gust.amplitude"],
                         scheme=generalized_alpha(tolerance=1e-13))
    _, slope = f(np.array([amplitude]))
    values = [f(np.array([amplitude + 1e-2 * k]))[0] for k in scenes.STEPS]
    assert slope[0] == pytest.approx(scenes.WEIGHTS @ values / 1e-2, rel=1e-7)
