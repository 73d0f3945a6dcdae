"""Ansys: the files that come with ansys-mapdl-reader, and Matrix Market as Ansys writes it."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse
from scipy.io import mmwrite

from sebody import InputError
from sebody.fem import hexahedral_block
from sebody.io import import_body, read_fe_model


@pytest.fixture
def example(tmp_path):
    """A beam of SOLID186 elements, clamped at one end, with the results of its modal analysis."""
    examples = pytest.importorskip("ansys.mapdl.reader.examples", reason="large, an extra")
    for path in (examples.fullfile, examples.rstfile):
        shutil.copy(path, tmp_path)
    return tmp_path / Path(examples.fullfile).name


def test_rows_are_those_of_the_nodes(example):
    """Rigid motion costs no force but beside the clamped face; mass is that of the volume."""
    from ansys.mapdl import reader

    from sebody.io.ansys import full_matrices

    reference, stiffness, mass = full_matrices(example)
    assert reference.shape == (963, 2)
    result = reader.read_binary(str(example.with_suffix(".rst")))
    points = np.asarray(result.mesh.nodes)[reference[:, 0] - 1, :3]
    axes = np.eye(3)[reference[:, 1]]
    motions = np.hstack([axes, np.cross(points, axes)])     # axis . (e_k x X) = e_k . (X x axis)
    forces = np.abs(stiffness @ motions).max(axis=1) / np.abs(stiffness).max()
    free = stiffness.diagonal() > 0
    beside = free & (points[:, 2] < 0.6)        # half an element more than a tenth of the length
    assert forces[free & ~beside].max() < 1e-12 and forces[beside].max() > 1e-3
    x = axes[:, 0] * free
    whole = result.materials[1]["DENS"] * 5.0
    # shapes of the clamped face: of the mass, but for what the last layer loses there
    assert 0.9 * whole < x @ mass @ x < whole


def test_a_model_that_is_held_is_refused(example):
    with pytest.raises(InputError, match=r"is of a model that is held: 63 rows of the nodes 1, .* "
                                         "are empty; delete its supports"):
        read_fe_model(example)


def test_nodes_and_cells(example, tmp_path, monkeypatch):
    """The rest of the way, with the rows that are empty filled by our own matrices."""
    from sebody.io import ansys

    reference = ansys.full_matrices(example)[0]
    matrix = sparse.eye_array(len(reference), format="csc")
    monkeypatch.setattr(ansys, "full_matrices", lambda path: (reference, matrix, matrix))
    model = read_fe_model(example)
    assert model.cells[0][1].shape == (40, 20)
    np.testing.assert_array_equal(np.ptp(model.coordinates, axis=0), (1.0, 1.0, 5.0))
    nodes, names = zip(*model.dof_map, strict=True)
    assert [model.labels[k] for k in nodes[:6]] == [1, 1, 1, 2, 2, 2]
    assert names[:4] == ("x", "y", "z", "x")
    example.with_suffix(".rst").unlink()
    with pytest.raises(InputError, match="has no coordinates: put .*file.rst or .*file.cdb"):
        read_fe_model(example)


def exported(folder, model, order, labels):
    """A model in Matrix Market, rows in another order, as HBMAT and NLIST list them."""
    for name, matrix in (("K", model.stiffness), ("M", model.mass)):
        matrix = sparse.coo_array(matrix[order][:, order])
        mmwrite(folder / f"part_{name}.mtx", sparse.coo_matrix(matrix), symmetry="symmetric",
                precision=17)
    kinds = ("UX", "UY", "UZ")
    rows = [f"{k:9d} {labels[row // 3]:9d}    {kinds[row % 3]}" for k, row in enumerate(order, 1)]
    (folder / "part.mapping").write_text("\n".join(["   Matrix Eqn  Node    DOF", *rows]) + "\n")
    lines = [f"{label} {x!r} {y!r} {z!r}" for label, (x, y, z) in
             zip(labels, model.coordinates.tolist(), strict=True)]
    (folder / "part.nodes").write_text("\n".join(["   NODE  X  Y  Z", *lines]) + "\n")
    return folder / "part_K.mtx"


def test_matrix_market_with_a_mapping(tmp_path):
    model = hexahedral_block((1, 0, 2), (2, 1, 1), (2, 1, 1), 1e3, 0.3, 1.0)
    rng = np.random.default_rng(3)
    labels = rng.permutation(100)[:len(model.coordinates)] + 1
    order = rng.permutation(model.stiffness.shape[0])
    path = exported(tmp_path, model, order, labels)
    read = read_fe_model(path)
    rows = [read.rows[read.node(label)] for label in labels]
    np.testing.assert_allclose(read.stiffness.toarray()[np.ix_(*[np.ravel(rows)] * 2)],
                               model.stiffness.toarray(), rtol=1e-15)
    corners = {f"c{label}": int(label) for label in labels[[0, 2, 6]]}
    body = import_body(path, corners, 3)
    assert body.total_mass == pytest.approx(2.0, rel=1e-12)
    assert body.invariants is not None
