"""FE models that are not one free body: the true reason, by name."""

import re
from dataclasses import replace

import numpy as np
import pytest
from malformed import fe_files
from scipy import sparse
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, fem
from sebody.analysis import vibrations
from sebody.explore.inspection import inspect
from sebody.fem import FEModel, hexahedral_block, solid_stress
from sebody.fem.solids import SolidPrestress
from sebody.fem.stress import elasticity
from sebody.io import import_body, read_body_file
from sebody.io.body_file import BodyFile, body_parts
from sebody.reduction import MeanFace, ReducedBody, RigidFace, free_frequencies, reduce
from sebody.reduction.massless import condensed

FE = hexahedral_block((1, 2, 3), (10, 1, 1), (6, 2, 2), 2.1e5, 0.3, 7.85e-9)
TURN = Rotation.from_rotvec([0.4, -0.7, 0.3]).as_matrix()
ENDS = [np.flatnonzero(np.isclose(FE.coordinates[:, 0], x)).tolist() for x in (1, 11)]


def plain(model, stiffness):
    return replace(model, stiffness=sparse.csc_array(stiffness), geometric_stiffness=None,
                   mass_field=None)


def faces(kind):
    if kind == "mean":
        return [(MeanFace(nodes), "full") for nodes in ENDS]
    return [(RigidFace(FE.coordinates[nodes].mean(axis=0), nodes), "full") for nodes in ENDS]


@pytest.mark.parametrize("kind, method", [("rigid", "craig-bampton"), ("rigid", "rubin"),
                                          ("mean", "craig-bampton"), ("mean", "macneal")])
def test_a_spring_to_the_ground_is_named(kind, method):
    node = 30
    K = FE.stiffness.tolil()
    K[FE.rows[node, 1], FE.rows[node, 1]] += 5e5
    with pytest.raises(InputError, match="resists rigid motion: a (translation along y|rotation "
                       "about [xz]) causes forces of .*, the largest at node 30: as of supports, "
                       "springs to the ground"):
        reduce(plain(FE, K), faces(kind), 4, method)


@pytest.mark.parametrize("method", ["craig-bampton", "rubin"])
def test_few_digits_are_named(method):
    K = sparse.coo_array(FE.stiffness)
    K.eliminate_zeros()
    scale = 10.0 ** (np.floor(np.log10(np.abs(K.data))) - 4)
    five = sparse.coo_array((np.round(K.data / scale) * scale, (K.row, K.col)), shape=K.shape)
    with pytest.raises(InputError, match="causes forces of [1-9].*e-0[56] of .*printed with few "
                                         "digits; export them with 14 digits"):
        reduce(plain(FE, (five + five.T) / 2), faces("mean"), 4, method)


def test_prestress_is_named():
    """Translations are free, rotations are not."""
    x = FE.coordinates
    stretched = np.zeros(FE.stiffness.shape[0])
    stretched[FE.rows[:, 0]] = 1e-3 * (x[:, 0] - 1)
    K = FE.stiffness + FE.geometric_stiffness(stretched)
    with pytest.raises(InputError, match="a rotation about [xyz] causes .*: translations are free, "
                                         "rotations are not, as of matrices of a prestressed"):
        reduce(plain(FE, K), faces("mean"), 4)


def test_rows_along_other_axes_are_named():
    turn = sparse.kron(sparse.eye_array(len(FE.coordinates)), TURN)
    with pytest.raises(InputError, match="resists rigid motion: a rotation about .*axes .systems "
                                         "of nodes, CD, "):
        reduce(plain(FE, turn @ FE.stiffness @ turn.T), faces("rigid"), 4)


@pytest.mark.parametrize("stiffened", [False, True])
def test_parts_that_share_no_node(stiffened):
    """Two blocks that touch, with an interface on each, in mixed order of nodes."""
    one = hexahedral_block((0, 0, 0), (2, 1, 1), (2, 1, 1), 1e4, 0.25, 2.0)
    n = len(one.coordinates)
    points = np.vstack([one.coordinates, one.coordinates + (2, 0, 0)])
    order = np.random.default_rng(4).permutation(2 * n)
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    K, M = (sparse.block_diag([matrix] * 2, format="csr")[rows][:, rows]
            for matrix in (one.stiffness, one.mass))
    cells = [one.cells[0][1], one.cells[0][1] + n]
    places = np.argsort(order)
    geometric = SolidPrestress(points[order], [
        ("hexahedron", places[np.vstack(cells)], elasticity(1e4, 0.25))], sparse.eye_array(6 * n))
    model = FEModel(K, M, points[order], geometric_stiffness=geometric if stiffened else None,
                    node_dofs=("x", "y", "z"),
                    stress=solid_stress(points[order], [("hexahedron", places[np.vstack(cells)])],
                                        1e4, 0.25))
    ends = [RigidFace((x, 0.5, 0.5), np.flatnonzero(np.isclose(model.coordinates[:, 0], x)))
            for x in (0, 4)]
    with pytest.raises(InputError, match=r"2 parts that share no node and no element: one of \d+ "
                                         r"nodes \(node "):
        reduce(model, [(face, "full") for face in ends], 2)
    whole = RigidFace((2, 0.5, 0.5), np.flatnonzero(np.isclose(model.coordinates[:, 0], 2)))
    tied = reduce(model, [(whole, "full"), (ends[0], "full")], 2)     # a rigid face ties them
    assert np.sum(np.linalg.eigvalsh(tied.stiffness) < 1e-9 * 1e4) == 6


def body_with_rotations(dead):
    """A reduced beam of solids, its middle node with three rows more."""
    middle = int(np.argmin(np.linalg.norm(FE.coordinates - (6, 2, 4), axis=1)))
    good = reduce(FE, [*faces("rigid"), (middle, "translation")], 2)
    n = len(good.stiffness)
    old = np.r_[:15, 18:n + 3]
    K, M = np.zeros((2, n + 3, n + 3))
    K[np.ix_(old, old)], M[np.ix_(old, old)] = good.stiffness, good.mass
    M[15:18, 15:18] = 0.0 if dead else 1e-9 * np.eye(3)
    return K, M, good.coordinates


def test_rotations_with_neither_stiffness_nor_mass():
    K, M, points = body_with_rotations(dead=True)
    with pytest.raises(InputError, match="rotation x of node 2, .* have neither stiffness nor mass,"
                                         ".*keep 'translation' there"):
        ReducedBody(K, M, points, ("full",) * 3, 2)
    ReducedBody(*body_with_rotations(dead=False), ("full",) * 3, 2)


def test_motions_without_mass_follow():
    """Frequencies are those of ever smaller masses, in mixed units and directions."""
    rng = np.random.default_rng(7)
    A, B = rng.standard_normal((2, 7, 7))
    units = 10.0 ** rng.uniform(-4, 4, 7)
    turn = np.linalg.qr(B)[0]
    K = np.outer(units, units) * (A @ A.T)
    masses = np.array([1.0, 2.0, 3.0, 4.0, 0, 0, 0])

    def squares(tiny):
        M = np.outer(units, units) * (turn * (masses + tiny * (masses == 0)) @ turn.T)
        found = condensed(M, K) if tiny == 0 else None
        M, own = (M, K) if found is None else (found.mass, found.stiffness)
        L = np.linalg.cholesky(own)
        return np.sort(1 / np.linalg.eigvalsh(np.linalg.solve(L, np.linalg.solve(L, M).T)))[:4]

    # the first correction is of the order of the mass over that of the others
    np.testing.assert_allclose(squares(0), squares(1e-9), rtol=1e-6)


def test_vibrations_of_a_model_with_motions_without_mass():
    """A cantilever by MacNeal's method: its frequencies are the finite ones of the pencil."""
    section = fem.Section(6e-4, 2e-8, 4.5e-8, 4.7e-8, 2e11, 0.3, 7850.0)
    beam = fem.straight_beam([0, 0, 0], [0.6, -0.48, 0.64], section, 6)
    body = reduce(beam, [(0, "full"), (6, "full")], 3, "macneal")
    model = Model()
    for name, place in (("base", 0), ("tip", 6)):
        model.node(name, beam.coordinates[place])
    model.superelement("arm", body, ["base", "tip"])
    model.fix("base")
    found = vibrations(Simulation(model, 1e-4))
    assert found.following and "without mass follow statically" in repr(found)
    free = np.r_[3:6, 9:len(body.mass)]        # of base and tip, positions then rotations
    inverse = eigh(body.mass[np.ix_(free, free)], body.stiffness[np.ix_(free, free)],
                   eigvals_only=True)[::-1]
    omega = 1 / np.sqrt(inverse[inverse > 1e-10 * inverse[0]])
    np.testing.assert_allclose(found.omega[:len(omega)], omega, rtol=1e-6)


def test_frequencies_of_lumped_masses():
    """Two masses without rotary inertia on a beam: one axial vibration, five motions that follow.
    """
    K, M = fe_files.two_nodes()
    order = np.r_[0:3, 6:9, 3:6, 9:12]
    K, M = 1e6 * K[np.ix_(order, order)], M[np.ix_(order, order)]
    M[6:, 6:] = 0.0
    body = ReducedBody(K, M, [[0, 0, 0], [1, 0, 0]], ("full", "full"))
    found = inspect(BodyFile(body_parts(body), ("a", "b")))
    # masses of 1/2 on a spring of 1e6; a turn about the axis moves nothing
    np.testing.assert_allclose(found.numbers["frequencies"]["flexible"], 2000 / (2 * np.pi))
    assert found.numbers["frequencies"]["following"] == 5
    assert any("5 motions without mass follow the others statically" in one.text
               for one in found.findings)


def test_what_rigid_faces_stiffen(tmp_path):
    """Free frequencies are those of the whole matrices; the body's are higher, and noted beside."""
    found = free_frequencies(FE, 8)
    squares = eigh(FE.stiffness.toarray(), FE.mass.toarray(), eigvals_only=True)
    np.testing.assert_allclose(found, np.sqrt(squares[6:14]) / (2 * np.pi), rtol=1e-7)
    path = fe_files.calculix(tmp_path)
    names = {"a": "rbe2:LEFT", "b": "rbe2:RIGHT"}
    import_body(path, names, 0, output=tmp_path / "body.npz", compare_free=True)
    file = read_body_file(tmp_path / "body.npz")
    said = file.provenance["free part"]
    block = fe_files.BLOCK
    whole = np.sqrt(eigh(block.stiffness.toarray(), block.mass.toarray(),
                         eigvals_only=True)[6:12]) / (2 * np.pi)
    body = file.body()
    own = np.sqrt(eigh(body.stiffness, body.mass, eigvals_only=True)[6:12]) / (2 * np.pi)
    numbers = re.findall(r"([\d.e+]+) \(([+-][\d.]+)%\)", said)
    np.testing.assert_allclose([float(one) for one, _ in numbers], whole, rtol=1e-4)
    np.testing.assert_allclose([float(two) for _, two in numbers], 100 * (own / whole - 1),
                               atol=0.006)
    assert said.endswith("tie faces by rbe3 or keep more modes")
    assert "of the body with its rigid faces, which are stiffer" in file.provenance["accuracy"]
