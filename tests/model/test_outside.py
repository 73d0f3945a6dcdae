"""Values that users' functions read from outside: compiled in, and never old without a word."""

import functools
import math
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from numba import njit

from sebody import InputError, Model, Simulation, simulate, with_corners
from sebody.analysis import Ensemble, equilibrium
from sebody.model.histories import time_function
from sebody.runs.fingerprint import described

gain = 2.0
pair = (2.0, (3.0, 4))
field = np.array([2.0, 3.0])
bin = 2.0       # named like a builtin
settings = ModuleType("settings")
settings.gain = 2.0


def helper(t):
    return gain * t


@njit
def compiled_helper(t):
    return gain * t


assert compiled_helper(1.0) == 2.0      # compiled with the first value


def enclosed():
    """A function that reads an enclosing variable, and one that changes it."""
    level = 2.0

    def load(t):
        return level * t

    def change():
        nonlocal level
        level = 5.0
    return load, change


class Entries(dict):
    """Entries of an array, for `monkeypatch.setitem`."""

    def __init__(self, array):
        super().__init__(enumerate(array.tolist()))
        self.array = array

    def __setitem__(self, k, value):
        self.array[k] = value


ENCLOSED, CHANGE = enclosed()
READERS = {     # a function, how what it reads is changed, what is said
    "number": (lambda t: gain * t, lambda m: m.setitem(globals(), "gain", 5.0),
               "reads gain, which was 2.0 then and is 5.0 now: "),
    "nested tuple": (lambda t: pair[1][0] * t,
                     lambda m: m.setitem(globals(), "pair", (2.0, (3.5, 4))),
                     "reads pair, which was (2.0, (3.0, 4)) then and is (2.0, (3.5, 4)) now: "),
    "kind of number": (lambda t: pair[1][1] * t,
                       lambda m: m.setitem(globals(), "pair", (2.0, (3.0, 4.0))), "reads pair, "),
    "entry of an array": (lambda t: field[1] * t, lambda m: m.setitem(Entries(field), 1, 7.0),
                          "reads field, which was [2.0, 3.0] then and is [2.0, 7.0] now: "),
    "other array": (lambda t: field[1] * t,
                    lambda m: m.setitem(globals(), "field", np.ones(3)), "reads field, "),
    "in a module": (lambda t: settings.gain * t, lambda m: m.setattr(settings, "gain", 5.0),
                    "reads settings.gain, which was 2.0 then and is 5.0 now: "),
    "in an inner function": (lambda t: max([gain * x for x in (t, -t)]),
                             lambda m: m.setitem(globals(), "gain", 5.0), "reads gain, which "),
    "of a helper": (lambda t: helper(t), lambda m: m.setitem(globals(), "gain", 5.0),
                    "reads gain in helper(), which was 2.0 then and is 5.0 now: "),
    "of a compiled helper": (lambda t: compiled_helper(t),
                             lambda m: m.setitem(globals(), "gain", 5.0),
                             "reads gain in compiled_helper(), which was 2.0 then and is "),
    "helper": (lambda t: helper(t), lambda m: m.setitem(globals(), "helper", lambda t: 3 * t),
               "reads helper, which has been defined anew since: "),
    "deleted": (lambda t: gain * t, lambda m: m.delitem(globals(), "gain"),
                "reads gain, which no longer exists: "),
    "named like a builtin": (lambda t: bin * t, lambda m: m.setitem(globals(), "bin", 5.0),
                             "reads bin, which was 2.0 then and is 5.0 now: "),
    "enclosing variable": (ENCLOSED, lambda m: CHANGE(),
                           "reads level, which was 2.0 then and is 5.0 now: "),
}


def pushed(function) -> Model:
    """A mass of two on a line, pushed."""
    model = Model(planar=True)
    model.point_mass("body", model.node("ball", (0.0, 0.0), keeps="translation"), 2.0)
    model.force("ball", (1.0, 0.0), function, name="push")
    return model


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")      # runs of two steps
@pytest.mark.parametrize("kind", READERS)
def test_a_value_that_has_changed_is_refused(kind, monkeypatch):
    """Whatever begins a run, or goes on with one; put back, it runs as before."""
    function, change, said = READERS[kind]
    model = pushed(function)
    begun = Simulation(model, 0.1).run_to(0.2)
    ensemble = Ensemble(model, 0.1)
    with monkeypatch.context() as patch:
        change(patch)
        for again in (lambda: simulate(model, 0.1, 0.2), lambda: begun.run_to(0.4),
                      lambda: ensemble.run({}, 0.2, {"x": "ball.position"}),
                      lambda: simulate(pushed(model.loads[0].time_function), 0.1, 0.2)):
            with pytest.raises(InputError) as caught:
                again()
            assert str(caught.value).startswith(f"the function of 'push' {said}")
            assert "make the load or drive again, or give each function its own value by a " \
                   "default argument, as in lambda t, a=a: a * t" in str(caught.value)
        if kind != "deleted":
            assert simulate(pushed(function), 0.1, 0.2).t[-1] == pytest.approx(0.2)
    if kind != "enclosing variable":
        again = begun.run_to(0.4).result()["ball.position"]
        assert np.array_equal(again, simulate(model, 0.1, 0.4)["ball.position"])


def test_a_helper_that_was_compiled_earlier_is_compiled_with_what_it_reads_now(monkeypatch):
    monkeypatch.setitem(globals(), "gain", 5.0)
    assert time_function(lambda t: compiled_helper(t)).at(2.0)[0] == 10.0
    assert time_function(compiled_helper).at(2.0)[0] == 10.0


def test_drives_and_forces_of_users_are_watched_too(monkeypatch):
    model = pushed(1.0)
    model.move(model.node("driven", (1.0, 0.0), keeps="translation"), (0, 1),
               lambda t: gain * math.sin(t), name="up")
    model.user_force("drag", ["ball"], drag)
    simulate(model, 0.1, 0.2)
    with monkeypatch.context() as patch:
        patch.setitem(globals(), "gain", 5.0)
        with pytest.raises(InputError, match="the function of 'up' reads gain, which was 2.0"):
            simulate(model, 0.1, 0.2)
    with monkeypatch.context() as patch:
        patch.setitem(Entries(field), 0, 5.0)
        with pytest.raises(InputError, match="user force 'drag' reads field, which was"):
            equilibrium(model)
    corners = pushed(with_corners(lambda t: gain * t, [0.1]))
    monkeypatch.setitem(globals(), "gain", 5.0)
    with pytest.raises(InputError, match="the function of 'push' reads gain"):
        simulate(corners, 0.1, 0.2)


def drag(t, x, v, force):
    force[0] = -field[0] * v[0]


def test_functions_made_in_a_loop_do_not_take_its_last_value():
    """They were compiled with different values of one variable, which Python would read later."""
    def loads(make):
        model = Model(planar=True)
        for k in range(3):
            model.point_mass(f"body {k}", model.node(f"n{k}", (k, 0.0), keeps="translation"), 2.0)
        make(model)
        return model

    def by_variable(model):
        for k in range(3):
            model.force(f"n{k}", (0.0, 1.0), lambda t: k * t)   # noqa: B023

    def by_default(model):
        for k in range(3):
            model.force(f"n{k}", (0.0, 1.0), lambda t, k=k: k * t)
    with pytest.raises(InputError, match="'force on n0.position' reads k, which was 0 then and is "
                                         "2 now: .* as in lambda t, a=a"):
        simulate(loads(by_variable), 0.1, 0.2)
    result = simulate(loads(by_default), 0.1, 0.3)
    heights = np.array([result[f"n{k}.position"][-1, 1] for k in range(3)])
    assert heights[2] == pytest.approx(2 * heights[1])
    assert heights[0] == 0.0 < heights[1]


def last(t, /, a=3.0, *, b=2, c=(1.0, 2.0)):
    return a * t + b * c[1]


@pytest.mark.parametrize("function", [
    lambda t, a=2.0: a * t, lambda t, a=field: a[1] * t, lambda t, a=pair: a[1][1] * t, last,
    lambda t, f=helper: f(t), lambda t, *, a=2.0: a * t, math.sin, np.cos, njit(last),
    lambda t, table=((0.0, 1.0), (2.0, 5.0)): table[1][1] * t])
def test_default_arguments_are_values_of_the_function(function):
    called = getattr(function, "py_func", function)
    assert time_function(function).at(1.5)[0] == pytest.approx(called(1.5), rel=1e-15)


def test_default_arguments_of_forces():
    def push(t, x, v, force, k=3.0, *, factors=field):
        force[0] = k * factors[1] * t

    model = pushed(0.0)
    model.user_force("own", ["ball"], push)
    same = pushed(lambda t: 9.0 * t)
    found, expected = (simulate(one, 0.01, 1.0)["ball.position"] for one in (model, same))
    assert found == pytest.approx(expected, abs=1e-12) and found[-1, 0] > 0.7


def test_an_array_of_a_default_argument_may_not_change(monkeypatch):
    model = pushed(lambda t, a=field: a[1] * t)
    monkeypatch.setitem(Entries(field), 1, 4.0)
    with pytest.raises(InputError, match=r"reads a, which was \[2.0, 3.0\] then"):
        simulate(model, 0.1, 0.2)


rows, table, things, box = [1.0, 2.0], {"a": 2.0}, {1.0, 2.0}, SimpleNamespace(a=2.0)
settings.double = lambda t: 2 * t


class Constants:
    gain = 2.0

    def load(self, t):
        return t

    def __call__(self, t):
        return t


own = Constants()


@pytest.mark.parametrize("function, said", [
    (lambda t: rows[0] * t, "'<lambda>' reads rows, a list, which may change: make it a tuple, or "
                            "an array, rows = numpy.array(rows)"),
    (lambda t: np.interp(t, rows, rows), "'<lambda>' reads rows, a list, which may change: "),
    (lambda t, a=[1.0]: a[0], "'<lambda>' reads a, a list, which may change: "),    # noqa: B006
    (lambda t: helper_of_rows(t), "'<lambda>' reads rows in helper_of_rows(), a list, which may "),
    (lambda t: len(things) * t, "'<lambda>' reads things, a set, which may change: "),
    (lambda t: table["a"] * t, "'<lambda>' reads table, a dict, which may change: read it before, "
                               "as in value = table[...], and use the value in the function"),
    (lambda t: box.a * t, "'<lambda>' reads box.a, which may change: read it before, as in "
                          "a = box.a, and use a in the function"),
    (lambda t: own.gain * t, "'<lambda>' reads own.gain, which may change: "),
    (lambda t: Constants.gain * t, "'<lambda>' reads Constants.gain, which may change: "),
    (lambda t: settings.double(t), "'<lambda>' calls settings.double: import it by its name, from "
                                   "settings import double"),
    (lambda t: nowhere * t, "'<lambda>' reads nowhere, which does not exist: "),     # noqa: F821
    (own.load, "is <bound method Constants.load of <"),
    (own, "is <tests.model.test_outside.Constants"),
    (functools.partial(helper), "is functools.partial(<function helper"),
    (lambda: 1.0, "'<lambda>' has the arguments (): give a function of (t); further "),
    (lambda t, x: t, "'<lambda>' has the arguments (t, x): give a function of (t); further "
                     "arguments need defaults"),
    (lambda *t: 1.0, "'<lambda>' has the arguments (): give a function of (t)"),
    (lambda t: "text", "'<lambda>' cannot be compiled: use only arithmetic, math and numpy in "),
    (lambda t: print(t) + t, "'<lambda>' cannot be compiled: use only arithmetic, math and numpy"),
])
def test_what_cannot_be_compiled_in_is_refused_in_words(function, said):
    with pytest.raises(InputError) as caught:
        time_function(function)
    message = str(caught.value)
    assert message.startswith(f"time function of a load {said}")
    assert "\n" not in message and len(message) < 400 and "nopython" not in message


def helper_of_rows(t):
    return rows[0] * t


def test_forces_are_refused_likewise():
    for function, said in ((lambda t, x, v, force: force.fill(rows[0]),
                            "user force 'own' reads rows, a list, which may change: "),
                           (lambda t, x: x, "user force 'own' has the arguments (t, x):"
                                            " give a function of (t, x, v, force); ")):
        with pytest.raises(InputError) as caught:
            pushed(1.0).user_force("own", ["ball"], function)
        assert str(caught.value).startswith(said)


def test_a_function_is_known_by_the_library_function_it_calls():
    assert described(time_function(math.sin).functions[0].function) != described(
        time_function(math.cos).functions[0].function)
    assert described(lambda t: settings.gain) == described(lambda t: settings.gain)
