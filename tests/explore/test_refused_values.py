"""Values that builders refuse: of ensembles, sweeps and gradients run by run."""

import re

import numpy as np
import pytest

from sebody import InputError, Model, plane
from sebody.analysis import Ensemble, ValueAndGradient, final, gradients
from sebody.cli.entry import main
from sebody.control import lookup, pid
from sebody.explore.ensembles import ensemble
from sebody.fem import rectangle
from sebody.parameters import table

H, END = 0.005, 0.1
OUTPUTS = {"angle": final("pin.rate")}


def arm() -> Model:
    """An arm with two stops, friction and a floor; a slider with a stop; a pair of gears."""
    model = Model(planar=True)
    hub, tip = model.node("hub", (0.3, -0.2)), model.node("tip", (0.3 + 0.6, -0.2 + 0.8))
    model.rigid_body("arm", hub, 2.0, 0.4)
    model.rigid_body("hand", tip, 0.5, 0.1)
    model.revolute(hub, name="pin")
    model.spherical(tip, to=model.attach("end", tip.point, hub), name="wrist")
    model.torque(hub, 1.5, [(0, 0), (0.1, 1)], name="torque")
    model.stop("pin", lower=-0.4, upper=0.5, stiffness=1e4, name="buffer")
    model.friction("pin", coefficient=0.1, static=0.15, radius=0.1, preload=2.0, name="rub")
    model.contact(tip, on=plane((0.2, 1.0), point=(0.0, -1.0)), radius=0.1, stiffness=1e4,
                  name="floor")
    cart = model.node("cart", (2.0, 0.0))
    model.rigid_body("box", cart, 1.0, 0.1)
    model.prismatic(cart, (0.6, 0.8), name="rail")
    model.stop("rail", lower=-0.3, upper=0.2, stiffness=1e4, name="end stop")
    model.stop(("hub", "cart"), lower=1.0, stiffness=1e4, name="rope")
    for name, x in (("first", 4.0), ("second", 5.0)):
        model.rigid_body(f"{name} wheel", model.node(name, (x, 0.0)), 1.0, 0.2)
        model.revolute(name, name=f"{name} pin")
    model.gear("first pin", "second pin", ratio=-3.0, stiffness=1e3, name="teeth")
    return model


# by parameters what is refused among good values, and the reason
REFUSED = [
    ({"buffer.lower": [-0.4, -0.1], "buffer.upper": [0.5, -0.2]}, "which leaves no room"),
    ({"buffer.upper": [0.5, -0.1]}, "starts at 0, beyond the limits -0.4 and -0.1"),
    ({"end stop.lower": [-0.1, 0.1]}, "starts at .*, beyond the limits 0.1 and 0.2"),
    ({"rope.lower": [1.0, 1.9]}, "starts at 1.7[0-9]*, beyond the limits 1.9 and inf"),
    ({"teeth.ratio": [-3.0, 0.0]}, "ratio is 0: give the turns of the first"),
    ({"rub.static": [0.15, 0.05]}, "static is 0.05, below the coefficient of sliding 0.1"),
    ({"rub.radius": [0.1, 0.0]}, "'rub': radius"),
    ({"buffer.exponent": [1.5, 0.2]}, "'buffer': exponent"),
    ({"floor.exponent": [1.5, 0.2]}, "'floor': exponent"),
    ({"floor.stiffness": [1e4, 0.0]}, "'floor': stiffness"),
    ({"floor.radius": [0.1, 3.0]}, "it starts .* deep in the plane"),
    ({"floor.restitution": [0.5, 0.01], "floor.exponent": [1.0, 0.9]}, "'floor': exponent"),
    ({"hub.rotation": [[0.0], [0.7]]}, "it starts at 0.7, beyond the limits -0.4 and 0.5")]


@pytest.mark.parametrize("in_lanes", [False, True])
@pytest.mark.parametrize("values, why", REFUSED, ids=[next(iter(own)) for own, _ in REFUSED])
def test_a_run_of_an_ensemble_fails_with_the_reason_of_the_builder(values, why, in_lanes,
                                                                   monkeypatch):
    """All others are as without it."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0 if in_lanes else np.inf)
    many = Ensemble(arm(), H)
    order = [0, 1, 0, 0, 0, 0, 0, 0, 0, 0]
    done = many.run({name: np.array(own, dtype=float)[order] for name, own in values.items()}, END,
                    OUTPUTS)
    assert list(done.failures) == [1]
    with pytest.raises(AssertionError, match=why):
        raise AssertionError(done.failures[1])
    assert np.isnan(done.values["angle"][1])
    rest = many.run({name: np.array(own, dtype=float)[[0] * 9] for name, own in values.items()},
                    END, OUTPUTS)
    assert np.array_equal(np.delete(done.values["angle"], 1, axis=0), rest.values["angle"])


def test_gradients_and_functions_refuse_them():
    model = arm()
    f = ValueAndGradient(model, H, END, {"x": final("pin.rate")}, ["buffer.lower", "buffer.upper"])
    with pytest.raises(InputError, match="which leaves no room"):
        f([-0.1, -0.2])
    found = gradients(model, H, END, {"x": final("pin.rate")}, ["torque.amplitude"],
                      {"teeth.ratio": [-3.0, 0.0], "torque.amplitude": [1.0, 2.0]})
    assert list(found.failures) == [1]
    assert "ratio is 0" in found.failures[1]


SCENE = '''
from test_refused_values import arm
from sebody.scenes.scene import Scene

def build() -> Scene:
    """An arm."""
    return Scene("arm", "with stops", arm(), h=0.005, t_end=0.1, base="hub")
'''


def test_in_a_sweep_others_go_on(tmp_path, capsys, monkeypatch):
    monkeypatch.syspath_prepend(__file__.rpartition("/")[0])
    (tmp_path / "scene.py").write_text(SCENE)
    assert main(["sweep", str(tmp_path / "scene.py"), "--vary", "buffer.upper=0.5,-0.1,0.4",
                 "--keep", "final(pin.rate)"]) == 0
    said = capsys.readouterr().out
    assert "3 of 3 runs done, 1 failed" in said
    assert "1 x 'buffer': it starts at 0, beyond the limits -0.4 and -0.1" in said


@pytest.mark.parametrize("law, place, wrong, message", [
    (pid(2.0, kd=0.1), 4, 0.0, "pid: filter is 0"),
    (lookup([-1.0, 0.0, 1.0], [1.0, 0.0, -1.0]), 1, 2.0, "lookup: points .* ascend")])
@pytest.mark.parametrize("period", [None, 0.01])
def test_parameters_of_laws_are_those_that_their_builders_take(law, place, wrong, message, period):
    model = arm()
    model.actuator("motor", joint="pin")
    model.controller("loop", law, ["pin.angle"], ["motor"], period)
    numbers = model.controllers["loop"].parameters
    finite = numbers[np.isfinite(numbers)]
    values = np.tile(finite, (3, 1))
    values[1, place - (period is None and message[0] == "p")] = wrong
    found = Ensemble(model, H).run({"loop.parameters": values}, END, OUTPUTS)
    assert set(found.failures) == {1} and re.search(message, found.failures[1])


def test_a_fault_of_a_function_is_the_reason_of_the_runs_that_meet_it():
    """A table of torques that ends at 0.02: no sentence on matrices, or on Newton's iteration."""
    table = np.array([1.0, 2.0, 1.5])

    def torque(t: float) -> float:
        return table[int(t * 100.0) + 1]

    model = Model()
    model.rigid_body("leaf", model.node("a", (0.1, 0.2, 0.3)), 1.0, (1.0, 2.0, 3.0))
    model.revolute("a", (0.2, 0.3, 1.0), name="hinge")
    model.torque("a", (0.2, 0.3, 1.0), torque, name="push")
    outcome = Ensemble(model, 0.01).run({"leaf.mass": [1.0, 1.2]}, 0.1, {"angle": "hinge.angle"})
    assert len(outcome.failures) == 2
    for reason in outcome.failures.values():
        assert re.match("stopped at t = 0.0[12][0-9]*: the function of 'push' raised IndexError: "
                        "index 3 is out of bounds .*: correct it", reason), reason


def test_a_model_is_as_before_after_values_were_tried():
    """Values that builders refuse are tried on the model itself, run by run."""
    model = arm()
    found = table.varied({name: table.parameter(model, name) for name in (
        "rub.coefficient", "buffer.lower")})
    before = {name: float(model.element(name.partition(".")[0]).constants[
        name.partition(".")[2]]) for name in found}
    reasons = table.refused(model, found, {"rub.coefficient": [0.1, -1.0], "buffer.lower": [
        -0.4, 0.9]}, 2)
    assert list(reasons) == [1]
    assert before == {name: float(model.element(name.partition(".")[0]).constants[
        name.partition(".")[2]]) for name in found}


def test_whole_bodies_are_set_before_their_factors():
    """Factors are those of the body that is there, in whatever order both are named."""
    model = Model(planar=True)
    ends = model.node("a", (0.0, 0.0)), model.node("b", (1.0, 0.0))
    model.beam("beam", ends, rectangle(0.01, 0.02, 7e10, 0.3, 2700.0), 4, 1, 2)
    names = "beam.stiffness", "beam.reduced"
    for order in (names, names[::-1]):
        found = table.varied({name: table.parameter(model, name) for name in order})
        assert list(found)[0] == "beam.reduced"


@pytest.mark.parametrize("factor", [0.0, -1.0])
def test_a_factor_of_nothing_is_refused(factor):
    """A bound that is not reached itself."""
    with pytest.raises(InputError, match="above 0"):
        Ensemble(arm(), H).run({"arm.mass": [1.0, factor]}, END, OUTPUTS)
