"""Standard Input Data: constants against sums over points of mass, and bodies that come back."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import eigh
from scipy.sparse.linalg import splu

from sebody import InputError
from sebody.fem import hexahedral_block
from sebody.io import import_body, write_sid
from sebody.io.sid import read
from sebody.reduction import RigidFace, craig_bampton

TURN = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [-2.0, -1.0, 2.0]]).T / 3


def model_of(stiffened):
    model = hexahedral_block((1, 2, 3), (4, 1, 0.5), (4, 1, 1), 1e4, 0.25, 2.0)
    return model if stiffened else replace(model, geometric_stiffness=None)


def reduced(model):
    x = model.coordinates[:, 0]
    faces = [(RigidFace((place, 2.4, 3.3), np.flatnonzero(np.isclose(x, place))), keep)
             for place, keep in ((1, "full"), (5, "full"), (3, "translation"))]
    return craig_bampton(model, faces, 5)


def matrices(path):
    """M0 and M1 by name, all entries of a file, read by another way than the reader's."""
    found, own = {}, {}
    for line in path.read_text().splitlines():
        words = line.strip()
        if words in ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "Ke"):
            own = found.setdefault(words, {})
        elif match := re.fullmatch(r"(m[01])\s*\(([\d, ]+)\)\s*=\s*(\S+)", words):
            at = tuple(int(k) - 1 for k in match[2].split(","))
            own[(match[1], *at)] = float(match[3].replace("D", "e"))
        elif words.startswith("end"):
            own = {}
    return found


def array(found, order, shape):
    result = np.zeros(shape)
    for (kind, *at), value in found.items():
        if kind == f"m{order}":
            result[tuple(at)] = value
    return result


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """A file without stiffening, its modes as shapes of the nodes, their masses and places."""
    model = model_of(False)
    body = reduced(model)
    path = write_sid(body, tmp_path_factory.mktemp("sid") / "plain.SID_FEM")
    squares, shapes = eigh(body.stiffness, body.mass)
    modes = (body.recovery.shapes @ shapes[:, 6:]).reshape(len(model.coordinates), 3, -1)
    masses = model.mass[::3][:, ::3].toarray()
    return matrices(path), modes, masses, model.coordinates, squares[6:]


def test_constants_are_sums_over_points(plain):
    """Terms of the equations of motion, for random motions, by sums over nodes with masses."""
    found, modes, masses, points, squares = plain
    nq = modes.shape[2]
    rng = np.random.default_rng(2)
    q, rate, spin, turn = (rng.standard_normal(k) for k in (nq, nq, 3, 3))
    X, v = points + modes @ q, modes @ rate

    def work(field):        # Phi^T M field
        return np.einsum("aij,ab,bi->j", modes, masses, field)

    def taylor(name, rows, columns):
        return (array(found[name], 0, (rows, columns))
                + np.einsum("rqc,q->rc", array(found[name], 1, (rows, nq, columns)), q))
    close = {"rtol": 1e-9, "atol": 1e-9}
    np.testing.assert_allclose(taylor("mdCM", 3, 1)[:, 0], (masses @ X).sum(axis=0), **close)
    np.testing.assert_allclose(taylor("Cr", nq, 3) @ turn, work(np.cross(turn, X)), **close)
    np.testing.assert_allclose(taylor("Ct", nq, 3) @ turn, work(np.tile(turn, (len(X), 1))),
                               **close)
    squared = spin[[0, 1, 2, 0, 1, 0]] * spin[[0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(taylor("Oe", nq, 6) @ squared,
                               work(np.cross(spin, np.cross(spin, X))), **close)
    by_modes = array(found["Ge"], 0, (nq, 3 * nq)).reshape(nq, nq, 3)
    np.testing.assert_allclose(np.einsum("ijk,j,k->i", by_modes, rate, spin),
                               work(2 * np.cross(spin, v)), **close)
    by_modes = array(found["Gr"], 0, (3, 3 * nq)).reshape(3, nq, 3)
    coriolis = np.cross(points, masses @ (2 * np.cross(spin, v))).sum(axis=0)
    np.testing.assert_allclose(np.einsum("ijk,j,k->i", by_modes, rate, spin), coriolis, **close)
    np.testing.assert_allclose(array(found["Ke"], 0, (nq, nq)), np.diag(squares), atol=1e-12)


def test_inertia_changes_with_the_modes(plain):
    found, modes, masses, points, _ = plain
    nq = modes.shape[2]

    def inertia(q):
        X = points + modes @ q
        second = X.T @ masses @ X
        J = np.trace(second) * np.eye(3) - second
        return J[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(array(found["J"], 0, (6, 1))[:, 0], inertia(np.zeros(nq)),
                               rtol=1e-10)
    for k, unit in enumerate(np.eye(nq)):       # J is quadratic: central differences are exact
        slope = (inertia(unit) - inertia(-unit)) / 2
        np.testing.assert_allclose(array(found["J"], 1, (6, nq, 1))[:, k, 0], slope, atol=1e-9)


def test_stiffening_by_acceleration_and_spin(tmp_path):
    """What a stiffened body's M1 have more: the geometric stiffness of loads, boundary clamped."""
    boundary = {0: "translation", 9: "translation", 16: "translation"}
    files, bodies = [], []
    for stiffened in (True, False):
        bodies.append(craig_bampton(model_of(stiffened), boundary, 5))
        files.append(matrices(write_sid(bodies[-1], tmp_path / f"{stiffened}.SID_FEM")))
    model, body = model_of(True), bodies[0]
    modes = body.recovery.shapes[:, :len(body.mass)] @ eigh(body.stiffness, body.mass)[1][:, 6:]
    nq, mass = modes.shape[1], model.mass
    inside = np.setdiff1d(np.arange(len(modes)), [3 * k + i for k in boundary for i in range(3)])
    solve = splu(sparse.csc_matrix(model.stiffness[inside][:, inside])).solve

    def of(field):          # - Phi^T K_G(u) Phi of the displacement u that the load M field makes
        u = np.zeros(len(modes))
        u[inside] = solve((mass @ field.ravel())[inside])
        return -modes.T @ (model.geometric_stiffness(u) @ modes)
    X, axes = model.coordinates, np.eye(3)
    wanted = {"Ct": [of(np.tile(e, (len(X), 1))) for e in axes],
              "Cr": [of(np.cross(e, X)) for e in axes],
              "Oe": [of(np.cross(axes[k], np.cross(axes[m], X))
                        + (k != m) * np.cross(axes[m], np.cross(axes[k], X)))
                     for k, m in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))]}
    for name, matrices_of in wanted.items():
        shape = nq, nq, len(matrices_of)
        one, other = (array(file[name], 1, shape) for file in files)
        matrices_of = np.array(matrices_of).transpose(1, 2, 0)
        # signs of the modes are those of one decomposition each
        same = np.allclose(*[np.abs(eigh(b.stiffness, b.mass)[1]) for b in bodies], atol=1e-8)
        assert same and np.abs(matrices_of).max() > 0
        np.testing.assert_allclose(one - other, matrices_of,
                                   atol=1e-7 * np.abs(matrices_of).max())


def test_a_body_comes_back(tmp_path):
    """What spans the same motions is the same body: stiffness, mass and frequencies."""
    body = reduced(model_of(True)).rotated(TURN)
    path = write_sid(body, tmp_path / "body.SID_FEM", ("10", "20", "30"))
    same = import_body(path, {"b": 20, "a": 10, "c": 30})
    assert same.keeps == ("full", "full", "translation") and same.modes == body.modes
    np.testing.assert_allclose(same.coordinates, body.coordinates[[1, 0, 2]], rtol=1e-15)
    order = np.r_[3:6, 0:3, 6:9, 12:15, 9:12]
    held = np.r_[0:15]
    np.testing.assert_allclose(same.stiffness[np.ix_(held, held)],
                               body.stiffness[np.ix_(order, order)],
                               atol=1e-9 * np.abs(body.stiffness).max())
    np.testing.assert_allclose(same.mass[np.ix_(held, held)], body.mass[np.ix_(order, order)],
                               atol=1e-9 * np.abs(body.mass).max())
    for matrices_of in ((same, body),):
        ours, theirs = (eigh(one.stiffness, one.mass, eigvals_only=True)[6:]
                        for one in matrices_of)
        np.testing.assert_allclose(ours, theirs, rtol=1e-8)


def test_too_few_modes_are_refused(tmp_path):
    body = reduced(model_of(False))
    path = write_sid(body, tmp_path / "body.SID_FEM")
    lines = path.read_text().splitlines()
    assert read(path).names == ("1", "2", "3")
    with pytest.raises(InputError, match="node 3 has no rotations: keep :translation"):
        import_body(path, {"a": 1, "b": 2, "c": "3:full"})
    first = next(k for k, line in enumerate(lines) if "new node = 2" in line)
    copy = [line.replace("node = 1", "node = 4") for line in lines[:first]]
    begin = next(k for k, line in enumerate(copy) if "node = 4" in line)
    path.write_text("\n".join([*lines[:first], *copy[begin:], *lines[first:]]))
    with pytest.raises(InputError, match="its 14 modes and rigid motion give the nodes 1, 4 6 of 12"
                                         " independent motions: name fewer nodes, keep :transl"):
        import_body(path, {"a": 1, "b": 4})     # a node that is another one, too
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match="has no node 7: there are 1, 2, 3"):
        import_body(path, {"a": 7})
    for spoilt, said in ((lines[:-30], "is cut off|ends within"),
                         (lines[:40], "it is cut off|ends within"),
                         ([line.replace("mass =", "mass = x") for line in lines], "is not a "
                                                                                  "number"),
                         (["text"], "is cut off")):
        path.write_text("\n".join(spoilt))
        with pytest.raises(InputError, match=said):
            import_body(path, {"a": 1})


def test_bodies_that_have_no_sid(tmp_path):
    body = replace(reduced(model_of(False)), invariants=None)
    with pytest.raises(InputError, match="SID files hold spatial bodies with the integrals"):
        write_sid(body, tmp_path / "body.SID_FEM")
    with pytest.raises(InputError, match="must end in .SID_FEM"):
        write_sid(body, tmp_path / "body.txt")


def damped_rates(body):
    """Decay of the free vibrations, from the lowest up."""
    n, zero = len(body.mass), np.zeros_like(body.mass)
    state = np.block([[zero, np.eye(n)], [-np.linalg.solve(body.mass, body.stiffness),
                                          -np.linalg.solve(body.mass, body.damping)]])
    found = np.linalg.eigvals(state)
    return np.sort(-found.real[found.imag > 1e-3])


def test_damping_comes_back(tmp_path):
    body = reduced(model_of(False)).damped(0.02)
    path = write_sid(body, tmp_path / "damped.SID_FEM")
    again = import_body(path, {"a": "1", "b": "2", "c": "3:translation"})
    assert len(damped_rates(body)) == len(body.mass) - 6
    np.testing.assert_allclose(damped_rates(again), damped_rates(body), rtol=1e-6)


def test_triangles_of_a_symmetric_matrix(tmp_path):
    """Structure 2 is one triangle, or both where these agree; none is halved or doubled."""
    path = write_sid(reduced(model_of(False)), tmp_path / "body.SID_FEM")
    text = path.read_text()
    start, stop = text.index("    Me\n"), text.index("    end Me\n")
    count = int(re.search(r"nrow = (\d+)", text[start:stop])[1])

    def mass(structure, *entries):
        lines = ["Me", "order = 0", f"nrow = {count}", f"ncol = {count}",
                 f"structure = {structure}"]
        lines += [f"m0({i}, {i}) = 1.0D0" for i in range(1, count + 1)]
        path.write_text(text[:start] + "\n".join([*lines, *entries]) + "\n" + text[stop:])
        return read(path).model.mass[6:, 6:]

    lower, upper = "m0(2, 1) = 0.1", "m0(1, 2) = 0.1"
    whole = mass(3, lower, upper)
    assert whole[0, 1] == whole[1, 0] == 0.1
    for entries in ([lower], [upper], [lower, upper]):
        np.testing.assert_array_equal(mass(2, *entries), whole)
    with pytest.raises(InputError, match="an entry of Me is 0.[12] here and 0.[12] across the"):
        mass(2, lower, "m0(1, 2) = 0.2")
