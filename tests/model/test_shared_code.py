"""Users' functions of the same code and values share machine code, and no others do."""

import math

import numpy as np
import pytest
from numba import njit

from sebody import InputError, Model, simulate
from sebody.control import pid
from sebody.model.histories import time_function
from sebody.model.time_functions import TimeFunction


def reading(value):
    return lambda t: value * t


def calling(helper):
    return lambda t: helper(t)


def with_default(value):
    return lambda t, a=value: a * t


def entry(values):
    return lambda t: values[1] * t


def of_two(first, second):
    """What calls two functions of one code, each with a value of its own."""
    one, other = reading(first), reading(second)
    return lambda t: one(t) + 10.0 * other(t)


def dividing(t):
    return 1.0 / t


fast, plain = njit(error_model="numpy")(dividing), njit(dividing)
POINTS = np.array([1.0, 2.0])


def shared(function: TimeFunction):
    return function.functions[0].shared


@pytest.mark.parametrize("make, value", [
    (reading, 2.0), (with_default, 3), (entry, POINTS), (entry, (1.0, 2.0)), (calling, math.sin),
    (calling, fast), (calling, reading(2.0))])
def test_equal_functions_share_machine_code(make, value):
    one, other = time_function(make(value)), time_function(make(value))
    assert shared(one) is shared(other)
    assert one.functions[0].address != other.functions[0].address
    assert one.at(0.5)[0] == other.at(0.5)[0] == make(value)(0.5)


@pytest.mark.parametrize("one, other", [
    (reading(2.0), reading(3.0)), (reading(0.0), reading(-0.0)), (reading(1), reading(True)),
    (reading(1), reading(1.0)), (with_default(2.0), with_default(2.5)),
    (entry(POINTS), entry(2 * POINTS)), (entry(POINTS), entry((1.0, 2.0))),
    (calling(math.sin), calling(math.cos)),
    (calling(reading(2.0)), calling(reading(4.0))), (of_two(1.0, 2.0), of_two(1.0, 3.0)),
    (of_two(1.0, 2.0), of_two(2.0, 2.0)), (calling(fast), calling(plain)),
    (lambda t: POINTS[0] * t, lambda t: POINTS[1] * t)])
def test_functions_of_other_code_or_values_do_not(one, other):
    first, second = time_function(one), time_function(other)
    assert shared(first) is not shared(second)
    for made, function in ((first, one), (second, other)):
        value = made.at(-0.5)[0]
        assert value == function(-0.5) and math.copysign(1, value) == math.copysign(
            1, function(-0.5))


def test_a_helper_with_the_name_of_a_builtin_is_read_like_any_other():
    made = []
    for factor in (2.0, 3.0):
        scope = {"abs": reading(factor)}
        exec("def load(t):\n    return abs(t)", scope)
        made.append(time_function(scope["load"]))
    assert [one.at(-1.0)[0] for one in made] == [-2.0, -3.0]


def test_each_controller_has_faults_of_its_own():
    """Two by one law, of which the second gets what makes it infinite."""
    model = Model(planar=True)
    for name in ("one", "other"):
        model.point_mass(name, model.node(f"n {name}", (0.0, 0.0), keeps="translation"), 1.0)
        model.actuator(f"motor {name}", node=f"n {name}", direction=(1.0, 0.0))
    for name, gain in (("one", 1.0), ("other", 1e308)):
        model.controller(f"loop {name}", pid(gain, reference=1e3), [f"n {name}.position.x"],
                         [f"motor {name}"], 0.1)
    one, other = (model.controllers[f"loop {name}"].function for name in ("one", "other"))
    assert one.shared is other.shared
    with pytest.raises(InputError, match="the run cannot begin: controller 'loop other' gave u "
                       "= .*inf"):
        simulate(model, 0.1, 1.0)
