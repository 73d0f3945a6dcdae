"""Small files of FE programs that are right."""

from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.io import mmwrite

from sebody.fem import hexahedral_block

DATA = Path(__file__).parents[1] / "data"
BLOCK = hexahedral_block((0, 0, 0), (3, 1, 1), (3, 1, 1), 1e4, 0.25, 2.0)
LABELS = np.arange(1, 41) * 10          # node 10, 20, ...
LEFT, RIGHT = (LABELS[:16][np.isclose(BLOCK.coordinates[:, 0], x)] for x in (0, 3))


def lower_triangle(matrix) -> list[str]:
    """Rows of CalculiX: row, column, value."""
    entries = sparse.coo_array(sparse.triu(matrix))
    order = np.lexsort([entries.row, entries.col])
    return [f"{entries.row[k] + 1} {entries.col[k] + 1} {entries.data[k]:.14e}" for k in order]


def calculix(folder: Path, keep=None, model=BLOCK) -> Path:
    """Deck and matrices of a block in CalculiX's format, `keep` of its rows."""
    rows = np.arange(model.stiffness.shape[0]) if keep is None else keep
    nodes = [f"{label}, {x!r}, {y!r}, {z!r}" for label, (x, y, z) in
             zip(LABELS, model.coordinates.tolist(), strict=False)]
    cells = [f"{k + 1}, " + ", ".join(str(LABELS[node]) for node in cell)
             for k, cell in enumerate(model.cells[0][1])]
    lines = ["*NODE, NSET=ALL", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=E", *cells,
             "*NSET, NSET=LEFT", ", ".join(map(str, LEFT)), "*NSET, NSET=RIGHT",
             ", ".join(map(str, RIGHT)), "*NSET, NSET=EDGE", ", ".join(map(str, LEFT[:2])),
             "*NSET, NSET=NONE", "*NSET, NSET=MIDDLE", ", ".join(map(str, LABELS[1:3]))]
    (folder / "se.inp").write_text("\n".join(lines) + "\n")
    names = [f"{LABELS[row // 3]}.{row % 3 + 1}" for row in rows]
    (folder / "se.dof").write_text("\n".join(names) + "\n")
    for name, matrix in (("sti", model.stiffness), ("mas", model.mass)):
        lines = lower_triangle(matrix[rows][:, rows])
        (folder / f"se.{name}").write_text("\n".join(lines) + "\n")
    return folder / "se.inp"


def matrix_market(folder: Path) -> Path:
    """The same as Matrix Market with mapping and nodes."""
    for name, matrix in (("K", BLOCK.stiffness), ("M", BLOCK.mass)):
        mmwrite(folder / f"se_{name}.mtx", sparse.coo_matrix(matrix), symmetry="symmetric")
    lines = [f"{row + 1} {LABELS[row // 3]} U{'XYZ'[row % 3]}"
             for row in range(BLOCK.stiffness.shape[0])]
    (folder / "se.mapping").write_text("\n".join(lines) + "\n")
    nodes = [f"{label} {x!r} {y!r} {z!r}" for label, (x, y, z) in
             zip(LABELS[:16], BLOCK.coordinates.tolist(), strict=True)]
    (folder / "se.nodes").write_text("\n".join(nodes) + "\n")
    return folder / "se_K.mtx"


# stiffness of a chain of two nodes that resist relative motion, with a bending like a beam's
BEAM = np.array([[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0],
                 [6.0, 2.0, -6.0, 4.0]])


def two_nodes() -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass of a unit beam, six DOFs a node."""
    K = np.zeros((12, 12))
    along, twist = [0, 6], [3, 9]
    K[np.ix_(along, along)] = K[np.ix_(twist, twist)] = [[1.0, -1.0], [-1.0, 1.0]]
    K[np.ix_([1, 5, 7, 11], [1, 5, 7, 11])] = BEAM
    signs = np.diag([1.0, -1.0, 1.0, -1.0])
    K[np.ix_([2, 4, 8, 10], [2, 4, 8, 10])] = signs @ BEAM @ signs
    return K, np.diag([0.5, 0.5, 0.5, 0.1, 0.1, 0.1] * 2)


def substructure(folder: Path) -> Path:
    """A beam as Abaqus writes a substructure."""
    lines = ["**", "** GENERATION OF SUBSTRUCTURE Z1", "*USER ELEMENT, NODES=         2, LINEAR",
             "** ELEMENT NODES", "**          4,          7", "   1,   2,   3,   4,   5,   6"]
    for kind, matrix in zip(("STIFFNESS", "MASS"), two_nodes(), strict=True):
        lines.append(f"*MATRIX,TYPE={kind}")
        lines += [" " + ", ".join(f"{x:.14E}" for x in matrix[i, :i + 1]) for i in range(12)]
    (folder / "se.mtx").write_text("\n".join(lines) + "\n")
    (folder / "se.inp").write_text("*NODE\n4, 0., 0., 0.\n7, 1., 0., 0.\n")
    return folder / "se.mtx"


def op4(folder: Path) -> Path:
    """A superelement of Nastran."""
    for suffix in (".op4", ".asm"):
        (folder / f"se{suffix}").write_bytes((DATA / f"nastran/beam{suffix}").read_bytes())
    return folder / "se.op4"
