"""Numbers of modes by the accuracy of the interface; tests/benchmarks/bench_modes.py has more."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import linalg

from sebody.basics.errors import InputError
from sebody.fem import Section, frame, hexahedral_block, planar_beam
from sebody.reduction import Accuracy, RigidFace, clamped, reduce, watch
from sebody.reduction.accuracy import stiffness_errors
from sebody.reduction.boundary import boundary_of
from sebody.reduction.methods import clamped as clamped_body
from sebody.reduction.omission import Omission

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


def free_frequencies(model, edge):
    """Of the free body by its full matrices, rigid faces tied, in cycles per unit of time."""
    K, M = clamped_body(model, edge)[0]
    squares = linalg.eigh(K.toarray(), M.toarray(), eigvals_only=True)
    rigid = 6 if model.coordinates.shape[1] == 3 else 3
    return np.sqrt(squares[rigid:]) / (2 * np.pi)


def bodies():
    """A planar beam, and a turned block on its end faces."""
    beam = planar_beam([1, 2], [4, 6], SQUARE, 12)
    block = hexahedral_block((1, 2, 3), (6, 1, 1.5), (8, 2, 2), 1e4, 0.3, 2.0)
    x = block.coordinates[:, 0]
    faces = [RigidFace((place, 2.5, 3.75), np.flatnonzero(np.isclose(x, place)))
             for place in (1, 7)]
    return [(beam, [(0, "full"), (12, "full")]), (block, [(face, "full") for face in faces])]


@pytest.mark.parametrize("which", [0, 1])
def test_errors_of_free_frequencies_are_those_of_full_matrices(which):
    model, items = bodies()[which]
    edge = boundary_of(model, items)
    matrices, interior, static = clamped_body(model, edge)
    exact = free_frequencies(model, edge)
    squares, errors = Omission(static, interior, matrices, 16).free_errors()
    for count in (3, 6, 9, 12):
        body = reduce(model, items, count)
        rigid = body.rigid_modes.shape[1]
        found = linalg.eigh(body.stiffness, body.mass, eigvals_only=True)[rigid:]
        true = np.sqrt(found[:7]) / (2 * np.pi) / exact[:len(found[:7])] - 1
        small = (true < 0.01) & np.isfinite(errors[:len(true), count])
        assert small.any()
        # of first order in the error, so within a part of a hundredth that grows with it
        assert_allclose(errors[:len(true), count][small], true[small], rtol=0.07)


@pytest.mark.parametrize("which", [0, 1])
def test_frequencies_alone_take_fewer_modes(which):
    model, items = bodies()[which]
    edge = boundary_of(model, items)
    exact = free_frequencies(model, edge)
    up_to = 1.01 * exact[3]
    counts = {of: reduce(model, items, Accuracy(2e-3, up_to, of)).modes
              for of in ("frequencies", "stiffness")}
    assert counts["frequencies"] < counts["stiffness"]

    def worst(count):
        body = reduce(model, items, count)
        found = linalg.eigh(body.stiffness, body.mass, eigvals_only=True)
        found = np.sqrt(found[body.rigid_modes.shape[1]:]) / (2 * np.pi)
        return (found[:4] / exact[:4] - 1).max() if len(found) >= 4 else np.inf
    assert worst(counts["frequencies"]) < 2e-3 < worst(counts["frequencies"] - 1)


@pytest.mark.parametrize("which", [0, 1])
def test_rubin_has_the_free_frequencies_of_a_band(which):
    model, items = bodies()[which]
    exact = free_frequencies(model, boundary_of(model, items))
    body = reduce(model, items, Accuracy(1e-3, 1.01 * exact[4]), "rubin", judged=True)
    rigid = body.rigid_modes.shape[1]
    found = np.sqrt(linalg.eigh(body.stiffness, body.mass, eigvals_only=True)[rigid:])
    assert_allclose(found[:5] / (2 * np.pi), exact[:5], rtol=1e-8)
    assert 5 <= body.modes <= 5 + rigid
    said = f"the 5 free frequencies up to {exact[4]:.4g} are those of the FE model"
    assert said in body.summary()


@pytest.mark.parametrize("which", [0, 1])
def test_bands_of_a_number_of_modes(which):
    """Up to the band that is told the true error of the dynamic stiffness is within, not beyond."""
    model, items = bodies()[which]
    edge = boundary_of(model, items)
    matrices, interior, static = clamped_body(model, edge)
    known = Omission(static, interior, matrices, 24)
    exact = free_frequencies(model, edge)
    for count in (4, 9):
        frequencies, stiffness = known.bands(count, (1e-2,))
        squares, errors = known.free_errors()
        own = 2 * np.pi * exact <= frequencies[0] * 1.005
        assert errors[:own.sum(), count].max() <= 1e-2 < errors[own.sum(), count]
        if which == 0:
            inner, outer = (true_errors(model, items, part * stiffness[0] / (2 * np.pi), [count])[0]
                            for part in (0.99, 1.02))
            assert inner < 1e-2 < outer


def test_the_cost_is_told_before_it_is_paid():
    """How many modes will do, how long they take, and what takes less."""
    said = []
    model, items = bodies()[1]
    body = reduce(model, items, Accuracy(1e-4, 4.0), progress=said.append)
    remarks = [text for text in said if "with the interfaces clamped" in text]
    assert remarks[0].startswith("12 modes with the interfaces clamped: the dynamic stiffness")
    assert "; about " in remarks[0] and ", which take some " in remarks[0]
    assert "criterion 'frequencies', and exact with method 'rubin'" in remarks[0]
    expected = int(remarks[-1].split("about ")[1].split(" for")[0])
    assert 0.5 * body.modes < expected < 2.5 * body.modes
    assert any(text.startswith("factoring the stiffness of ") for text in said)
    assert any(text.startswith("geometric stiffness") or text == "integrals of the inertia"
               for text in said)
    with pytest.raises(InputError, match="progress is 3: give a function of a text, or True"):
        reduce(model, items, 2, progress=3)


def test_stages_in_a_file(monkeypatch, capsys):
    """Long work says what it does where standard error is no terminal, too, but not every step."""
    now = [0.0]
    monkeypatch.setattr(watch, "monotonic", lambda: now[0])
    told = watch.Terminal()
    for second in range(0, 40, 4):
        now[0] = float(second)
        told.stage(f"{second} modes")
    assert capsys.readouterr().err == "12 modes\n24 modes\n36 modes\n"
