"""Whatever users import says in words what is wrong with any argument of a wrong kind."""

import warnings

import numpy as np
import pytest
from malformed.public_calls import CALLS, JUNK, junk

from sebody import Model, Result, SebodyError, Simulation

EACH = 6        # one of so many values is tried at each argument, another one at the next
NUMBERS = int, float, np.number
# arguments that may be None beside those that are None in the right calls
OPTIONAL = {"threads", "count", "speed", "names", "step", "up", "point", "damping", "invariants",
            "recovery", "provenance", "elements", "stiffening", "output", "fixed"}
LISTS = list, tuple, dict, set, np.ndarray


def alike(value, right):
    """Whether a value is of the kind of a right one, so that it may be right, too."""
    if isinstance(value, Result) and isinstance(right, Simulation | list):     # it lists its names
        return True
    if isinstance(value, Model) and isinstance(right, Simulation):      # for its equilibrium
        return True
    for kinds in (bool, NUMBERS, str, LISTS):
        if isinstance(right, kinds) or isinstance(value, bool):
            return isinstance(value, kinds) and isinstance(right, kinds)
    return isinstance(value, type(right)) or callable(right) and callable(value)


def tried(name):
    """Arguments and names of values."""
    arguments = list(CALLS[name].arguments())
    for k, argument in enumerate(arguments):
        for j, one in enumerate(JUNK):
            if (j + k + len(name)) % EACH == 0:
                yield argument, one


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plt = pytest.importorskip("matplotlib.pyplot")
    yield
    plt.close("all")


@pytest.mark.parametrize("name", CALLS)
def test_arguments_of_wrong_kinds(name):
    call = CALLS[name]
    warnings.simplefilter("ignore")
    for argument, one in tried(name):
        right, value = dict(call.arguments()), junk(one)
        try:
            call.function(**{**right, argument: value})
        except SebodyError as error:
            said = str(error)
            assert len(said) > 15 and "\n" not in said.strip()[:40], (argument, one, said)
            continue
        assert (one == "none" and argument in OPTIONAL or right[argument] is None
                or alike(value, right[argument])), (
            f"{name}: {argument} of kind {one!r} is accepted in silence")


def test_there_are_enough():
    assert sum(len(list(tried(name))) for name in CALLS) > 1200
