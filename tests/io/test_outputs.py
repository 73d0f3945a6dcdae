"""Output matrices of suppliers: displacements and stresses of inner points by reduced coordinates.
"""

from dataclasses import replace

import numpy as np
import pytest

from sebody import InputError, Model, simulate
from sebody.analysis import Ensemble, final
from sebody.explore.inspection import inspect, report, to_json
from sebody.fem import hexahedral_block
from sebody.io import import_body, read_body_file, save_body
from sebody.reduction import RigidFace, craig_bampton
from sebody.reduction.condensation import released
from sebody.reduction.truncation import truncated

with np.printoptions():         # which pyyeti changes
    pytest.importorskip("pyyeti", reason="reads OP4")
    from pyyeti.nastran import op4

FE = replace(hexahedral_block((1, 2, 3), (4, 1, 1), (4, 2, 2), 2e7, 0.3, 2e3),
             geometric_stiffness=None)
INNER = [20, 7, 33]


@pytest.fixture(scope="module")
def body():
    ends = [(RigidFace((x, 2.5, 3.5), np.flatnonzero(np.isclose(FE.coordinates[:, 0], x))), "full")
            for x in (1, 5)]
    return craig_bampton(FE, ends, 4)


def matrices(body):
    """Displacements of inner nodes, and stresses at the points of two elements, (m, n)."""
    n = len(body.mass)
    shapes = body.recovery.shapes[:, :n]
    moved = shapes.reshape(len(FE.coordinates), 3, n)
    stress, = body.recovery.stress
    stresses = stress.stress(moved, np.array([3, 9])).reshape(-1, n)
    return moved[INNER].reshape(-1, n), stresses


@pytest.fixture(scope="module")
def path(body, tmp_path_factory):
    """Files as of EXTSEOUT: rows node after node, the second node first, modes as scalar points."""
    path = tmp_path_factory.mktemp("outputs") / "se.op4"
    order = np.r_[3:6, 9:12, 0:3, 6:9, 12:16]
    chosen = np.ix_(order, order)
    disp, stress = matrices(body)
    op4.write(str(path), {"kaax": body.stiffness[chosen], "maax": body.mass[chosen],
                          "mug1": disp[:, order], "otm": stress[:, order]}, binary=True)
    grids = [f"GRID    {k:8d}        {x:8.3f}{y:8.3f}{z:8.3f}"
             for k, (x, y, z) in zip((7, 4), body.coordinates, strict=True)]
    points = "".join(f"{k:8d}{k:8d}" for k in (901, 902))
    path.with_suffix(".asm").write_text("\n".join([
        "SECONCT       75       0", f"        {4:8d}{4:8d}{7:8d}{7:8d}{points}",
        "        " + "".join(f"{k:8d}{k:8d}" for k in (903, 904)),
        "SPOINT  " + "".join(f"{k:8d}" for k in (901, 902, 903, 904)), *grids]) + "\n")
    return path


def run(body, turn=None):
    model = Model()
    points = body.coordinates if turn is None else body.coordinates @ turn.T
    for name, point in zip(("root", "tip"), points, strict=True):
        model.node(name, point)
    model.superelement("block", body, ["root", "tip"], rotation=turn)
    model.revolute("root", axis=(0, 0, 1))
    model.force("tip", (1, 2, -1), 2e4)
    return simulate(model, 0.01, 0.4)


@pytest.mark.parametrize("turned", [False, True])
def test_outputs_are_what_recovery_gives(body, path, turned):
    """Of a body that moves far and is placed along other axes, as displacements and stresses."""
    turn = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]) if turned else None
    found = import_body(path, {"root": 7, "tip": 4})
    assert list(found.outputs) == ["MUG1", "OTM"]
    whole = replace(found, recovery=body.recovery)
    result = run(whole, turn)
    assert np.abs(result["tip.position"][-1] - result["tip.position"][0]).max() > 0.05
    field = result.field("block")
    n = len(body.mass)
    moved = (field.amplitudes[:, :n] @ whole.rotated(np.eye(3) if turn is None else turn
                                                     ).recovery.by if turned else
             field.amplitudes[:, :n])
    disp, stress = matrices(body)
    for name, matrix in (("MUG1", disp), ("OTM", stress)):
        expected = moved @ matrix.T
        values = result[f"block.{name}.values"]
        np.testing.assert_allclose(values, expected, atol=1e-12 * np.abs(expected).max())
        np.testing.assert_array_equal(result[f"block.{name}.values.4"], values[:, 4])
    node = result[f"block.node{INNER[0]}.stress"]
    assert node.shape == (len(result.t), 6)


def test_outputs_are_listed_kept_and_followed(body, path, tmp_path):
    found = import_body(path, {"root": 7, "tip": 4}, output=tmp_path / "body.npz")
    file = read_body_file(tmp_path / "body.npz")
    assert "output                   MUG1.values, 9 numbers" in report(inspect(file))
    assert '"OTM": 96' in to_json(inspect(file))
    again = read_body_file(save_body(found, tmp_path / "again.npz")).body()
    np.testing.assert_array_equal(again.outputs["OTM"], found.outputs["OTM"])
    fewer = truncated(found, 2)
    np.testing.assert_array_equal(fewer.outputs["MUG1"], found.outputs["MUG1"][:, :14])
    free = released(found, 1, "rotation")
    np.testing.assert_allclose(free.body.outputs["MUG1"], found.outputs["MUG1"] @ free.basis)
    result = run(found)
    outcome = Ensemble(result.model, 0.01).run(
        {"gravity": [(0.0, 0.0, 0.0), (0.0, 0.0, -9.81)]}, 0.4,
        {"moved": final("block.MUG1.values.4")})
    last = result["block.MUG1.values.4"][-1]
    assert outcome["moved"][0] == pytest.approx(last, rel=1e-9)
    assert outcome["moved"][1] != pytest.approx(last, rel=1e-3)
    with pytest.raises(InputError, match="'block.MUG2.values' is unknown: did you mean "
                                         "'block.MUG1.values'"):
        result["block.MUG2.values"]


def test_outputs_of_another_body_are_refused(path, tmp_path):
    matrices = op4.read(str(path), into="dct", justmatrix=True)
    other = tmp_path / "se.op4"
    op4.write(str(other), {**matrices, "otm": matrices["otm"][:, :-1]})
    other.with_suffix(".asm").write_bytes(path.with_suffix(".asm").read_bytes())
    with pytest.raises(InputError, match="OTM has shape .96, 15., .*needs 16 columns"):
        import_body(other)
