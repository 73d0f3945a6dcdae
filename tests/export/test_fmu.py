"""FMUs against runs in Python: inputs, communication steps, states, instances, errors."""

import numpy as np
import pytest
from exported_models import VARIABLE, H, arm, pendulum, with_law
from slave import Slave

from sebody import InputError, Simulation
from sebody.export import export

pytest.importorskip("ziglang", reason="exports are linked by the package ziglang")
fmpy = pytest.importorskip("fmpy", reason="FMUs are read by the package fmpy")
STEPS = 60
INPUTS = ["push", "the support", "gravity.x"]


@pytest.fixture(scope="module", params=["3.0", "2.0"])
def made(request, tmp_path_factory):
    """The pendulum as an FMU, and the folder it is unzipped in."""
    folder = tmp_path_factory.mktemp("fmu")
    path = export(pendulum(), H, fmu=folder / "p.fmu", name="a pendulum", processor="native",
                  inputs=INPUTS, outputs=["bob.position", "pin.force", "pin.angle"],
                  fmi=request.param, t_end=1.0)
    return str(path), fmpy.extract(str(path), str(folder / "unzipped"))


def native(steps, h=H, tolerance=None, model=None):
    """The same in Python."""
    run = Simulation(model or pendulum(), h, tolerance=tolerance)
    found = []
    for k in range(steps):
        run.set_input("push", float(np.sin(0.1 * k)))
        run.run_to((k + 1) * h)
        found.append([*run.read("bob.position"), run.read("pin.force")[1]])
    return np.array(found)


def test_the_check_of_fmpy_has_nothing_to_say(made):
    from fmpy.validation import validate_fmu

    assert validate_fmu(made[0]) == []
    own = fmpy.read_model_description(made[0])
    kinds = {one.name: (one.causality, one.start) for one in own.modelVariables}
    assert kinds["push"] == ("input", "0.0") and kinds["the support"] == ("input", "0.0")
    assert kinds["gravity.x"] == ("parameter", "0.0") and kinds["pin.angle"][0] == "output"


def test_steps_are_those_of_a_run_in_python(made):
    found, own = Slave(*made).steps(0, STEPS), native(STEPS)
    assert found[:, :2].tobytes() == own[:, :2].tobytes()
    assert np.abs(found[:, 2] - own[:, 2]).max() < 1e-10 * np.abs(own[:, 2]).max()


def test_a_controller_outside_is_one_inside(made):
    """Feedback of an importer at every communication point, and the same as a controller."""
    slave, period = Slave(*made), 2 * H
    for k in range(STEPS // 2):
        angle, = slave.read("pin.angle")
        slave.put(push=-8.0 * angle + 0.3)
        slave.fmu.doStep(currentCommunicationPoint=k * period, communicationStepSize=period)
    model = pendulum()
    model.controller("loop", proportional, ["pin.angle"], ["push"], period)
    own = Simulation(model, H).run_to(STEPS * H).read("bob.position")
    found = np.array(slave.read("bob.position.x", "bob.position.y"))
    assert np.abs(found - own).max() < 1e-14


def proportional(t, y, x, u, parameters):
    u[0] = -8.0 * y[0] + 0.3


def test_fmpy_simulates_it(made):
    times = np.arange(STEPS + 1) * H
    signal = np.array([(t, np.sin(0.1 * k)) for k, t in enumerate(times)],
                      dtype=[("time", float), ("push", float)])
    found = fmpy.simulate_fmu(made[0], stop_time=STEPS * H, step_size=H, output_interval=H,
                              input=signal, output=["bob.position.y"])
    own = native(STEPS)[:, 1]
    # fmpy interpolates the signal, so it differs by rounding
    assert np.abs(found["bob.position.y"][1:] - own).max() < 1e-12


def test_states_instances_and_resets(made):
    whole = Slave(*made).steps(0, STEPS)
    one, other = Slave(*made), Slave(*made)
    one.steps(0, 20)
    get, put, to_bytes, _ = one.states
    state = get()
    kept = to_bytes(state)
    first = one.steps(20, STEPS)
    put(state)
    again = one.steps(20, STEPS)
    _, put_other, _, from_bytes = other.states
    put_other(from_bytes(kept))
    elsewhere = other.steps(20, STEPS)
    for found in (first, again, elsewhere):
        assert found.tobytes() == whole[20:].tobytes()
    one.fmu.reset()
    one.begin()
    assert one.steps(0, 10).tobytes() == whole[:10].tobytes()


def test_communication_steps_of_any_length(made):
    """Off the grid, too: the motion is that of the grid to the order of the scheme."""
    slave, t, points = Slave(*made), 0.0, []
    for k, length in enumerate([0.3 * H, 2.9 * H, 1.0 * H, 0.05 * H, 7.75 * H, 8.0 * H] * 3):
        slave.put(push=1.0 + k % 3)
        slave.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=length)
        t += length
        points.append(slave.read("time", "bob.position.x")[1])
    assert slave.read("time")[0] == pytest.approx(t, abs=1e-12)
    errors = []
    for h in (H / 20, H / 40):          # all points are on these grids
        run, t, own = Simulation(pendulum(), h), 0.0, []
        for k, length in enumerate([0.3 * H, 2.9 * H, 1.0 * H, 0.05 * H, 7.75 * H, 8.0 * H] * 3):
            run.set_input("push", 1.0 + k % 3)
            t += length
            own.append(run.run_to(t).read("bob.position")[0])
        errors.append(np.abs(np.array(points) - own).max())
    assert max(errors) < 20 * H**2 * 1e-2


def test_drives_are_set_by_their_accelerations(made):
    """The support with constant acceleration is a table of a parabola in a run in Python."""
    slave, a = Slave(*made), 0.7
    slave.put(the_support=a)
    for k in range(STEPS):
        slave.fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
    model = pendulum()
    block = model.nodes["cart"].position
    motion, = block.motions
    from sebody.model.time_functions import TimeFunction

    block.motions[0] = motion._replace(time_function=TimeFunction(pieces=((0.0, 0.0, a / 2),)))
    own = Simulation(model, H).run_to(STEPS * H).read("bob.position")
    assert np.abs(np.array(slave.read("bob.position.x", "bob.position.y")) - own).max() < 1e-12


def test_gravity_is_a_parameter(made):
    slave = Slave(*made, before=[("gravity.x", 2.5)])
    for k in range(STEPS):
        slave.fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
    model = pendulum()
    model.gravity((2.5, -9.81))
    own = Simulation(model, H).run_to(STEPS * H).read("bob.position")
    assert np.abs(np.array(slave.read("bob.position.x", "bob.position.y")) - own).max() < 1e-12


def test_errors_are_words(made):
    slave = Slave(*made)
    for call in (lambda: slave.set([99], [1.0]), lambda: slave.get([99]),
                 lambda: slave.put(push=np.nan),
                 lambda: slave.fmu.doStep(currentCommunicationPoint=5.0,
                                          communicationStepSize=H)):
        with pytest.raises(Exception, match="[fF]ailed|status"):
            call()
    assert len(slave.steps(0, 3)) == 3      # it goes on


def test_messages_come_by_the_callback(made):
    if fmpy.read_model_description(made[0]).fmiVersion != "3.0":
        pytest.skip("fmpy has its own logger for FMI 2.0")
    from fmpy.fmi3 import fmi3LogMessageCallback

    said = []
    slave = Slave(*made, log=lambda environment, status, category, message:
                  said.append((status, message.decode())))
    with pytest.raises(Exception):  # noqa: B017  (fmpy raises plain exceptions)
        slave.fmu.doStep(currentCommunicationPoint=5.0, communicationStepSize=H)
    assert said == [(3, "the communication point is not the time that the model has reached")]
    assert fmi3LogMessageCallback


def test_variable_steps_end_where_inputs_are_set(tmp_path):
    path = str(export(pendulum(), 5 * H, fmu=tmp_path / "v.fmu", inputs=["push"],
                      outputs=["bob.position", "pin.force"], processor="native",
                      tolerance=VARIABLE))
    slave = Slave(path, fmpy.extract(path, str(tmp_path / "unzipped")))
    found, own = slave.steps(0, 20, 5 * H), native(20, 5 * H, VARIABLE)
    assert found[:, :2].tobytes() == own[:, :2].tobytes()


def test_three_features_at_once(tmp_path):
    """The arm with controller, contact and functions; a table becomes an input."""
    path = str(export(arm(), H, fmu=tmp_path / "arm.fmu", inputs=["a pull", "loop.parameters.0"],
                      outputs=["the hand.position", "joint 1.force"], processor="native"))
    slave = Slave(path, fmpy.extract(path, str(tmp_path / "unzipped")),
                  before=[("loop.parameters.0", 9.0), ("a pull", 0.5)])
    for k in range(40):
        slave.fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
    model = arm()
    pull, = (load for load in model.loads if load.name == "a pull")
    from sebody.model.histories import time_function

    pull.time_function = time_function(0.5)
    model.controllers["loop"].parameters[0] = 9.0
    own = Simulation(model, H).run_to(40 * H).read("the hand.position")
    found = slave.read(*(f"the hand.position.{axis}" for axis in "xyz"))
    assert np.abs(np.array(found) - own).max() < 1e-9


def test_parameters_of_sampled_and_continuous_controllers(tmp_path):
    """The continuous one comes first: its parameters are not among those of samples."""
    def made():
        model = with_law()
        model.controllers = dict(reversed(model.controllers.items()))
        return model

    changes = {"loop.parameters.0": 9.0, "law.parameters.1": 4.5}
    path = str(export(made(), H, fmu=tmp_path / "law.fmu", inputs=list(changes),
                      outputs=["the hand.position", "law.states"], processor="native"))
    slave = Slave(path, fmpy.extract(path, str(tmp_path / "unzipped")), before=changes.items())
    for k in range(40):
        slave.fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
    found, model = slave.read("the hand.position.y", "law.states.0"), made()
    before = Simulation(made(), H).run_to(40 * H)
    model.controllers["loop"].parameters[0] = 9.0
    model.controllers["law"].parameters[1] = 4.5
    after = Simulation(model, H).run_to(40 * H)
    own, old = ([run.read("the hand.position")[1], run.read("law.states")[0]]
                for run in (after, before))
    assert np.abs(np.subtract(own, old)).min() > 1e-5
    assert found == pytest.approx(own, abs=1e-11)


def test_an_actuator_of_a_continuous_controller_is_no_input(tmp_path):
    said = "'motor 2' is what the continuous controller 'law' sets"
    with pytest.raises(InputError, match=said):
        export(with_law(), H, fmu=tmp_path / "x.fmu", inputs=["motor 2"])
    with pytest.raises(InputError, match=said):
        Simulation(with_law(), H).set_input("motor 2", 1.0)


def test_fmi_2_has_no_arm(tmp_path):
    with pytest.raises(InputError, match="FMI 2.0 has no folder for linux-aarch64"):
        export(pendulum(), H, fmu=tmp_path / "x.fmu", platforms=["linux-aarch64"], fmi="2.0")
