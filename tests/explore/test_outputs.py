"""What ensembles keep of a history that comes in pieces, and what advice compares, in closed form.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody.explore.advice.indicators.activity import QUIET, activity
from sebody.explore.advice.measures import Measure, lengths
from sebody.explore.advice.quantities import Values, difference, sizes_of
from sebody.runs.outputs import Fold, Output

T = np.cumsum(np.random.default_rng(2).uniform(0.1, 0.3, 40))
V = np.random.default_rng(3).normal(size=(40, 2, 3))
HALVES = (V[1:] + V[:-1]) / 2
EXPECTED = {"maximum": V.max(axis=0), "minimum": V.min(axis=0), "final": V[-1],
            "integral": (np.diff(T)[:, None, None] * HALVES).sum(axis=0),
            "rms": np.sqrt((np.diff(T)[:, None, None] * (V[1:]**2 + V[:-1]**2) / 2).sum(axis=0)
                           / (T[-1] - T[0])),
            "soft_maximum": ((np.diff(T)[:, None, None] * (np.abs(V[1:])**20 + np.abs(V[:-1])**20)
                              / 2).sum(axis=0) / (T[-1] - T[0]))**(1 / 20)}


@pytest.mark.parametrize("pieces", [[40], [1, 2, 37], [7] * 5 + [5]])
@pytest.mark.parametrize("kind", EXPECTED)
def test_a_history_in_pieces(kind, pieces):
    fold, first = Fold(Output("a.b", kind), V.shape[1:]), 0
    for count in pieces:
        fold.add(T[first:first + count], V[first:first + count])
        first += count
    assert_allclose(fold.value(), EXPECTED[kind], rtol=1e-13)


@pytest.mark.parametrize("part", [0.0, 0.25, 0.8])
def test_between_states_a_value_is_on_their_line(part):
    time = (1 - part) * T[11] + part * T[12]
    fold = Fold(Output("a.b", "at", time), V.shape[1:])
    for k in range(0, 40, 6):       # the states around it come in two pieces
        fold.add(T[k:k + 6], V[k:k + 6])
    assert_allclose(fold.value(), (1 - part) * V[11] + part * V[12], rtol=1e-12)


def test_the_length_of_a_matrix_is_of_all_entries():
    fold = Fold(Output("a.b", "maximum", norm=True), V.shape[1:])
    fold.add(T, V)
    assert_allclose(fold.value(), np.linalg.norm(V.reshape(40, 6), axis=1).max(), rtol=1e-13)
    assert_allclose(lengths(V), np.linalg.norm(V.reshape(40, 6), axis=1), rtol=1e-13)
    assert sizes_of(Values([V], [], (Measure("a.b"),))) == [pytest.approx(
        np.linalg.norm((V - V[0]).reshape(40, 6), axis=1).max())]


def test_runs_with_other_steps_are_compared_at_the_same_times():
    fine, coarse = V, V[::3] + 0.0
    coarse[5] += 0.5 * np.array([[1.0, 0, 0], [0, 0, 0]])
    size = 2.0
    whole = (Measure("a.b"),)
    one, other = Values([fine], [3.0], whole), Values([coarse], [3.3], whole)
    assert difference(one, Values([V[::3]], [3.0], whole), [size], (3, 1)) == 0.0
    assert difference(one, other, [size], (3, 1)) == pytest.approx(0.5 / size)
    assert difference(Values([], [3.0]), Values([], [3.3]), [], (1, 1)) == pytest.approx(
        1 - 3.0 / 3.3)


def test_steps_of_a_motion_that_is_quiet_at_times():
    """Rates of accelerations of 1 for a fifth of the time, of 1/8, and of less than are seen."""
    rates = np.concatenate([np.ones(20), np.full(60, 1 / 8), np.full(20, 1e-9)])
    history = np.concatenate([[0.0], np.cumsum(rates)])[:, None] * (1.0, -2.0)
    result = SimpleNamespace(system=SimpleNamespace(magnitude=np.array([1.0, 2.0])),
                             recorded=lambda name: history)
    assert_allclose(activity(result), 0.2 + 0.6 * 0.5 + 0.2 * QUIET**(1 / 3), rtol=1e-9)
