"""Gradients of many runs in threads."""

import differentiated
import numpy as np
import pytest

from sebody import InputError, LimitWarning, Model
from sebody.analysis import final, gradient, gradients, rms
from sebody.runs.schemes import generalized_alpha

H, T_END = 0.01, 0.2
OBJECTIVES = {"tip": final("tip.position"), "shake": rms("tip.velocity.y")}
PARAMETERS = ["gravity.y", "spring.stiffness"]
GRAVITY = np.array([[0.3, -9.0, 2.0], [-4.0, 1.0, 0.5], [8.0, 0.0, -3.0], [0.0, 0.0, 9.81]])
AMPLITUDES = np.array([0.5, -1.5, 2.0, 1.0])
VALUES = {"gravity": GRAVITY, "torque.amplitude": AMPLITUDES}


@pytest.fixture(scope="module")
def found():
    return gradients(differentiated.hinged(), H, T_END, OBJECTIVES, PARAMETERS, VALUES, threads=1)


def built(gravity: np.ndarray, amplitude: float) -> Model:
    """The scene of `differentiated.hinged`, with other numbers from the begin."""
    model = differentiated.hinged()
    model.gravity(gravity)
    torque = next(one for one in model.loads if one.name == "torque")
    model.loads.remove(torque)
    model.torque("base", 3.0 * amplitude * differentiated.Z,
                 [(0, 0), (0.1, 1), (0.3, -1), (0.5, 0.2)], name="torque")
    return model


def test_each_run_has_the_gradient_of_a_model_built_with_its_numbers(found):
    assert found.rows == ("tip[0]", "tip[1]", "tip[2]", "shake")
    assert found.columns == tuple(PARAMETERS)
    for run in (1,):
        alone = gradient(built(GRAVITY[run], AMPLITUDES[run]), H, T_END, OBJECTIVES, PARAMETERS,
                         mode="forward")
        assert np.abs(found.value[run] - alone.value).max() < 1e-11 * np.abs(alone.value).max()
        # rows by their largest entry; the runs and both sweeps converge to 1e-10
        off = np.abs(found.matrix[run] - alone.matrix).max(axis=1)
        assert (off < 1e-7 * np.abs(alone.matrix).max(axis=1)).all()


def test_threads_change_no_bit(found):
    model = differentiated.hinged()
    before = repr(model)
    other = gradients(model, H, T_END, OBJECTIVES, PARAMETERS, VALUES, threads=3)
    assert np.array_equal(other.value, found.value) and np.array_equal(other.matrix, found.matrix)
    assert np.array_equal(other.growth, found.growth) and repr(model) == before
    last = gradients(model, H, T_END, OBJECTIVES, PARAMETERS,
                     {name: values[2:] for name, values in VALUES.items()}, threads=2)
    assert np.array_equal(last.matrix, found.matrix[2:])
    assert np.array_equal(found[2].of("tip", "spring.stiffness"), found.matrix[2, :3, 1:])


def test_a_run_that_fails_keeps_its_reason(found):
    values = VALUES | {"torque.amplitude": np.array([0.5, 1e12, 2.0, 1.0])}
    many = gradients(differentiated.hinged(), H, T_END, OBJECTIVES, PARAMETERS, values, threads=2)
    assert list(many.failures) == [1] and "t = " in many.failures[1]
    assert "kept" not in many.failures[1]       # of a gradient nothing is
    assert np.isnan(many.value[1]).all() and np.isnan(many.matrix[1]).all()
    assert np.array_equal(many.matrix[2:], found.matrix[2:])
    with pytest.raises(InputError, match=r"run 1 has no gradient: .*t = "):
        many[1]
    assert "1 failed" in repr(many)


@pytest.mark.parametrize(("values", "words"), [
    ({"gravity": GRAVITY, "torque.amplitude": AMPLITUDES[:2]}, "different numbers of values"),
    ({"beam.reduced": [differentiated.slender()]},
     "values of 'beam.reduced' are whole bodies: give numbers"),
    ({}, "give a dict of names and arrays"),
    ({"gravity": np.empty((0, 3))}, "'gravity' has no values: give one for each run")])
def test_refused(values, words):
    with pytest.raises(InputError, match=words):
        gradients(differentiated.hinged(), H, T_END, OBJECTIVES, PARAMETERS, values)


def test_index_2_is_differentiated_with_one_warning_that_names_the_line_of_the_caller():
    scheme = generalized_alpha(tolerance=1e-10, index=2)
    with pytest.warns(LimitWarning, match="index 2") as said:
        many = gradients(differentiated.hinged(), H, 0.05, OBJECTIVES, PARAMETERS,
                         {name: values[:2] for name, values in VALUES.items()}, scheme=scheme,
                         threads=2)
    assert [one.filename for one in said] == [__file__]
    with pytest.warns(LimitWarning):
        alone = gradient(built(GRAVITY[1], AMPLITUDES[1]), H, 0.05, OBJECTIVES, PARAMETERS,
                         scheme=scheme)
    off = np.abs(many.matrix[1] - alone.matrix).max(axis=1)
    assert (off < 1e-7 * np.abs(alone.matrix).max(axis=1)).all()
