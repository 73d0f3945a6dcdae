"""What is done to files of FE programs that are right, and the messages of imports."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from malformed.fe_files import (
    BLOCK,
    calculix,
    matrix_market,
    op4,
    substructure,
)
from scipy import sparse
from scipy.io import mmwrite

from sebody.fem import FEModel, hexahedral_block

FACES = {"left": "rbe2:LEFT", "right": "rbe2:RIGHT"}


class Case(NamedTuple):
    """What is wrong with an import that is right otherwise, and what the message has.

    Parameters
    ----------
    said : str
    change : function of the folder, optional
        Spoils a file.
    options : dict
        Other arguments of `import_body`.
    """

    said: str
    change: Callable[[Path], Any] = lambda folder: None
    options: dict = {}


def replaced(name: str, old: str, new: str, times: int = 1) -> Callable[[Path], Any]:
    """A text in a file by another one; it must be there."""
    def change(folder: Path) -> None:
        text = (folder / name).read_text()
        assert old in text
        (folder / name).write_text(text.replace(old, new, times))
    return change


def lines_of(name: str, function: Callable[[list[str]], list[str]]) -> Callable[[Path], Any]:
    """The lines of a file changed."""
    def change(folder: Path) -> None:
        lines = (folder / name).read_text().splitlines()
        (folder / name).write_text("\n".join(function(lines)) + "\n")
    return change


def cut(name: str, part: float) -> Callable[[Path], Any]:
    """A file that ends early."""
    def change(folder: Path) -> None:
        whole = (folder / name).read_bytes()
        (folder / name).write_bytes(whole[:int(part * len(whole))])
    return change


def gone(name: str) -> Callable[[Path], Any]:
    """A file that is not there."""
    return lambda folder: (folder / name).unlink()


def empty(name: str) -> Callable[[Path], Any]:
    """A file without anything in it."""
    return lambda folder: (folder / name).write_text("")


def again(**options) -> Callable[[Path], Any]:
    """The CalculiX files of another model or of fewer rows."""
    return lambda folder: calculix(folder, **options) and None


def swapped(name: str) -> Callable[[Path], Any]:
    """A binary file of another byte order, as far as its first record."""
    def change(folder: Path) -> None:
        from pyyeti.nastran import op4 as writer

        K, M = (np.eye(20) for _ in range(2))
        writer.write(str(folder / name), {"kaax": K, "maax": M}, binary=True, endian="<")
        whole = np.frombuffer((folder / name).read_bytes(), dtype="<u4")
        mixed = np.concatenate([whole[:8].byteswap(), whole[8:]])
        (folder / name).write_bytes(mixed.tobytes())
    return change


def model_of(stiffness=None, mass=None):
    """The block with other matrices."""
    from dataclasses import replace
    changes = {name: matrix for name, matrix in (("stiffness", stiffness), ("mass", mass))
               if matrix is not None}
    return replace(BLOCK, **changes, mass_field=None, geometric_stiffness=None)


def in_two_parts() -> FEModel:
    """The block and another one that nothing connects with it, of the nodes 170 to 240."""
    other = hexahedral_block((0, 5, 0), (1, 1, 1), (1, 1, 1), 1e4, 0.25, 2.0)
    stiffness, mass = (sparse.block_diag(pair, format="csc") for pair in (
        (BLOCK.stiffness, other.stiffness), (BLOCK.mass, other.mass)))
    return FEModel(stiffness, mass, np.vstack([BLOCK.coordinates, other.coordinates]),
                   ("x", "y", "z"), cells=BLOCK.cells)


def _without_density(folder: Path) -> None:
    """A deck whose material has no density, and the matrices of it."""
    calculix(folder, model=model_of(mass=0 * BLOCK.mass))
    deck = folder / "se.inp"
    deck.write_text(deck.read_text() + "*MATERIAL, NAME=LIGHT\n*ELASTIC\n1e4, 0.25\n"
                    "*SOLID SECTION, ELSET=E, MATERIAL=LIGHT\n")


def with_cards(*cards: str) -> Callable[[Path], Any]:
    """A deck with cards behind its others."""
    return lines_of("se.inp", lambda lines: [*lines, *cards])


CALCULIX = {
    "a multiple point constraint": Case("se.inp, line 31: CalculiX takes DOFs of nodes that *MPC",
                                        with_cards("*MPC", "PLANE, 10, 20, 30, 40")),
    "a distributing coupling": Case("DCOUP3D) in the place of a node of its face", with_cards(
        "*ELEMENT, TYPE=DCOUP3D, ELSET=C", "77, 10", "*DISTRIBUTING COUPLING, ELSET=C", "20, 1.")),
    "no density": Case("material LIGHT has no *DENSITY, so the body has no mass",
                       _without_density),
    "no stiffness": Case("stiffness file", gone("se.sti")),
    "no mass": Case("mass file", gone("se.mas")),
    "no labels": Case("se.dof does not exist: run ccx with *FREQUENCY", gone("se.dof")),
    "empty stiffness": Case("se.sti is empty", empty("se.sti")),
    "cut within a line": Case("line 459: the file ends within a line", cut("se.sti", 0.613)),
    "cut within a number": Case("e' is not a row of 3 finite numbers", cut("se.mas", 1 - 2e-4)),
    "cut between lines": Case("row 48 of 48 has no diagonal entry, the file is cut off",
                              lines_of("se.sti", lambda lines: lines[:-1])),
    "mass cut": Case("has no diagonal entry", lines_of("se.mas", lambda lines: lines[:100])),
    "NaN": Case("se.sti, line 7: ", lines_of("se.sti", lambda ls: [*ls[:6], "1 2 nan", *ls[6:]])),
    "text": Case("se.sti, line 1: 'STIFFNESS' is not a row of 3", lines_of(
        "se.sti", lambda lines: ["STIFFNESS", *lines])),
    "four columns": Case("se.mas, line 3: ", lines_of(
        "se.mas", lambda ls: [*ls[:2], ls[2] + " 0.0", *ls[3:]])),
    "row zero": Case("se.sti, line 2: row or column 0 is not a number from 1 to 48", lines_of(
        "se.sti", lambda ls: [ls[0], "0 2 1.0", *ls[1:]])),
    "row of a fraction": Case("se.sti, line 1: row or column 1.5", lines_of(
        "se.sti", lambda ls: ["1.5 1 1.0", *ls[1:]])),
    "row beyond": Case("row 49, but ", lines_of("se.sti", lambda ls: [*ls, "49 49 1.0"])),
    "entry twice": Case("entry (1, 1) occurs twice", lines_of(
        "se.sti", lambda ls: [*ls, "1 1 2.0"])),
    "both triangles": Case("entry (2, 1) is in the other triangle", lines_of(
        "se.mas", lambda ls: [*ls, "2 1 0.0"])),
    "label twice": Case("se.dof, line 5: label 10.2 is that of line 2, too", lines_of(
        "se.dof", lambda ls: [*ls[:4], "10.2", *ls[5:]])),
    "label of no node": Case("se.dof, line 2: node 11 is not in the deck", lines_of(
        "se.dof", lambda ls: [ls[0], "11.2", *ls[2:]])),
    "label as a number": Case("'1.0e1' is not node.direction", lines_of(
        "se.dof", lambda ls: ["1.0e1", *ls[1:]])),
    "temperatures": Case("se.dof, line 1: '10.0' is not node.direction", lines_of(
        "se.dof", lambda ls: ["10.0", *ls[1:]])),
    "labels missing": Case("row 48, but ", lines_of("se.dof", lambda ls: ls[:-1])),
    "empty labels": Case("se.dof is empty", empty("se.dof")),
    "a support": Case("has 2 of 3 translations of node 10: take *BOUNDARY",
                      again(keep=np.arange(1, 48))),
    "a node held": Case("stiffness resists rigid motion", again(keep=np.arange(3, 45)), {
        "interfaces": {"a": 20, "b": 30, "c": 80}}),
    "no deck": Case("does not exist", gone("se.inp")),
    "a deck without nodes": Case("has no *NODE", empty("se.inp")),
    "a node at two places": Case("se.inp, line 3: node 10 has two places",
                                 replaced("se.inp", "20, ", "10, ")),
    "a label that is none": Case("se.inp, line 2: 'ten' is not a label",
                                 replaced("se.inp", "10, ", "ten, ")),
    "a place that is none": Case("se.inp, line 2: 'x' is not a number",
                                 replaced("se.inp", "10, 0.0", "10, x")),
    "an element cut": Case("is not a label", replaced("se.inp", "E\n1, ", "E\n1, E, ")),
    "a rigid body of nothing": Case("'FACE' is neither a label nor a set of nodes", lines_of(
        "se.inp", lambda ls: [*ls, "*RIGID BODY, NSET=FACE, REF NODE=10"])),
    "a rigid body without node": Case("*RIGID BODY has no REF NODE", lines_of(
        "se.inp", lambda ls: [*ls, "*RIGID BODY, NSET=LEFT"])),
    "a missing include": Case("mesh.inp does not exist", lines_of(
        "se.inp", lambda ls: [*ls, "*INCLUDE, INPUT=mesh.inp"])),
    "a circle of includes": Case("is included by itself", lines_of(
        "se.inp", lambda ls: [*ls, "*INCLUDE, INPUT=se.inp"])),
    "a set of a set there is not": Case("'FAR' is neither a label", lines_of(
        "se.inp", lambda ls: [*ls, "*NSET, NSET=NEW", "FAR"])),
    "an unknown node": Case("no node with the label 77; labels near it are 70, 80, 90", options={
        "interfaces": {"a": 77}}),
    "no pair": Case("node 20 does not have the rotations of node 10; pairs of the model: none",
                    options={"interfaces": {"a": "10/20"}}),
    "an unknown set": Case("node set 'FRONT' is unknown: known are 'ALL', 'LEFT'", options={
        "interfaces": {"a": "rbe2:FRONT"}}),
    "an empty set": Case("node set 'NONE' is empty", options={
        "interfaces": {"a": "rbe2:NONE"}}),
    "nodes shared": Case("interfaces 'left' and 'corner' share node 10", options={
        "interfaces": FACES | {"corner": 10}}),
    "a name twice": Case("interface 'a' is given twice", options={
        "interfaces": ["a=10", "a=20"]}),
    "no name": Case("interface is '10'", options={"interfaces": ["10"]}),
    "no interface": Case("the body has no interface", options={"interfaces": {}}),
    "an unknown tie": Case("interface 'a' is 'rbe4:LEFT'", options={
        "interfaces": {"a": "rbe4:LEFT"}}),
    "a point that is none": Case("interface 'a' is 'rbe2:LEFT@0,zero,0'", options={
        "interfaces": {"a": "rbe2:LEFT@0,zero,0"}}),
    "a point of a plane": Case("point of the rigid face 'a' is", options={
        "interfaces": {"a": "rbe2:LEFT@0,0"}}),
    "rotations of a solid": Case("keeps 'full', but the model's nodes have no rotations", options={
        "interfaces": {"a": "10:full", "b": 20, "c": 30}}),
    "a line of nodes": Case("lie on a line", options={
        "interfaces": {"a": "rbe2:EDGE", "b": "rbe2:RIGHT"}}),
    "a mean without faces": Case("weights='equal', rbe3-equal:SET", options={
        "interfaces": {"a": "rbe3:MIDDLE", "b": "rbe2:RIGHT"}}),
    "too many modes": Case("modes is 25, but the clamped body has", options={"modes": 25}),
    "negative modes": Case("modes is -1", options={"modes": -1}),
    "half a mode": Case("modes is 2.5: give a whole number", options={"modes": 2.5}),
    "an unknown method": Case("method 'static' is unknown: use 'craig-bampton'", options={
        "method": "static"}),
    "Guyan with modes": Case("method 'guyan' has none", options={"method": "guyan", "modes": 2}),
    "an unknown format": Case("format 'patran' is unknown: use 'calculix'", options={
        "kind": "patran"}),
    "a loose part": Case("one of 8 nodes (node 170", again(model=in_two_parts())),
    "no mass at all": Case("the body has no mass", again(model=model_of(mass=0 * BLOCK.mass)), {
        "modes": 0}),
    "negative mass": Case("mass is indefinite", again(model=model_of(mass=-BLOCK.mass)), {
        "modes": 0}),
    "negative stiffness": Case("S_II is singular", again(
        model=model_of(stiffness=-BLOCK.stiffness)), {"modes": 0}),
    "a folder for the file": Case("is a folder: give the path of a file", lambda folder: (
        folder / "dir.npz").mkdir(), {"output": "dir.npz"}),
    "no folder for the file": Case("folder", options={"output": "none/body.npz"}),
    "another ending": Case("must end in .npz", options={"output": "body.csv"}),
}
MATRIX_MARKET = {
    "no mapping": Case("se.mapping does not exist", gone("se.mapping")),
    "a row twice": Case("se.mapping, line 2: row 1 occurs twice", replaced(
        "se.mapping", "\n2 10", "\n1 10")),
    "a DOF twice": Case("gives rows 1 and 2 the same DOF, x of node 10", replaced(
        "se.mapping", "2 10 UY", "2 10 UX")),
    "temperatures": Case("se.mapping, line 3: DOF TEMP is not a mechanical DOF", replaced(
        "se.mapping", "3 10 UZ", "3 10 TEMP")),
    "a mapping cut": Case("but ", lines_of("se.mapping", lambda ls: ls[:-1])),
    "a mapping with a hole": Case("se.mapping has no row 5", lines_of(
        "se.mapping", lambda ls: [*ls[:4], *ls[5:]])),
    "a mapping of words": Case("se.mapping, line 2: no row, node and DOF", lines_of(
        "se.mapping", lambda ls: [ls[0], "end of table", *ls[1:]])),
    "no Matrix Market": Case("se_M.mtx is no Matrix Market file", replaced(
        "se_M.mtx", "%%MatrixMarket", "%Matrix")),
    "a matrix cut": Case("se_K.mtx is no Matrix Market file, or cut off", lines_of(
        "se_K.mtx", lambda ls: ls[:-4])),
    "no mass": Case("se_M.mtx does not exist", gone("se_M.mtx")),
    "NaN": Case("is nan: the matrix must be finite", lines_of(
        "se_K.mtx", lambda ls: [*ls[:-1], ls[-1].rsplit(" ", 1)[0] + " nan"])),
    "half of it": Case("stiffness is not symmetric: stiffness[", lambda folder: mmwrite(
        folder / "se_K.mtx", sparse.coo_matrix(BLOCK.stiffness * np.triu(np.ones((48, 48)))
                                               + sparse.eye(48, k=-1)), symmetry="general")),
    "complex": Case("numbers of type complex", lambda folder: mmwrite(
        folder / "se_K.mtx", sparse.coo_matrix(BLOCK.stiffness * 1j), symmetry="general")),
    "a node without place": Case("rows of node 160, which has no place", lines_of(
        "se.nodes", lambda ls: ls[:-1])),
    "a node in the plane": Case("se.nodes, line 1: no node with three coordinates", lines_of(
        "se.nodes", lambda ls: ["10 0 0", *ls[1:]])),
    "a node twice": Case("se.nodes, line 2: node 10 occurs twice", replaced(
        "se.nodes", "\n20 ", "\n10 ")),
    "no nodes": Case("se.nodes has no nodes", empty("se.nodes")),
}
SUBSTRUCTURE = {
    "no mass": Case("has no *MATRIX, TYPE=MASS: write it with *SUBSTRUCTURE MATRIX OUTPUT",
                    replaced("se.mtx", "*MATRIX,TYPE=MASS", "*MATRIX,TYPE=LOAD")),
    "cut": Case("numbers, but *USER ELEMENT has 12 DOFs", cut("se.mtx", 0.8)),
    "temperatures": Case("se.mtx, line 6: DOFs", replaced("se.mtx", "6\n*M", "11\n*M")),
    "unsymmetric": Case("se.mtx, line 3: the substructure is unsymmetric", replaced(
        "se.mtx", "LINEAR", "LINEAR, UNSYM")),
    "a node more": Case("names 2 of 3 nodes", replaced("se.mtx", "         2,", "         3,")),
    "a node twice": Case("names node 4 twice, as CalculiX does", replaced(
        "se.mtx", "          7", "          4")),
    "no deck": Case("has no coordinates: put the deck with *NODE beside it", gone("se.inp")),
    "a node without place": Case("has rows of node 7, whose place is not given", replaced(
        "se.inp", "7, 1.", "8, 1.")),
    "NaN": Case("a number is not finite", replaced("se.mtx", "*MATRIX,TYPE=MASS\n ",
                                                   "*MATRIX,TYPE=MASS\n nan, ")),
    "words": Case("no row of numbers", replaced("se.mtx", "TYPE=MASS\n ", "TYPE=MASS\n end, ")),
    "half a node": Case("keeps x, y of node 4: retain all three", lines_of(
        "se.mtx", lambda ls: _first([*ls[:5], " 1, 2", " 2, 1, 2, 3, 4, 5, 6", *ls[6:]], 8))),
    "nodes in other places": Case("stiffness resists rigid motion", replaced(
        "se.inp", "7, 1.", "7, 2.")),
    "pairs": Case("the body is reduced already, so write a=NODE", options={
        "interfaces": {"a": "4/7"}}),
    "sets": Case("the body is reduced already, so write a=NODE", options={
        "interfaces": {"a": "rbe2:ALL"}}),
    "a node left out": Case("boundary nodes that are not interfaces: 7", options={
        "interfaces": {"a": 4}}),
    "modes": Case("are reduced already: leave modes out", options={"modes": 4}),
}
OP4 = {
    "cut": Case("se.op4 is damaged or of another kind", cut("se.op4", 0.7)),
    "another byte order": Case("se.op4", swapped("se.op4")),
    "no mass": Case("has no pair of matrices KXX and MXX, or KAAX and MAAX; it has kaax",
                    replaced("se.op4", "MAAX", "LOAD")),
    "no nodes": Case("has no nodes: put the bulk data with GRID cards beside it", gone("se.asm")),
    "nodes of another run": Case("has 20 rows and", lines_of(
        "se.asm", lambda ls: [line.replace("  101008", "") for line in ls])),
    "no binary file": Case("se.op4 is damaged or of another kind", lambda folder: (
        folder / "se.op4").write_bytes(bytes(range(256)) * 9)),
}


def _first(lines: list[str], size: int) -> list[str]:
    """The first rows of both matrices."""
    found, left = [], 0
    for line in lines:
        if line.startswith("*MATRIX"):
            found.append(line)
            left = size
        elif "E" in line and left:
            found.append(line)
            left -= 1
        elif "E" not in line or line.startswith("*"):
            found.append(line)
    return found


TABLES = {"calculix": (calculix, FACES, 3, CALCULIX),
          "matrix-market": (matrix_market, {"a": 10, "b": 40, "c": 160}, 3, MATRIX_MARKET),
          "substructure": (substructure, {}, 0, SUBSTRUCTURE), "op4": (op4, {}, 0, OP4)}
