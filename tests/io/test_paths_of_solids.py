"""A mass slides along a body from a CalculiX deck, against a transient of the whole FE model."""

import numpy as np
import pytest
from scipy import sparse
from scipy.interpolate import lagrange
from scipy.sparse.linalg import splu

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.io import import_body, read_fe_model
from sebody.reduction import Accuracy, PathLoads

LENGTH, MASS, PUSH = 141.42, 2.0, np.array([0.0, 0.3, -0.6])    # of the sliding mass
SPEED, H, END, RHO = 60.0, 5e-3, 2.0, 0.9
FACES = {"root": "900001/900002", "tip": "900003/900004"}


def along_the_top(fe):
    """Nodes in the middle of the upper face from end to end, of which the ends are tied."""
    x, y, z = fe.coordinates.T
    line = np.flatnonzero(np.isclose(y, 0.0, atol=1e-6) & np.isclose(z, z.max(), atol=1e-6))
    return line[np.argsort(x[line])]


def whole(fe, line):
    """Displacements of the mass and of the end of the path, each (steps + 1, 3).

    Generalized-alpha with all DOFs of the cantilever; the mass is on the quadratic edges of the
    elements, and what it presses with is found from its place.
    """
    root = int(np.flatnonzero((np.abs(fe.coordinates) < 1e-9).all(axis=1))[-1])
    free = np.setdiff1d(np.arange(fe.stiffness.shape[0]), fe.dofs(root))
    K, M = (sparse.csc_array(one)[free][:, free] for one in (fe.stiffness, fe.mass))
    moved = fe.by_nodes(np.eye(fe.stiffness.shape[0])[:, free])
    rows = moved.reshape(len(fe.coordinates), -1, len(free))[line][:, :3]
    am, af = (2 * RHO - 1) / (RHO + 1), RHO / (RHO + 1)
    gamma = 0.5 + af - am
    beta = (gamma + 0.5)**2 / 4
    bp, gp = (1 - am) / (beta * H * H * (1 - af)), gamma / (beta * H)
    solve = splu(sparse.csc_matrix(K + bp * M)).solve
    step, n = LENGTH / (len(line) - 1), len(free)
    q, v, a, x = np.zeros((4, n + 3))
    found = [np.zeros(6)]
    for k in range(1, round(END / H) + 1):
        first = 2 * min(int(SPEED * k * H / step / 2), (len(line) - 3) // 2)
        u = SPEED * k * H / step - first
        weights = [lagrange([0, 1, 2], one)(u) for one in np.eye(3)]
        P = np.tensordot(weights, rows[first:first + 3], 1)
        aux = (af * a - am * x) / (1 - am)
        guess = q + H * v + H * H * ((0.5 - beta) * x + beta * aux)
        speed = v + H * ((1 - gamma) * x + gamma * aux)
        pulled = guess.copy()
        pulled[:n] += solve(-K @ guess[:n])
        pulled[n:] += PUSH / (bp * MASS)
        answers = solve(np.ascontiguousarray(P.T))
        force = np.linalg.solve(P @ answers + np.eye(3) / (bp * MASS), pulled[n:] - P @ pulled[:n])
        q = np.concatenate([pulled[:n] + answers @ force, pulled[n:] - force / (bp * MASS)])
        new = bp * (q - guess)
        v, x = speed + gp * (q - guess), ((1 - af) * new + af * a - am * x) / (1 - am)
        a = new
        found.append(np.concatenate([q[n:], rows[-1] @ q[:n]]))
    return np.split(np.array(found), 2, axis=1)


def cantilever(body):
    """The same of the reduced body."""
    model = Model()
    nodes = [model.node(name, point) for name, point in zip("ab", body.coordinates, strict=True)]
    model.superelement("beam", body, nodes, stiffening=False)
    model.fix("a")
    path = model.path("top", on="beam", nodes="top")
    mass = model.node("mass", path.pieces[0].points[0], "translation")
    model.point_mass("point", mass, MASS)
    model.force(mass, PUSH)
    model.path_joint(mass, path, name="slides")
    model.drive_way("slides", (lambda t: SPEED * t, lambda t: SPEED, lambda t: 0.0))
    return model


@pytest.fixture(scope="module")
def fe(beam_deck):
    return read_fe_model(beam_deck)


@pytest.mark.filterwarnings("ignore")
def test_a_mass_on_an_imported_cantilever(beam_deck, fe):
    """Within 1 %, with vibrations and loads; tied nodes of the face are on the path, too."""
    line = along_the_top(fe)
    assert len(fe.dofs(int(line[-1]))) == 0
    body = import_body(beam_deck, FACES, 4, paths={"top": PathLoads(line.tolist(), 5)})
    mass, tip = whole(fe, line)
    result = simulate(cantilever(body), H, END, generalized_alpha(RHO))
    under = result["mass.position"] - result["mass.position"][0]
    under[:, 0] -= SPEED * result.t
    largest = np.abs(tip).max()
    end = result[f"beam.node{fe.labels[line[-1]]}.position"]
    assert under == pytest.approx(mass, abs=0.01 * largest)
    assert end - end[0] == pytest.approx(tip, abs=0.01 * largest)
    assert largest > 0.02


def test_modes_by_accuracy_and_loads_of_a_path_add_up(beam_deck, fe):
    """Modes are chosen for the interfaces; loads on the path are beside these, and exact."""
    wanted, line = Accuracy(1e-2, 15.0, "frequencies"), along_the_top(fe).tolist()
    bare = import_body(beam_deck, FACES, wanted)
    body = import_body(beam_deck, FACES, wanted, paths={"top": PathLoads(line, 3, "z")})
    assert body.modes == bare.modes + 3
    assert "path 'top': 49 nodes" in body.summary() and "within 0.0042" in body.summary()
    assert body.stiffness[:12, :12] == pytest.approx(bare.stiffness[:12, :12], rel=1e-9)
    held = [line[0], line[-1]]
    with pytest.raises(InputError, match="path 'top': interfaces hold all its nodes"):
        import_body(beam_deck, FACES, wanted, paths={"top": PathLoads(held)})
