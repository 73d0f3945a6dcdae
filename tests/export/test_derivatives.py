"""Directional derivatives of FMUs against linear models, closed forms and differences."""

import re

import numpy as np
import pytest
from exported_models import SECTION, TURN, H, arm, pendulum
from slave import Slave

from sebody import Model, Simulation
from sebody.analysis import state_space
from sebody.export import export
from sebody.export.interface import with_inputs
from sebody.fem import straight_beam
from sebody.reduction import reduce

pytest.importorskip("ziglang", reason="exports are linked by the package ziglang")
fmpy = pytest.importorskip("fmpy", reason="FMUs are read by the package fmpy")
STEPS = 40
OF_ARM = ["the hand.acceleration", "the hand.position", "joint 1.force",
          "upper arm.the hand.moment"]
OF_PENDULUM = ["bob.acceleration", "pin.force", "bob.velocity"]


def slave(folder, model, fmi="3.0", log=None, **options):
    path = export(model, H, fmu=folder / "m.fmu", name="m", processor="native", fmi=fmi, **options)
    return Slave(str(path), fmpy.extract(str(path), str(folder / "unzipped")), log)


def flag(folder):
    """What the description says of directional derivatives; FMPy keeps that of FMI 2.0 alone."""
    text = (folder / "unzipped" / "modelDescription.xml").read_text()
    found, = re.findall(r' providesDirectionalDerivatives?="(\w+)"', text)
    return found


def matrix(one, outputs, inputs):
    """All derivatives, column by column."""
    return np.array([one.derivatives(outputs, [name], [1.0]) for name in inputs]).T


def components(one, names):
    return [name for name in one.names for own in names if name.startswith(f"{own}.")
            or name == own]


def test_of_a_flexible_arm_they_are_those_of_the_linear_model(tmp_path):
    """D of the state space in a state of fast motion, in any direction of two loads."""
    inputs = ["a wind", "a pull"]
    one = slave(tmp_path, arm(), inputs=inputs,
                outputs=[*OF_ARM, "a wind.power", "the hand.velocity"])
    assert flag(tmp_path) == "true"
    run = Simulation(with_inputs(arm(), inputs)[0], H)
    run.set_input("a wind", 1.5)
    run.set_input("a pull", -0.5)
    for k in range(STEPS):
        one.put(a_wind=1.5, a_pull=-0.5)
        one.fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
    run.run_to(STEPS * H)
    names = components(one, OF_ARM)
    before = one.read(*one.names)
    found = matrix(one, names, inputs)
    assert one.read(*one.names) == before           # nothing has changed, bit for bit
    expected = state_space(run, inputs, OF_ARM).D
    size = np.maximum(np.abs(expected).max(axis=1), 1e-3)[:, None]
    # 1e-4 apart, differences of the FMU have 1e4 roundings of forces of up to 1e3
    assert (np.abs(found - expected) < 1e-9 * size).all()
    velocity = one.read(*components(one, ["the hand.velocity"]))
    power, = one.derivatives(["a wind.power"], ["a wind"], [1.0])
    assert abs(power - velocity @ TURN[:, 1]) < 1e-9
    seed = [0.3, -2.0]
    along = one.derivatives(names, inputs, seed)
    assert np.allclose(along, found @ seed, rtol=1e-8, atol=1e-9 * np.abs(found).max())


@pytest.mark.parametrize("fmi", ["3.0", "2.0"])
def test_of_a_pendulum_they_are_exact(fmi, tmp_path):
    """Against Newton and Euler, and against differences of what the FMU itself gives."""
    one = slave(tmp_path, pendulum(), fmi, inputs=["push", "the support"],
                outputs=["bob.position", *OF_PENDULUM])
    assert flag(tmp_path) == "true"
    one.put(push=40.0, the_support=-3.0)
    for k in range(STEPS):
        one.fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
    names = components(one, OF_PENDULUM)
    found = matrix(one, names, ["push", "the support"])
    x, y = one.read("bob.position.x", "bob.position.y")
    # the support began at rest at the origin
    x += 1.5 * (STEPS * H)**2
    d, m, J = np.array([1.0, 0.5]), 1.2, 0.03       # a direction is no unit vector
    inertia = J + m * (x * x + y * y)
    spins = np.array([x * d[1] - y * d[0], m * y]) / inertia        # accelerations by push, support
    bob = np.outer([-y, x], spins) + np.array([[0.0, 1.0], [0.0, 0.0]])
    reaction = m * bob - np.array([[d[0], 0.0], [d[1], 0.0]])
    expected = np.vstack([bob, -reaction if found[2] @ reaction[0] < 0.0 else reaction,
                          np.zeros((2, 2))])
    assert np.abs(found - expected).max() < 1e-9
    t, values = STEPS * H, []
    for push in (41.0, 39.0):
        one.put(push=push)
        one.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=0.0)
        values.append(one.read(*names))
    # accelerations are affine functions of forces: any difference will do
    assert np.abs(found[:, 0] - (np.array(values[0]) - values[1]) / 2.0).max() < 1e-9


def test_what_has_none_says_so(tmp_path):
    """A motion without mass, and variables that are no inputs or outputs."""
    (start, end), model = (TURN @ (0.1, 0.2, 0.3), TURN @ (0.9, 0.2, 0.4)), Model()
    body = reduce(straight_beam(start, end, SECTION, elements=6), [(0, "full"), (6, "full")], 4,
                  "macneal")
    model.superelement("bar", body, (model.node("a", start), model.node("b", end)),
                       inertia="rigid_part", stiffening=False)
    model.fix("a")
    model.force("b", (0.3, -1.0, 0.8), 1.0, name="pull")
    said = []

    def log(environment, status, category, message):
        said.append(message.decode())
    (tmp_path / "bar").mkdir()
    one = slave(tmp_path / "bar", model, inputs=["pull"], outputs=["b.acceleration"], log=log)
    assert flag(tmp_path / "bar") == "false"
    with pytest.raises(Exception, match="fmi3GetDirectionalDerivative"):
        one.derivatives(["b.acceleration.x"], ["pull"], [1.0])
    other = slave(tmp_path, pendulum(), inputs=["push"], outputs=["bob.acceleration"], log=log)
    for unknown, known, seed in (("push", "push", 1.0), ("bob.acceleration.x", "time", 1.0),
                                 ("bob.acceleration.x", "push", np.inf)):
        with pytest.raises(Exception, match="fmi3GetDirectionalDerivative"):
            other.derivatives([unknown], [known], [seed])
    assert [one.split(":")[0] for one in said] == [
        "there are no directional derivatives, because some motions have no mass",
        "derivatives of a variable that is no output",
        "derivatives by a variable that is no input or parameter", "a seed is not finite"]
