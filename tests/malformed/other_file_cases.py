"""Files of other programs that are damaged in ways of their own."""

from pathlib import Path

from malformed import file_cases
from malformed.file_cases import Case, lines_of, replaced
from malformed.tampering import fifo


def file_folder(path: Path) -> None:
    """A folder in the place of a file."""
    path.unlink()
    path.mkdir()


def _market(folder: Path, size: str, kind: str = "coordinate real general") -> None:
    (folder / "se_K.mtx").write_text(f"%%MatrixMarket matrix {kind}\n% remark\n{size}\n"
                                     "1 1 1.0\n2 2 1.0\n3 3 1.0\n")


def _sid(folder: Path, number: str) -> None:
    path = folder / "body.SID_FEM"
    lines = path.read_text().splitlines()
    k = next(k for k, line in enumerate(lines) if "m0(" in line)
    lines[k] = lines[k].partition("=")[0] + "= " + number
    path.write_text("\n".join(lines) + "\n")


def _sid_entry(folder: Path) -> None:
    path = folder / "body.SID_FEM"
    path.write_text(path.read_text().replace("m0(   1,   1)", "m0(  99,   1)"))


def _entry_of(folder: Path, name: str, text: str, at: str = "m0(") -> None:
    """Another line in the place of the first one of a matrix that has a text."""
    path = folder / "body.SID_FEM"
    lines = path.read_text().splitlines()
    start = next(k for k, line in enumerate(lines) if line.strip() == name)
    k = next(k for k in range(start, len(lines)) if at in lines[k])
    lines[k] = "      " + text
    path.write_text("\n".join(lines) + "\n")


def _negative(folder: Path, name: str) -> None:
    """The entries of a matrix with the other sign."""
    path, inside, found = folder / "body.SID_FEM", False, []
    for line in path.read_text().splitlines():
        inside = (inside or line.strip() == name) and line.strip() != f"end {name}"
        found.append(line.replace("= ", "= -").replace("--", "") if inside and "m0(" in line
                     else line)
    path.write_text("\n".join(found) + "\n")


OTHERS = {
    "matrix-market": {
        "1e15 entries": Case("1000000000000000 entries in", lambda folder: _market(
            folder, "48 48 1000000000000000")),
        "1e9 rows": Case("has shape (1000000000, 1000000000), but", lambda folder: _market(
            folder, "1000000000 1000000000 3")),
        "negative rows": Case("its size is '-48 -48 3'", lambda folder: _market(
            folder, "-48 -48 3")),
        "rows of a fraction": Case("is no Matrix Market file", lambda folder: _market(
            folder, "48.5 48 3")),
        "no size": Case("is no Matrix Market file", lambda folder: _market(folder, "")),
        "a row outside": Case("row 4800 of 48", lines_of("se_K.mtx", lambda ls: [
            *ls[:-1], "4800 1 1.0"])),
        "row zero": Case("row 0 of 48", lines_of("se_K.mtx", lambda ls: [*ls[:-1], "0 1 1.0"])),
        "a negative column": Case("column -3 of 48", lines_of("se_M.mtx", lambda ls: [
            *ls[:-1], "1 -3 1.0"])),
        "a column of a fraction": Case("column 1.5 of 48", lines_of("se_M.mtx", lambda ls: [
            *ls[:-1], "1 1.5 1.0"])),
        "an entry too many": Case("entries of", lines_of("se_M.mtx", lambda ls: [
            *ls, "48 48 1.0"])),
        "a word": Case("is no Matrix Market file", lines_of("se_M.mtx", lambda ls: [
            *ls[:-1], "48 48 one"])),
        "a pattern": Case("numbers of type pattern, not real or integer", replaced(
            "se_K.mtx", "real", "pattern")),
        "skew": Case("symmetry of type skew-symmetric", replaced(
            "se_K.mtx", "symmetric", "skew-symmetric")),
        "a vector": Case("is no Matrix Market file", replaced(
            "se_K.mtx", "matrix coordinate", "vector coordinate")),
        "an unknown layout": Case("layout of type sparse", replaced(
            "se_K.mtx", "coordinate", "sparse")),
        "an array": Case("entries of 1176", lambda folder: _market(
            folder, "48 48", "array real symmetric")),
        "negative mass": Case("0 internal motions carry mass", lines_of("se_M.mtx", lambda ls: [
            *ls[:3], *(" ".join([*line.split()[:2], "-" + line.split()[2]]) for line in ls[3:])])),
        "infinite": Case("is inf: the matrix must be finite", lines_of("se_K.mtx", lambda ls: [
            *ls[:-1], ls[-1].rsplit(" ", 1)[0] + " 1e999"])),
    },
    "sid": {
        "1e9 rows": Case("nrow = 1000000000 in a file of", replaced(
            "body.SID_FEM", "nrow = 6", "nrow = 1000000000")),
        "negative rows": Case("nrow = -6", replaced("body.SID_FEM", "nrow = 6", "nrow = -6")),
        "rows of a fraction": Case("nrow = 6.5", replaced(
            "body.SID_FEM", "nrow = 6", "nrow = 6.5")),
        "rows in words": Case("'six' is not a number", replaced(
            "body.SID_FEM", "nrow = 6", "nrow = six")),
        "an unknown structure": Case("structure = 9", replaced(
            "body.SID_FEM", "structure = 3", "structure = 9")),
        "NaN": Case("'NaN' is not finite", lambda folder: _sid(folder, "NaN")),
        "infinite": Case("'1e999' is not finite", lambda folder: _sid(folder, "1e999")),
        "negative mass": Case("the mass is -6", replaced("body.SID_FEM", "mass = ", "mass = -")),
        "no mass": Case("the mass is 0", lines_of("body.SID_FEM", lambda ls: [
            "      mass = 0" if " mass = " in line else line for line in ls])),
        "a mass that is left out": Case("has no mass", lines_of("body.SID_FEM", lambda ls: [
            line for line in ls if " mass = " not in line])),
        "an entry outside": Case("is not within", lambda folder: _sid_entry(folder)),
        "no modes": Case("SID file", lines_of("body.SID_FEM", lambda ls: ls[:40])),
        "cut within a matrix": Case("it is cut off", lines_of("body.SID_FEM", lambda ls: ls[:-8])),
        "no nodes": Case("has no node", lines_of("body.SID_FEM", lambda ls: [
            line for line in ls if "new node" not in line])),
        "an entry without =": Case("m0( 1, 1) 1.0' is no entry of Me, which begins in line",
                                   lambda folder: _entry_of(folder, "Me", "m0(   1,   1) 1.0")),
        "an entry cut in two": Case("is no entry of Me, which", lambda folder: _entry_of(
            folder, "Me", "m0(   1,")),
        "an entry that Fortran could not print": Case("is not a number", lambda folder: _entry_of(
            folder, "Me", "m0(   1,   1) = ******")),
        "an entry twice": Case("m0(1, 1) of phi occurs twice", lines_of("body.SID_FEM", lambda ls: [
            two for line in ls for two in [line] * (1 + ("m0(   1,   1)" in line))])),
        "the beginning of a matrix lost": Case("belongs to no matrix", lines_of(
            "body.SID_FEM", lambda ls: [line for line in ls if line.strip() != "Me"])),
        "one triangle called full": Case("Me is not symmetric, m0(", lambda folder: _entry_of(
            folder, "Me", "m0(   1,   2) = 1.0D0", "m0(   1,   2)")),
        "negative stiffness": Case("has the stiffness -", lambda folder: _negative(folder, "Ke")),
        "negative modal mass": Case("has the mass -", lambda folder: _negative(folder, "Me")),
    },
    "calculix": {
        "an element with seven nodes": Case("of type C3D8 has 7 nodes, in place of 8", lines_of(
            "se.inp", lambda ls: [line.rpartition(",")[0] if line.startswith("1, ") else line
                                  for line in ls])),
        "an element with nine nodes": Case("of type C3D8 has 9 nodes, in place of 8", lines_of(
            "se.inp", lambda ls: [line + ", 1" if line.startswith("1, ") else line
                                  for line in ls])),
        "an element of a node there is not": Case(
            "element 1 of type C3D8 has node 777, which is not in the deck", lines_of(
                "se.inp", lambda ls: [line.rpartition(",")[0] + ", 777" if line.startswith("1, ")
                                      else line for line in ls])),
        "a huge label of a DOF": Case("node 99999999999999999999 is not in the deck", lines_of(
            "se.dof", lambda ls: ["99999999999999999999.1", *ls[1:]])),
        "infinite": Case("se.sti, line 5: ", lines_of("se.sti", lambda ls: [
            *ls[:4], "1 2 1e999", *ls[5:]])),
        "rows of 1e300": Case("row 1e+300, but ", lines_of("se.sti", lambda ls: [
            *ls[:4], "1e300 2 1.0", *ls[5:]])),
        "binary": Case("is not a row of 3 finite numbers", lambda folder: (
            folder / "se.sti").write_bytes(bytes(range(256)) * 20)),
        "a pipe for the mass": Case("is a pipe or a device", lambda folder: fifo(
            folder / "se.mas")),
        "a folder for the labels": Case("is a folder", lambda folder: file_folder(
            folder / "se.dof")),
    },
    "substructure": {
        "no number of nodes": Case("*USER ELEMENT has no number of nodes", replaced(
            "se.mtx", "NODES=         2, ", "")),
        "1e12 nodes": Case("has no number of nodes", replaced(
            "se.mtx", "NODES=         2", "NODES=1000000000000")),
        "a pipe for the deck": Case("is a pipe or a device", lambda folder: fifo(
            folder / "se.inp")),
        "infinite": Case("a number is not finite", replaced(
            "se.mtx", "*MATRIX,TYPE=MASS\n ", "*MATRIX,TYPE=MASS\n 1e999, ")),
        "negative mass": Case("mass is indefinite", lines_of("se.mtx", lambda ls: [
            line.replace(" 5.", " -5.").replace(" 1.", " -1.") if k > next(
                i for i, one in enumerate(ls) if "TYPE=MASS" in one) else line
            for k, line in enumerate(ls)])),
    },
    "op4": {
        "a pipe for the nodes": Case("is a pipe or a device", lambda folder: fifo(
            folder / "se.asm")),
        "a text": Case("is damaged or of another kind", lambda folder: (
            folder / "se.op4").write_text("*NODE\n1, 0., 0., 0.\n" * 9)),
        "empty": Case("se.op4", file_cases.empty("se.op4")),
        "no cards": Case("se.asm", file_cases.empty("se.asm")),
        "cards of another program": Case("se.asm", lambda folder: (
            folder / "se.asm").write_text("*NODE\n1, 0., 0., 0.\n")),
    },
}
