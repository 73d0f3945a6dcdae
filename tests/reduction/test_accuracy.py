"""Numbers of modes by the accuracy of the interface; tests/benchmarks/bench_modes.py has more."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import linalg

from sebody.errors import InputError
from sebody.fem import Section, frame, planar_beam
from sebody.reduction import Accuracy, clamped, reduce
from sebody.reduction.accuracy import stiffness_errors
from sebody.reduction.boundary import boundary_of
from sebody.reduction.methods import clamped as clamped_body

SQUARE = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3)
TURN = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
RIM = 50 * np.array([[np.cos(t), np.sin(t), 0.0] for t in np.arange(4) * np.pi / 2])
# four spokes and a rim, held at the hub: modes with two nodal diameters move the hub by nothing
WHEEL = frame(np.vstack([np.zeros(3), RIM]) @ TURN.T + [7, 8, 9],
              [(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1)], SQUARE, 3)
HUB = [(0, "full")]


def true_errors(model, boundary, frequency, counts):
    """Errors of the dynamic stiffness at one frequency by eliminating all other DOFs."""
    edge = boundary_of(model, boundary)
    (K, M), interior, _ = clamped_body(model, edge)
    omega = 2 * np.pi * frequency
    D = (K - omega**2 * M).toarray()
    held, inside = edge.held, interior.internal
    exact = D[np.ix_(held, held)] - D[np.ix_(held, inside)] @ np.linalg.solve(
        D[np.ix_(inside, inside)], D[np.ix_(inside, held)])
    errors = []
    for count in counts:
        body = reduce(model, boundary, count)
        n = len(edge.held)
        S = body.stiffness - omega**2 * body.mass
        found = S[:n, :n] - S[:n, n:] @ np.linalg.solve(S[n:, n:], S[n:, :n]) if count else S
        norm = (body.stiffness + omega**2 * body.mass)[:n, :n]
        errors.append(np.abs(linalg.eigh(found - exact, norm, eigvals_only=True)).max())
    return np.array(errors)


def test_errors_are_those_of_full_matrices():
    beam = planar_beam([1, 2], [4, 6], SQUARE, 12)
    ends = [(0, "full"), (12, "full")]
    edge = boundary_of(beam, ends)
    matrices, interior, static = clamped_body(beam, edge)
    frequency = 0.9 * np.sqrt(interior.lowest(3)[0][2]) / (2 * np.pi)
    found = stiffness_errors(static, interior, matrices, 2 * np.pi * frequency, 8)
    exact = true_errors(beam, ends, frequency, range(2, 9))
    assert np.all(np.isinf(found[:2])) and np.all(np.isfinite(found[2:]))
    # upper bounds; the tail beyond 8 modes is known to within 1 % at this frequency
    assert np.all(found[2:] >= exact - 1e-9)
    assert_allclose(found[2:], exact, rtol=1e-2, atol=1e-9)
    # too few modes to tell
    assert np.all(np.isinf(stiffness_errors(static, interior, matrices, 2 * np.pi * frequency, 2)))
    # all modes there are: no error is left
    last = stiffness_errors(static, interior, matrices, 2 * np.pi * frequency, 99)
    assert len(last) == interior.count + 1 == 34 and last[-1] == 0.0


@pytest.mark.parametrize("sparse", [False, True])
def test_modes_that_do_not_move_the_interface_are_not_asked_for(sparse, monkeypatch):
    """Modes 0 to 3 move the hub; 4 to 6, at 2.57, 5.15 and 6.02, do not."""
    if sparse:
        monkeypatch.setattr(clamped, "_DENSE_LIMIT", 0)
    for up_to, tolerance, modes in ((1.6, 0.02, 4), (3.0, 0.07, 4), (6.5, 0.04, 9)):
        assert reduce(WHEEL, HUB, Accuracy(tolerance, up_to)).modes == modes
        fewer, enough = true_errors(WHEEL, HUB, up_to, [modes - 1, modes])
        assert enough < tolerance < fewer


def test_no_modes_can_be_enough():
    assert reduce(WHEEL, HUB, Accuracy(0.1, 0.3)).modes == 0


@pytest.mark.parametrize(("arguments", "words"), [
    ((0.0, 1.0), "Accuracy: tolerance is 0.0"),
    ((1.0, 1.0), "Accuracy: tolerance is 1.0"),
    (("1e-3", 1.0), "Accuracy: tolerance is '1e-3'"),
    ((1e-3, -1.0), "Accuracy: up_to is -1.0: give a positive number"),
    ((1e-3, np.inf), "Accuracy: up_to is inf"),
])
def test_bad_accuracies_are_refused(arguments, words):
    with pytest.raises(InputError, match=words):
        Accuracy(*arguments)
