"""Abaqus: substructures written by the program, and matrices by node and DOF."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from malformed import fe_files
from scipy import sparse

from sebody import InputError
from sebody.explore.inspection import inspect
from sebody.io import import_body, read_body_file, read_fe_model

mtx = pytest.importorskip("abaqus_mtx_parser", reason="its sample files were written by Abaqus")
SAMPLES = Path(mtx.__file__).parent / "mtx"


def places(stiffness, nodes):
    """Places of nodes by which rigid rotations cost no force, the first at the origin.

    ``K_u (e x X) + K_psi e = 0`` for every axis e is linear in them: the file has no coordinates.
    """
    count = len(nodes)
    K = stiffness.reshape(len(stiffness), count, 2, 3)
    rows, sides = [], []
    for e in np.eye(3):
        turned = np.cross(e, np.eye(3)).T                       # e x X = turned @ X
        rows.append(np.einsum("ina,ab->inb", K[:, :, 0], turned).reshape(len(K), -1))
        sides.append(-np.einsum("ina,a->i", K[:, :, 1], e))
    A, b = np.vstack(rows), np.concatenate(sides)
    found = np.linalg.lstsq(A[:, 3:], b, rcond=None)[0]
    return np.vstack([np.zeros(3), np.round(found, 9).reshape(-1, 3)])


@pytest.fixture(scope="module", params=["inner", "outer"])
def substructure(request, tmp_path_factory):
    """A file of Abaqus, the deck of its nodes, and what another program reads."""
    path = shutil.copy(SAMPLES / f"symmetric/{request.param}.mtx",
                       tmp_path_factory.mktemp("abaqus") / "frame.mtx")
    other = mtx.parse_mtx(str(path))
    points = places(other.stiffness, other.nodes)
    lines = (f"{label}, {x!r}, {y!r}, {z!r}" for label, (x, y, z) in
             zip(other.nodes, points.tolist(), strict=True))
    path.with_suffix(".inp").write_text("\n".join(["*NODE", *lines]) + "\n")
    return path, other, points


def test_a_substructure_is_a_body(substructure, tmp_path):
    path, other, points = substructure
    output = tmp_path / "body.npz"
    body = import_body(path, units="mm, t, s", output=output)
    count = len(other.nodes)
    assert body.keeps == ("full",) * count and body.modes == 0
    np.testing.assert_array_equal(body.coordinates, points)
    by_nodes = np.arange(6 * count).reshape(2, count, 3).transpose(1, 0, 2).ravel()
    np.testing.assert_allclose(body.stiffness[np.ix_(by_nodes, by_nodes)], other.stiffness,
                               rtol=1e-12)
    np.testing.assert_allclose(body.mass[np.ix_(by_nodes, by_nodes)], other.mass, rtol=1e-12)
    found = inspect(read_body_file(output))
    assert found.usable and found.file.names == tuple(map(str, other.nodes))


def test_interfaces_name_and_order_the_nodes(substructure):
    path, other, points = substructure
    order = other.nodes[::-1]
    body = import_body(path, {f"n{label}": label for label in order})
    whole = import_body(path)
    np.testing.assert_array_equal(body.coordinates, points[::-1])
    assert body.total_mass == pytest.approx(whole.total_mass, rel=1e-12)
    last = len(order) - 1
    np.testing.assert_array_equal(body.stiffness[:3, :3],
                                  whole.stiffness[3 * last:3 * last + 3, 3 * last:3 * last + 3])
    with pytest.raises(InputError, match="boundary nodes that are not interfaces: "):
        import_body(path, {"a": order[0]})
    with pytest.raises(InputError, match="node 77 is not a boundary node of the reduced body: "
                                         "there"):
        import_body(path, {"a": 77})
    with pytest.raises(InputError, match="reduced already: leave modes out"):
        import_body(path, modes=3)


def test_an_unsymmetric_one_is_refused(tmp_path):
    path = shutil.copy(SAMPLES / "unsymmetric/inner.mtx", tmp_path / "frame.mtx")
    with pytest.raises(InputError, match=r"frame\.mtx, line 3: the substructure is unsymmetric"):
        import_body(path)


# As *MATRIX OUTPUT, FORMAT=LABELS writes the matrices of a T3D2 bar along x between nodes 7 and 9
# with a lumped mass and weak springs across: node, DOF, node, DOF, value of one triangle.
DECK = "*NODE\n7, 0., 0., 0.\n9, 2., 0., 0.\n8, 2., 1., 0.\n*NSET, NSET=ENDS\n7, 9\n"


def entries_of_springs():
    """Stiffness of three springs by node, direction, node, direction: both triangles."""
    pairs = [(7, 9), (9, 8), (8, 7)]
    points = {7: (0, 0, 0), 9: (2, 0, 0), 8: (2, 1, 0)}
    entries = {}
    for a, b in pairs:
        d = np.subtract(points[b], points[a])
        block = 5.0 * np.outer(d, d) / (d @ d)
        for one, two, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            for i in range(3):
                for k in range(3):
                    key = (one, i + 1, two, k + 1)
                    entries[key] = entries.get(key, 0.0) + sign * block[i, k]
    return points, entries


def generated(folder, mass=None):
    points, entries = entries_of_springs()
    lower = [f"{a},{i}, {b},{k}, {v:.15e}" for (a, i, b, k), v in entries.items()
             if (b, k) <= (a, i)]
    (folder / "job_STIF1.mtx").write_text("\n".join(lower) + "\n")
    (folder / "job_MASS1.mtx").write_text(mass or "".join(
        f"{node},{k}, {node},{k}, 1.5\n" for node in points for k in (1, 2, 3)))
    (folder / "job.inp").write_text(DECK)
    return folder / "job_STIF1.mtx"


def test_generated_matrices(tmp_path):
    model = read_fe_model(generated(tmp_path))
    assert model.labels.tolist() == [7, 9, 8] and model.node_sets["ENDS"] == (0, 1)
    rows = [model.rows[model.node(label)].tolist() for label in (7, 8, 9)]
    assert rows == [[0, 1, 2], [3, 4, 5], [6, 7, 8]]        # by label and DOF
    assert model.stiffness[0, 6] == pytest.approx(-5.0)     # along x between 7 and 9
    assert model.mass.diagonal().tolist() == [1.5] * 9
    (tmp_path / "job_MASS1.mtx").write_text("7,1, 7,1, 1.0e36\n")
    with pytest.raises(InputError, match=r"MASS1\.mtx, line 1: node 7, DOF 1, is fixed"):
        read_fe_model(tmp_path / "job_STIF1.mtx")


def test_both_triangles_are_not_added(tmp_path):
    """Matrices with both triangles are those with one; a difference between them is refused."""
    one = read_fe_model(generated(tmp_path))
    _, entries = entries_of_springs()
    lines = [f"{a},{i}, {b},{k}, {v:.15e}\n" for (a, i, b, k), v in entries.items()]
    path = tmp_path / "job_STIF1.mtx"
    path.write_text("".join(lines))
    both = read_fe_model(path)
    np.testing.assert_array_equal(both.stiffness.toarray(), one.stiffness.toarray())
    k = next(k for k, (a, i, b, j) in enumerate(entries) if (b, j) < (a, i) and "-5" in lines[k])
    path.write_text("".join([*lines[:k], lines[k].replace("-5", "-4"), *lines[k + 1:]]))
    with pytest.raises(InputError, match=r"STIF1\.mtx, line \d+: entry 9, 1, 7, 1 is -[45] here "
                                         "and -[45] across the diagonal: the file is damaged"):
        read_fe_model(path)
    path.write_text("".join([*lines, lines[3]]))
    with pytest.raises(InputError, match=f"line {len(lines) + 1}: entry 7, 2, 7, 1 occurs twice"):
        read_fe_model(path)


@pytest.mark.parametrize("both", [False, True])
def test_rows_by_number(tmp_path, both):
    """FORMAT=COORDINATE numbers the rows of the nodes in the order of their labels."""
    by_label = read_fe_model(generated(tmp_path))
    for kind, matrix in (("STIF", by_label.stiffness), ("MASS", by_label.mass)):
        entries = sparse.coo_array(matrix if both else sparse.tril(matrix))
        (tmp_path / f"job_{kind}1.mtx").write_text("".join(
            f" {i + 1}, {j + 1}, {x:.15e}\n" for i, j, x in
            zip(entries.row, entries.col, entries.data, strict=True)))
    model = read_fe_model(tmp_path / "job_STIF1.mtx")
    assert (model.stiffness != by_label.stiffness).nnz == 0
    np.testing.assert_array_equal(model.rows, by_label.rows)
    # nodes whose order is not that of the rows: rigid motion tells
    (tmp_path / "job.inp").write_text(DECK.replace("7,", "70,").replace("8,", "88,"))
    with pytest.raises(InputError, match="rows are in another order, or the body is held: write it "
                                         "with .*FORMAT=LABELS"):
        read_fe_model(tmp_path / "job_STIF1.mtx")
    (tmp_path / "job.inp").write_text(DECK + "*NODE\n10, 5., 5., 5.\n")
    with pytest.raises(InputError, match="has 9 rows, and .* 4 nodes at its elements, of 3"):
        read_fe_model(tmp_path / "job_STIF1.mtx")


def test_nodes_within_elements_are_named(tmp_path):
    path = generated(tmp_path)
    path.write_text(path.read_text() + "-1,1, -1,1, 1.0\n")
    with pytest.raises(InputError, match="node -1, DOF 1, is a node that Abaqus has made within an "
                                         "element, as in B33: use B31 or B32"):
        read_fe_model(path)


def test_damping_of_full_matrices_is_a_caution(tmp_path):
    path = generated(tmp_path)
    (tmp_path / "job_DMPV1.mtx").write_text("7,1, 7,1, 1.0\n")
    assert read_fe_model(path).missing["damping"].startswith("job_DMPV1.mtx is not reduced; ")


def damped_beam(folder, damping, kind="VISCOUS DAMPING"):
    """The substructure of the malformed tests with a damping."""
    path = fe_files.substructure(folder)
    lines = [f" {', '.join(f'{x:.14E}' for x in row[:i + 1])}" for i, row in enumerate(damping)]
    path.write_text("\n".join([path.read_text() + f"*MATRIX,TYPE={kind}", *lines]) + "\n")
    return import_body(path)


def test_damping_of_substructures(tmp_path):
    stiffness, mass = fe_files.two_nodes()
    body = damped_beam(tmp_path, 0.01 * stiffness)
    np.testing.assert_allclose(body.damping, 0.01 * body.stiffness, rtol=1e-14)
    assert not any("damping" in caution for caution in body.cautions)
    body = damped_beam(tmp_path, 0.01 * stiffness + mass)
    assert body.damping is None
    said = "no damping: *MATRIX, TYPE=VISCOUSDAMPING is not that of a free body: damping resists"
    assert any(caution.startswith(said) for caution in body.cautions)
    body = damped_beam(tmp_path, 0.01 * stiffness, "STRUCTURAL DAMPING")
    assert any(caution.startswith("no structural damping: STRUCTURALDAMPING has no equation of "
                                  "motion in time; give") for caution in body.cautions)


def test_a_matrix_that_comes_twice(tmp_path):
    path = fe_files.substructure(tmp_path)
    text = path.read_text()
    path.write_text(text + text[text.index("*MATRIX,TYPE=MASS"):])
    with pytest.raises(InputError, match=r"line 33: \*MATRIX, TYPE=MASS occurs twice, first"):
        import_body(path)
