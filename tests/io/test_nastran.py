"""Nastran, by pyyeti: superelements of the program's own runs."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from sebody import InputError
from sebody.io import import_body

with np.printoptions():         # which pyyeti changes
    pyyeti = pytest.importorskip("pyyeti", reason="reads OP4 and DMIG")
    from pyyeti import nastran
    from pyyeti.nastran import op4

DATA = Path(__file__).parents[1] / "data/nastran"
SAMPLES = Path(pyyeti.__file__).parent / "tests/nas2cam_extseout"
there = pytest.mark.skipif(not SAMPLES.exists(), reason="pyyeti came without its test data")


@there
@pytest.mark.parametrize("name, modes", [("inboard", 8), ("outboard", 22)])
def test_superelements_in_op4(name, modes):
    """Four nodes, one with an output system of its own, turned to the basic system."""
    path = SAMPLES / f"{name}.op4"
    body = import_body(path)
    assert body.keeps == ("full",) * 4 and body.modes == modes
    np.testing.assert_array_equal(body.coordinates, [(600, 0, 300), (600, 300, 300), (600, 300, 0),
                                                     (600, 0, 0)])
    matrices = op4.read(str(path), into="dct", justmatrix=True)
    # no turning changes frequencies, and rigid motions in output systems are pyyeti's
    ours = eigh(body.mass, body.stiffness + body.mass, eigvals_only=True)
    theirs = eigh(matrices["mxx"], matrices["kxx"] + matrices["mxx"], eigvals_only=True)
    np.testing.assert_allclose(ours, theirs, rtol=1e-8, atol=1e-12 * ours[-1])
    table = nastran.asm2uset(str(path.with_suffix(".asm")))[0]
    motions = nastran.rbgeom_uset(table[table.index.get_level_values("dof") > 0])
    gyration = motions.T @ matrices["mxx"][:24, :24] @ motions
    np.testing.assert_allclose(body.rigid_modes.T @ body.mass @ body.rigid_modes, gyration,
                               rtol=1e-10, atol=1e-10 * np.abs(gyration).max())


def test_another_superelement():
    body = import_body(DATA / "beam.op4", {"tip": 2, "root": 1})
    assert body.modes == 8
    # of the CalculiX beam, reduced with as many modes and printed with 16 digits
    squares = eigh(body.stiffness, body.mass, eigvals_only=True)
    np.testing.assert_allclose(np.sqrt(squares[6:14:2]) / 2 / np.pi,
                               [2.5276, 6.9547, 13.633, 22.431], rtol=1e-4)
    assert body.total_mass == pytest.approx(9.9277, abs=5e-5)


@pytest.mark.parametrize("name", ["body.pch", "only.pch"])
def test_dmig_cards(name, tmp_path):
    """Cards that pyyeti writes, with the nodes in the same file or beside it."""
    path = tmp_path / name
    matrices = op4.read(str(DATA / "beam.op4"), into="dct", justmatrix=True)
    table = nastran.asm2uset(str(DATA / "beam.asm"), try_rdextrn=False)[0]
    import pandas as pd

    with path.open("w") as file:
        nastran.wtdmig(file, {key: pd.DataFrame(matrix, table.index, table.index)
                              for key, matrix in matrices.items()})
    cards = (DATA / "beam.asm").read_text()
    if name == "body.pch":
        path.write_text(path.read_text() + cards)
    else:
        path.with_suffix(".asm").write_text(cards)
    body, same = import_body(path), import_body(DATA / "beam.op4")
    np.testing.assert_allclose(body.stiffness, same.stiffness, rtol=1e-9,
                               atol=1e-12 * np.abs(same.stiffness).max())


def test_without_nodes(tmp_path):
    path = tmp_path / "alone.op4"
    path.write_bytes((DATA / "beam.op4").read_bytes())
    with pytest.raises(InputError, match="alone.op4 has no nodes: put the bulk data with GRID"):
        import_body(path)


def test_modes_without_their_scalar_points(tmp_path):
    """Bulk data with GRID cards alone: the rows left over are modes, not those of another run."""
    path = tmp_path / "beam.op4"
    path.write_bytes((DATA / "beam.op4").read_bytes())
    cards = (DATA / "beam.asm").read_text()
    path.with_suffix(".bdf").write_text(cards[cards.index("GRID*"):cards.index("$ SPOINT")])
    with pytest.raises(InputError, match="has 20 rows, 8 more than the nodes of .*beam.bdf, which "
                                         "has no SPOINT cards: modes are scalar points"):
        import_body(path)


@pytest.mark.parametrize(("name", "kind", "said"), [
    ("se.inp", "nastran-op4", r"se\.inp is a file of calculix, by its ending, and the format is "
                              r"nastran-op4, which reads \.op4: leave the format out"),
    ("beam.op4", "calculix", r"beam\.op4 is a file of nastran-op4, .* reads \.inp, \.sti"),
    ("se.mtx", "sid", "is a file of matrix-market or abaqus-substructure or abaqus-matrices"),
])
def test_the_format_of_another_file(tmp_path, name, kind, said):
    (tmp_path / name).write_text("*NODE\n1, 0, 0, 0\n")
    with pytest.raises(InputError, match=said):
        import_body(tmp_path / name, kind=kind)
