"""SID, Wallrapp's Standard Input Data: written from a body, read where its modes suffice.

O. Wallrapp, Standardization of flexible body modeling in multibody system codes, part 1, Mechanics
of Structures and Machines 22, 1994. Of a frame fixed at the FE origin in the mean-axis sense, with
displacements ``Phi q`` in it:

    mdCM  m c                    J   inertia (xx, yy, zz, xy, xz, yz)
    Ct    Phi^T M E_t            Cr  Phi^T M A_k x             Me  Phi^T M Phi
    Gr    2 (A_k X)^T M A_l Phi  Ge  2 Phi^T M A_k Phi         Oe  Phi^T M A_k A_l x, of
                                                (wx^2, wy^2, wz^2, wx wy, wy wz, wx wz)

each ``M0 + sum_j M1(row, j, column) q_j``; ``x = X + Phi q`` and what follows it in second order,
which is the geometric stiffness of accelerations and spin.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import LinAlgError, eigh

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.fem.matrices import unsymmetric_entry
from sebody.io.body_file import checked_names
from sebody.io.modal import ModalBody, ModalNode
from sebody.io.reading import Reading
from sebody.io.text import fault, read_text
from sebody.io.triplets import WrongEntry, symmetric
from sebody.reduction.body import ReducedBody
from sebody.reduction.rigid_motions import rigid_motions

TARGET = "SID file", (".SID_FEM", ".sid_fem", ".sid")
_REMEDY = "give a file that begins with 'part' and 'new modal', as FEMBS and sebody write them"
_INERTIA = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_SPINS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
_DIGITS = 16
_FRAMES = ("part", "refmod", "frame", "end refmod", "end frame", "end modal", "end part")
_OUTSIDE = re.compile(r"new modal|nelastq|ielastq\s*\(\s*\d+\s*\)|rframe")
_ENTRY = re.compile(r"m([01])\s*\(([\s\d,]+)\)")
_SYMMETRIC = ("Me", "Ke", "De")


def write_sid(body: ReducedBody, path: str | Path, names: tuple[str, ...] | None = None) -> Path:
    """Write a body as SID: its free vibration modes, with constants of inertia and stiffening.

    Parameters
    ----------
    body : ReducedBody
        Spatial, with the constants of exact inertia, and with inertia of all its coordinates.
        Stiffening by accelerations and spin is written; that by joint forces has no place in SID.
    path : str or Path
        File to write, ``.SID_FEM``.
    names : tuple of str, optional
        Of the nodes; numbers from 1 by default.

    Raises
    ------
    InputError
        A body that SID cannot hold, or a target that cannot be written.
    WriteError
        Writing fails; an older file is unchanged.
    """
    inputs.instance(body, "body", ReducedBody, "give a ReducedBody")
    path = check_target(path, *TARGET)
    names = (tuple(map(str, range(1, len(body.keeps) + 1))) if names is None else
             checked_names(names, len(body.keeps)))
    if body.preload is not None:
        raise InputError("SID files hold bodies that are free of stress where they are undeformed, "
                         "and this one has a preload: reduce it without")
    if body.planar or body.invariants is None:
        raise InputError("SID files hold spatial bodies with the integrals of exact inertia: "
                         "reduce an FE model with a mass field, such as one of solids")
    try:
        squares, shapes = eigh(body.stiffness, body.mass)
    except LinAlgError as error:
        raise InputError("SID: the mass is singular, so the body has modes without a frequency; "
                         "give every coordinate inertia") from error
    text = "\n".join(_lines(body, names, squares[6:], shapes[:, 6:])) + "\n"
    with replacing(path, TARGET[0]) as file:
        file.write(text.encode("ascii", "replace"))
    return path


def _lines(body: ReducedBody, names: tuple[str, ...], squares: NDArray, modes: NDArray
           ) -> Iterator[str]:
    """The file for modes (n, nq) with these squares of angular frequencies."""
    nq = modes.shape[1]
    yield f"{len(names):5d} {nq:5d}    :No. nodes, No. modes:S refmod frame new node"
    yield from ("part", "  new modal =", "    refmod", f"      mass = {_real(body.total_mass)}",
                f"      nelastq = {nq}")
    for k, square in enumerate(squares, 1):
        yield f"      ielastq ({k:4d}) = Eigen Mode {k:4d} : {np.sqrt(square) / 2 / np.pi:12.6g} Hz"
    yield from ("    end refmod", "    frame")
    positions, rotations = list(body.position_nodes), list(body.rotation_nodes)
    for node, name in enumerate(names):
        at = positions.index(node) if node in positions else None
        phi = np.zeros((3, nq)) if at is None else modes[3 * at:3 * at + 3]
        first = 3 * len(positions)
        at = first + 3 * rotations.index(node) if node in rotations else None
        psi = np.zeros((3, nq)) if at is None else modes[at:at + 3]
        yield from _node(name, body.coordinates[node], phi, psi, nq)
    yield "    end frame"
    for name, (constant, linear) in _constants(body, squares, modes).items():
        yield from _taylor(name, constant, linear, nq, "    ")
    yield from ("  end modal", "end part")


def _node(name: str, place: NDArray, phi: NDArray, psi: NDArray, nq: int) -> Iterator[str]:
    rotated = np.cross(psi.T[:, None, :], np.eye(3)[None]).transpose(2, 0, 1)   # psi x e_k
    yield from (f"      new node = {name}", "        rframe = body ref")
    yield from _taylor("origin", place[:, None], phi[:, :, None], nq, "        ")
    yield from _taylor("phi", phi, None, nq, "        ")
    yield from _taylor("psi", psi, None, nq, "        ")
    yield from _taylor("AP", np.eye(3), rotated, nq, "        ")
    yield "      end node"


def _constants(body: ReducedBody, squares: NDArray, modes: NDArray
               ) -> dict[str, tuple[NDArray, NDArray | None]]:
    """M0 (r, c) and M1 (r, nq, c) by name."""
    one, n, nq = body.invariants.about(np.zeros(3)), len(body.mass), modes.shape[1]
    inner = slice(n - body.modes, n)
    S1, g, h = (part[..., :n] @ modes for part in (one.S1, one.g, one.h))
    K = modes.T @ one.K[:, :n, :n] @ modes
    J2 = modes.T @ one.J2[:, :, :n, :n] @ modes
    Q = modes.T @ one.Q @ modes
    # of load modes, and of internal modes that stretch: their answer to the load is a prestress
    stretch = one.E[inner] / np.diag(body.stiffness)[inner, None]
    G = modes.T @ one.Ghat @ modes
    by_first, by_turn, by_spin = (
        np.einsum("...b,bij->...ij", part[..., n:], Q)
        - np.einsum("...e,eij->...ij", part[..., inner] @ stretch, G)
        for part in (one.S1, one.g, one.h))
    both = h + h.transpose(1, 0, 2)
    spins = [-(h[k, k] if k == m else both[k, m]) for k, m in _SPINS]
    more = [-(J2[k, m] + by_spin[k, m]) if k == m else
            -(2 * J2[k, m] + by_spin[k, m] + by_spin[m, k]) for k, m in _SPINS]
    damping = np.zeros((nq, nq)) if body.damping is None else modes.T @ body.damping @ modes
    return {
        "mdCM": (one.c0[:, None], S1[:, :, None]),
        "J": (np.array([[one.J0[k, m]] for k, m in _INERTIA]),
              np.array([both[k, m] for k, m in _INERTIA])[:, :, None]),
        "Ct": (S1.T, by_first.transpose(1, 2, 0)),
        "Cr": (g.T, (K.transpose(0, 2, 1) + by_turn).transpose(1, 2, 0)),
        "Me": (modes.T @ body.mass @ modes, None),
        "Gr": (2 * h.transpose(0, 2, 1).reshape(3, 3 * nq), None),
        "Ge": (2 * K.transpose(2, 1, 0).reshape(nq, 3 * nq), None),
        "Oe": (np.array(spins).T, np.array(more).transpose(1, 2, 0)),
        "ksigma": (np.zeros((nq, 1)), None), "Ke": (np.diag(squares), None), "De": (damping, None),
    }


def _taylor(name: str, constant: NDArray, linear: NDArray | None, nq: int, indent: str
            ) -> Iterator[str]:
    """One matrix; entries that are zero are left out."""
    linear = linear if linear is not None and np.any(linear) else None
    zero = linear is None and not np.any(constant)
    numbers = {"order": int(linear is not None), "nrow": len(constant), "ncol": constant.shape[1],
               "nq": nq, "nqn": 0, "structure": 0 if zero else 3}
    yield indent + name
    yield from (f"{indent}  {key} = {value}" for key, value in numbers.items())
    for i, j in np.argwhere(constant):
        yield f"{indent}  m0({i + 1:4d},{j + 1:4d}) = {_real(constant[i, j])}"
    for i, q, j in np.argwhere(linear) if linear is not None else ():
        yield f"{indent}  m1({i + 1:4d},{q + 1:4d},{j + 1:4d}) = {_real(linear[i, q, j])}"
    yield f"{indent}end {name}"


def _real(value: float) -> str:
    return f"{value:.{_DIGITS}E}".replace("E", "D")


def read(path: Path) -> Reading:
    """The body of a SID file; its nodes become boundary nodes where its modes let them.

    Raises
    ------
    InputError
        A file that is cut off or of another kind.
    """
    parts: dict[str, NDArray] = {}
    nodes: list[ModalNode] = []
    for where, name, matrix in _blocks(path):
        if where is None:
            parts[name] = matrix
        else:
            if not nodes or nodes[-1].name != where:
                nodes.append(ModalNode(where, np.zeros(3), None, None))
            item = {"origin": "point", "phi": "phi", "psi": "psi"}.get(name)
            if item:
                value = matrix[:, 0] if item == "point" else matrix
                nodes[-1] = nodes[-1]._replace(**{item: value})
    missing = {"mass", "mdCM", "J", "Ct", "Cr", "Me", "Ke"} - set(parts)
    if missing or not nodes:
        what = ", ".join(sorted(missing)) or "node"
        raise InputError(f"SID file {path} has no {what}: it is cut off, or {_REMEDY}")
    return Reading(_modal(path, parts, nodes), tuple(node.name for node in nodes),
                   source=f"SID {path.name}", notes={
                       "exact inertia": "none: SID mixes its constants with those of stiffening"})


def _modal(path: Path, found: dict[str, NDArray], nodes: list[ModalNode]) -> ModalBody:
    nq, mass = len(found["Ke"]), float(found["mass"][0, 0])
    shapes = {"mdCM": (3, 1), "Ct": (nq, 3), "Cr": (nq, 3), "Me": (nq, nq), "Ke": (nq, nq)}
    for name, shape in shapes.items():
        if found[name].shape != shape:
            raise InputError(f"SID file {path}: {name} has shape {found[name].shape}, its {nq} "
                             f"modes need {shape}: {_REMEDY}")
    for node in nodes:
        if node.phi is None or node.psi is None or {node.phi.shape, node.psi.shape} != {(3, nq)}:
            raise InputError(f"SID file {path}: node {node.name} has no shapes phi and psi of "
                             f"{nq} modes: {_REMEDY}")
    for name, what in (("Me", "mass"), ("Ke", "stiffness")):
        diagonal = np.diag(found[name])
        if (diagonal < 0).any():
            raise InputError(f"SID file {path}: mode {np.argmin(diagonal) + 1} has the {what} "
                             f"{diagonal.min():g}: write the file again")
    J = found["J"]
    if J.shape == (6, 1):
        whole = np.zeros((3, 3))
        for value, (k, m) in zip(J[:, 0], _INERTIA, strict=True):
            whole[k, m] = whole[m, k] = value
        J = whole
    moment = rigid_motions(found["mdCM"].T, ("translation",), 3, np.zeros(3))[:, 3:]
    M = np.block([[mass * np.eye(3), moment, found["Ct"].T], [moment.T, J, found["Cr"].T],
                  [found["Ct"], found["Cr"], found["Me"]]])
    K, D = np.zeros_like(M), np.zeros_like(M)
    K[6:, 6:] = found["Ke"]
    damping = found.get("De", np.zeros((nq, nq)))
    if damping.shape != (nq, nq):
        raise InputError(f"SID file {path}: De has shape {damping.shape}, its {nq} modes need "
                         f"({nq}, {nq}): {_REMEDY}")
    D[6:, 6:] = damping
    return ModalBody((M + M.T) / 2, K, nodes, str(path), D)


def _blocks(path: Path) -> Iterator[tuple[str | None, str, NDArray]]:
    """Node or None, name and M0 of every matrix; the mass of the body as ``mass``.

    Every line counts: a matrix with one entry less is another body.
    """
    node, block = None, None
    lines = read_text(path, "SID file", _REMEDY).splitlines()
    most = 9 * len(lines)       # every mode has a line of its own, and no matrix is longer
    for number, line in enumerate(lines[1:], 2):        # the first one is a title
        words = line.strip()
        key, equals, value = (part.strip() for part in words.partition("="))
        if not words:
            continue
        if block:
            if words == f"end {block.name}":
                yield node, block.name, block.matrix()
                block = None
            else:
                block.take(number, key, value if equals else None, most)
        elif key == "new node":
            node = value
        elif words == "end node":
            node = None
        elif key == "mass" and equals:
            mass = _value(path, number, value)
            if mass <= 0:
                raise fault(path, number, f"the mass is {mass:g}", "give the body a density")
            yield None, "mass", np.array([[mass]])
        elif re.fullmatch(r"[A-Za-z]\w*", words) and words not in _FRAMES:
            block = _Block(path, words, number)
        elif words not in _FRAMES and not (equals and _OUTSIDE.fullmatch(key)):
            raise fault(path, number, f"{inputs.shown(words)} belongs to no matrix",
                        "write the file again")
    if block:
        raise InputError(f"SID file {path} ends within {block.name}: it is cut off, write it again")


class _Block:
    """One matrix as its lines come."""

    def __init__(self, path: Path, name: str, begun: int):
        self.name = name
        self._path, self._begun = path, begun
        self._sizes: dict[str, int] = {}
        self._entries: dict[tuple[int, ...], tuple[int, float]] = {}    # line and value

    def take(self, number: int, key: str, value: str | None, most: int) -> None:
        """A line ``key = value``, or one without."""
        entry = _ENTRY.fullmatch(key)
        if value is not None and key in ("nrow", "ncol", "structure"):
            self._sizes[key] = _size(self._path, number, key, value, most)
        elif value is not None and entry:
            at = tuple(map(int, re.findall(r"\d+", entry[2])))
            found = _value(self._path, number, value)
            if entry[1] == "0" and self._entries.setdefault(at, (number, found))[0] != number:
                raise fault(self._path, number, f"m0{at} of {self.name} occurs twice",
                            "write the file again")
        elif value is None or key not in ("order", "nq", "nqn"):
            raise fault(self._path, number, f"{inputs.shown(key)} is no entry of {self.name}, "
                        f"which begins in line {self._begun}", "write the file again")

    def matrix(self) -> NDArray:
        """M0: its structure is 0 zero, 1 diagonal, 2 symmetric, 3 full, 4 the unit matrix."""
        shape = self._sizes.get("nrow", 0), self._sizes.get("ncol", 0)
        structure = self._sizes.get("structure")
        for at, (number, _) in self._entries.items():
            if not (len(at) == 2 and 1 <= at[0] <= shape[0] and 1 <= at[1] <= shape[1]):
                raise fault(self._path, number, f"m0{at} is not within {shape[0]} x {shape[1]}",
                            "write the file again")
        matrix = np.eye(*shape) if structure == 4 else np.zeros(shape)
        for (i, j), (_, value) in self._entries.items():
            matrix[i - 1, j - 1] = value
        if structure != 2 and self.name not in _SYMMETRIC:
            return matrix
        if shape[0] != shape[1]:
            raise fault(self._path, self._begun, f"{self.name} is symmetric and has the shape "
                        f"{shape}", "write the file again")
        lines = np.array([number for number, _ in self._entries.values()], dtype=int)
        places = np.array(list(self._entries), dtype=int).reshape(-1, 2) - 1
        if structure == 2:
            values = np.array([value for _, value in self._entries.values()])
            try:
                return symmetric(*places.T, values, shape[0]).toarray()
            except WrongEntry as error:
                raise fault(self._path, int(lines[error.entry]), f"an entry of {self.name} {error}",
                            "write the file again") from error
        unlike = unsymmetric_entry(sparse.csc_array(matrix))
        if unlike is not None:
            i, j = unlike
            raise fault(self._path, self._begun, f"{self.name} is not symmetric, m0({i + 1}, "
                        f"{j + 1}) is {matrix[i, j]:.6g} and m0({j + 1}, {i + 1}) "
                        f"{matrix[j, i]:.6g}", "write the file again")
        return (matrix + matrix.T) / 2


def _size(path: Path, number: int, key: str, text: str, most: int) -> int:
    """Rows or columns of a matrix, or a number for its structure."""
    value = _value(path, number, text)
    if not (value == np.floor(value) and 0 <= value <= (4 if key == "structure" else most)):
        raise fault(path, number, f"{key} = {text.strip()} in a file of {most // 9} lines",
                    "write the file again")
    return int(value)


def _value(path: Path, number: int, text: str) -> float:
    try:
        value = float(text.upper().replace("D", "E"))
    except ValueError as error:
        raise fault(path, number, f"{text!r} is not a number", "write the file again") from error
    if not np.isfinite(value):
        raise fault(path, number, f"{text!r} is not finite", "write the file again")
    return value
