"""Nastran, by pyyeti: superelements of the program's own runs."""

from pathlib import Path

import numpy as np
import pytest
from malformed import fe_files
from noise import noise
from scipy.linalg import eigh

from sebody import InputError
from sebody.explore.inspection import inspect
from sebody.io import import_body, read_body_file

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

    def shares(mass, stiffness):
        return eigh(mass, stiffness + mass, eigvals_only=True)
    theirs = shares(matrices["mxx"], matrices["kxx"])
    rounded = noise(shares, matrices["mxx"], matrices["kxx"], most=1e-6)
    assert (np.abs(shares(body.mass, body.stiffness) - theirs)
            <= 1e-8 * np.abs(theirs) + 1e-12 + rounded).all()
    # displacements of its output set by its boundary and modes, as Nastran computed them
    assert body.outputs["MUG1"].shape == matrices["mug1"].shape
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


GRIDS = ("GRID           4              0.      0.      0.",
         "GRID           7              1.      0.      0.")


def dmig(path, grids=GRIDS, **matrices):
    """DMIG cards of the unit beam between nodes 4 and 7, without entries that are zero."""
    pairs = [(node, k) for node in (4, 7) for k in range(1, 7)]
    lines = list(grids)
    for name, matrix in matrices.items():
        lines.append(f"DMIG    {name:8}{0:8d}{6:8d}{2:8d}{0:8d}{'':24}{12:8d}")
        for j, (node, k) in enumerate(pairs):
            own = [(pairs[i], matrix[i, j]) for i in range(j, 12) if matrix[i, j]]
            if own:
                lines.append(f"DMIG*   {name:16}{'':8}{node:8d}{k:16d}")
                lines += [f"*       {row[0]:16d}{row[1]:16d}{x:16.8E}" for row, x in own]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_damping(tmp_path):
    """Viscous damping is read, structural damping named; inertia may lack rows of the stiffness."""
    K, M = fe_files.two_nodes()
    M[3:6, 3:6] = M[9:, 9:] = 0.0
    path = dmig(tmp_path / "se.pch", KAAX=K, MAAX=M, BAAX=0.01 * K, K4AAX=0.02 * K)
    body = import_body(path)
    np.testing.assert_allclose(body.damping, 0.01 * body.stiffness, rtol=1e-12)
    assert body.keeps == ("full", "full") and body.mass[6:, 6:].max() == 0
    assert any("no structural damping: K4AAX has no equation of motion in time" in caution
               for caution in body.cautions)
    body = import_body(dmig(path, KAAX=K, MAAX=M, BAAX=M))
    assert body.damping is None
    said = "no damping: BAAX is not that of a free body: damping resists rigid motion"
    assert any(said in caution for caution in body.cautions)


@pytest.mark.parametrize("ending", ["", "1"])
def test_damping_in_op4(tmp_path, ending):
    """Turned and put in order as the stiffness is."""
    matrices = op4.read(str(DATA / "beam.op4"), into="dct", justmatrix=True)
    name = next(name for name in matrices if name.lower().startswith("k"))
    path = tmp_path / "beam.op4"
    op4.write(str(path), {**matrices, f"b{name[1:]}{ending}": 0.01 * matrices[name]})
    path.with_suffix(".asm").write_bytes((DATA / "beam.asm").read_bytes())
    body = import_body(path, {"tip": 2, "root": 1})
    np.testing.assert_allclose(body.damping, 0.01 * body.stiffness,
                               atol=1e-12 * np.abs(body.stiffness).max())


def test_entries_that_come_twice(tmp_path):
    """Of both triangles of a symmetric matrix the last one would count, in silence."""
    K, M = fe_files.two_nodes()
    path = dmig(tmp_path / "se.pch", KAAX=K, MAAX=M)
    lines = path.read_text().splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("DMIG") and "MAAX" in line)
    lines[start:start] = [f"DMIG*   {'KAAX':16}{'':8}{7:8d}{1:16d}",
                          f"*       {4:16d}{1:16d}{-2.0:16.8E}"]
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="DMIG KAAX has the entry of DOF 1 of node 4 and DOF 1 of "
                                         "node 7 twice, once on either side"):
        import_body(path)


def turned(matrix, axes):
    """A matrix of nodes 4 and 7 with node 7 along axes (rows)."""
    whole = np.eye(12)
    whole[6:9, 6:9] = whole[9:, 9:] = axes
    return whole @ matrix @ whole.T


SYSTEM = ("CORD2R         5       0      0.      0.      0.      0.      1.      0.+C1",
          "+C1           0.      0.      1.")
AXES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])     # x, y, z of system 5


def test_defaults_of_grid_cards(tmp_path):
    """GRDSET holds where a field is blank, not where it is zero; contradictions are named."""
    K, M = fe_files.two_nodes()
    path = tmp_path / "se.pch"
    plain = import_body(dmig(path, KAAX=K, MAAX=M))
    default = "GRDSET" + " " * 42 + f"{5:8d}"
    grids = [default, *SYSTEM, GRIDS[0] + f"{0:8d}", GRIDS[1]]
    body = import_body(dmig(path, grids, KAAX=turned(K, AXES), MAAX=turned(M, AXES)))
    np.testing.assert_allclose(body.stiffness, plain.stiffness, atol=1e-12)
    np.testing.assert_allclose(body.mass, plain.mass, atol=1e-12)
    with pytest.raises(InputError, match="matrices are along basic axes, but the cards give node 7 "
                                         "output systems .CD.: take CD, or GRDSET, off the cards"):
        import_body(dmig(path, grids, KAAX=K, MAAX=M))


def test_places_that_are_not_those_of_the_matrix(tmp_path):
    """Labels and interfaces are named; digits are only blamed for what they may do."""
    K, M = fe_files.two_nodes()
    grids = [GRIDS[0], GRIDS[1].replace("1.", "3.")]
    path = dmig(tmp_path / "se.pch", grids, KAAX=K, MAAX=M)
    with pytest.raises(InputError, match=r"resists rigid motion: .* \((position|rotation) . "
                       r"of (tip \(node 7\)|root \(node 4\))\); if the body is held "
                       "to the ground: use grounded_body, .* as of supports,") as told:
        import_body(path, {"tip": 7, "root": 4})
    assert "digits" not in str(told.value)
    noise = 1e-5 * np.sin(np.add.outer(np.arange(12), np.arange(12)))
    rounded = np.round(K * (1 + noise), 6)
    with pytest.raises(InputError, match="few digits; export them with 14 digits"):
        import_body(dmig(path, KAAX=rounded, MAAX=M))


def test_rotations_with_neither_stiffness_nor_mass_are_left_out(tmp_path):
    """MSC writes 123456 of nodes of solids: the node keeps its translation, with a note."""
    K, M = fe_files.two_nodes()
    bar = np.zeros((12, 12))        # held at node 4 by its rotations: node 7 has none
    T = np.zeros((9, 12))
    T[:, :9] = np.eye(9)
    static = -np.linalg.solve(K[9:, 9:], K[9:, :9])
    bar[:9, :9] = K[:9, :9] + K[:9, 9:] @ static
    mass = M.copy()
    mass[9:, 9:] = 0.0
    output = tmp_path / "body.npz"
    path = tmp_path / "se.op4"
    op4.write(str(path), {"kaax": bar, "maax": mass})
    path.with_suffix(".bdf").write_text("\n".join(GRIDS) + "\n")
    body = import_body(path, output=output)
    assert body.keeps == ("full", "translation")
    assert read_body_file(output).provenance["rows left out"] == (
        "rotations of node 7: neither stiffness nor mass")
    assert inspect(read_body_file(output)).usable


def test_a_node_of_op4_that_keeps_some_directions(tmp_path):
    """Translations alone are read, one of them is refused by name, with what to retain."""
    K, M = fe_files.two_nodes()
    path = tmp_path / "se.op4"
    static = -np.linalg.solve(K[9:, 9:], K[9:, :9])
    op4.write(str(path), {"kaax": K[:9, :9] + K[:9, 9:] @ static, "maax": M[:9, :9]})
    lines = ["SECONCT       75       0", "               1       1       2       2", *GRIDS]
    text = "\n".join(lines).replace("       4  ", "       1  ").replace("       7  ", "       2  ")
    path.with_suffix(".asm").write_text(text + "\n")
    extern = "EXTRN          1  123456       2     {}\n"
    path.with_suffix(".pch").write_text(extern.format("123"))
    assert import_body(path).keeps == ("full", "translation")
    op4.write(str(path), {"kaax": K[:7, :7], "maax": M[:7, :7]})
    path.with_suffix(".pch").write_text(extern.format("  2"))
    with pytest.raises(InputError, match="keeps y of node 2: retain all three translations, .* "
                                         r"reducing \(also x, z\)"):
        import_body(path)
