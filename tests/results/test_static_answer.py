"""The static response of the omitted modes, against the matrices of the whole FE model."""

from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import hexahedral_block
from sebody.reduction import reduce

TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def block():
    """A block of bricks in general position, and four nodes of it in no plane."""
    own = hexahedral_block((0.3, -0.2, 0.1), (3.0, 1.2, 0.8), (4, 2, 2), 2e4, 0.3, 1.7)
    x, y, z = (own.coordinates - own.coordinates.min(axis=0)).T
    held = [int(np.argmin(np.abs(x - a) + np.abs(y - b) + np.abs(z - c))) for a, b, c in (
        (0, 0, 0), (0, 1.2, 0.8), (3, 0, 0.8), (3, 1.2, 0))]
    return own, held


def clamped(fe, held):
    """Interior DOFs, and stiffness and mass as dense matrices."""
    inner = np.setdiff1d(np.arange(fe.stiffness.shape[0]), fe.rows[held].ravel())
    return inner, fe.stiffness.toarray(), fe.mass.toarray()


def left_out(fe, held, body, load):
    """``S_II^-1 p - sum phi (phi . p) / omega^2`` by the body's shapes and the FE matrices."""
    inner, K, M = clamped(fe, held)
    found = np.zeros(len(K))
    found[inner] = np.linalg.solve(K[np.ix_(inner, inner)], load[inner])
    n = len(body.mass) - body.modes
    modes = body.recovery.shapes[:, n:len(body.mass)]
    stiffnesses, masses = (np.diag(modes.T @ matrix @ modes) for matrix in (K, M))
    for own, expected in ((body.stiffness, stiffnesses), (body.mass, masses)):
        assert_allclose(np.diag(own)[n:], expected, rtol=1e-9)
    return found - modes @ (modes.T @ load / stiffnesses)


def test_spin_about_any_axis():
    """Centripetal accelerations of a spin in no plane of the axes: all six products."""
    fe, held = block()
    body = reduce(fe, {node: "translation" for node in held}, 3)
    spin = np.array([0.7, -1.1, 0.4])
    arms = fe.coordinates - fe.coordinates[held].mean(axis=0)
    load = -fe.mass @ np.cross(spin, np.cross(spin, arms)).ravel()
    products = [spin[k] * spin[m] for k in range(3) for m in range(k, 3)]
    answer = body.recovery.static[:, 12:18] @ products
    expected = left_out(fe, held, body, load)
    assert_allclose(answer, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    diagonal = body.recovery.static[:, [12, 15, 17]] @ spin**2      # what the mixed ones add
    assert np.abs(diagonal - expected).max() > 0.1 * np.abs(expected).max()


def test_accelerations_with_residual_modes():
    """Residual modes of several loads, each with its own frequency, beside vibration modes."""
    fe, held = block()
    random = np.random.default_rng(4)
    loads = {name: random.normal(size=fe.stiffness.shape[0]) for name in "abc"}
    body = reduce(fe, {node: "translation" for node in held}, 2, loads=loads, residual_modes=True)
    assert body.modes == 5
    n = 12
    accelerations = random.normal(size=n)
    load = fe.mass @ (body.recovery.shapes[:, :n] @ accelerations)
    answer = body.recovery.static[:, :n] @ accelerations
    expected = left_out(fe, held, body, load)
    assert_allclose(answer, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_a_load_that_moves_modes_alone():
    """Its work on all motions of the boundary is zero: the second mode, left out, answers to it."""
    fe, held = block()
    _, K, _ = clamped(fe, held)
    whole = reduce(fe, {node: "translation" for node in held}, 2)
    first, second = whole.recovery.shapes[:, 12:14].T
    p = K @ (2e-7 * first / np.abs(first).max() + 3e-7 * second / np.abs(second).max())
    body = reduce(fe, {node: "translation" for node in held}, 1, loads={"wind": p})
    wind = body.loads["wind"].copy()
    assert np.abs(wind[:12]).max() < 1e-9 * np.abs(wind[12])
    wind[:12] = 0.0                 # to rounding
    turned, model = replace(body, loads={"wind": wind}).rotated(TURN), Model()
    nodes = [model.node(f"n{k}", point, keeps="translation")
             for k, point in enumerate(turned.coordinates)]
    model.superelement("block", turned, nodes, frame="positions")
    for node in nodes:
        model.fix(node, "position")
    model.body_load("block", "wind", [(0, 2.0), (1, 2.0)])
    field = equilibrium(model, 1).field("block")
    one, = fe.stress
    u = 2.0 * (2e-7 * first / np.abs(first).max() + 3e-7 * second / np.abs(second).max())
    expected = one.stress(u.reshape(-1, 3, 1))[..., 0].reshape(-1, 6)
    assert_allclose(field.stress(at="points"), expected, rtol=0,
                    atol=1e-6 * np.abs(expected).max())
