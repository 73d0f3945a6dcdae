"""Factors of a sparse stiffness whose motions without strain are known."""

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import SuperLU, splu

from sebody.basics.errors import InputError
from sebody.reduction.pardiso import Pardiso

_SINGULAR = 1e-13  # ratio of pivot to diagonal entry below which a stiffness is singular
STRAIN = 1e-6  # of a motion without strain, relative to the summands of its forces
_STILL = 1e-8  # motion of held rows that is rounding, relative to the extent of the body
_RESIDUAL = 1e-8    # of equations that a user's factor has solved, relative to their summands
_SUSPECT = 1e-11  # lowest eigenvalue above which no pivot is looked at
_SMALL = 5000  # DOFs up to which pivots are looked at in any case
_LARGE = 20_000     # DOFs above which PARDISO factors, where there is one
_SHOWN, _LISTED = 5, 60  # nodes that a message names, DOFs that it looks for them at


class Solver(Protocol):
    """A factored matrix."""

    def solve(self, forces: NDArray) -> NDArray:
        """Solutions (n, k) of right-hand sides (n, k)."""


# a function of a symmetric positive definite matrix, both triangles, that factors it
Factor = Callable[[sparse.csc_array], Solver]


class FactoredStiffness:
    """Solves ``K q = f``; where motions N cost no strain, f must do no work on them.

    As many DOFs as there are such motions are pinned, where these move most: a generalised inverse,
    symmetric, whose solutions differ from others by a motion N.

    Parameters
    ----------
    stiffness : (n, n), sparse
        Symmetric and semidefinite.
    free : (n, r)
        Motions without strain, in comparable units.
    name : function
        Name of the DOF of a row, for messages.
    remedy : str
        What to do about other motions without strain.
    factor : function, optional
        A user's, see `Factor`; by default PARDISO of large matrices, where pypardiso is installed,
        else SuperLU.

    Attributes
    ----------
    by : str
        Name of what has factored the matrix.

    Raises
    ------
    InputError
        More motions without strain than these; the message names DOFs. A factor whose solutions
        are none.
    """

    def __init__(self, stiffness: sparse.csc_array, free: NDArray, name: Callable[[int], str],
                 remedy: str, factor: Factor | None = None):
        self._kept = np.arange(stiffness.shape[0])
        if free.shape[1]:
            order = linalg.qr(free.T, mode="r", pivoting=True)[1]
            self._kept = np.setdiff1d(self._kept, order[:free.shape[1]])
            stiffness = stiffness[self._kept][:, self._kept]
        self._factor, self.by = None, "SuperLU"
        if not len(self._kept):
            return
        if factor is not None:
            self._factor, self.by = _of_user(stiffness, factor), named(factor)
        elif len(self._kept) > _LARGE:
            self._factor, self.by = _by_pardiso(stiffness), "PARDISO"
        if self._factor is None:
            self._factor = _factorise(stiffness, lambda row: name(int(self._kept[row])), remedy)
            self.by = "SuperLU"

    def solve(self, forces: NDArray) -> NDArray:
        """Displacements (n,) or (n, k) of forces, 0 at pinned DOFs."""
        result = np.zeros(forces.shape)
        if self._factor is not None:
            result[self._kept] = self._factor.solve(np.ascontiguousarray(forces[self._kept]))
        return result


def named(factor: Factor) -> str:
    """Name of a user's factor."""
    return str(getattr(factor, "__name__", "a user function"))


def _by_pardiso(stiffness: sparse.csc_array) -> Solver | None:
    """Factors by PARDISO; None without it, or where it finds none."""
    try:
        return _of_user(stiffness, Pardiso)
    except InputError:
        return None


def _of_user(stiffness: sparse.csc_array, factor: Factor) -> Solver | None:
    """Factors that a user's function makes of a stiffness; None of one that may be singular.

    SuperLU then says which DOFs are loose.
    """
    diagonal = stiffness.diagonal()
    if not np.all(diagonal > 0):
        return None
    try:
        made = factor(sparse.csc_array(stiffness))
        force = diagonal * np.random.default_rng(1).standard_normal(len(diagonal))
        answer = np.asarray(made.solve(np.ascontiguousarray(force[:, None])))
    except Exception as error:
        raise InputError(f"factor ended in {type(error).__name__}: {error}; give a function of a "
                         "sparse matrix whose result has solve(right-hand sides (n, k))") from error
    if answer.shape != (len(diagonal), 1) or not np.isfinite(answer).all():
        raise InputError(f"solve() of the factor gives an array of shape {answer.shape}, or "
                         f"numbers that are not finite: it must give ({len(diagonal)}, 1)")
    if _softest(_Columns(made), diagonal) <= _SUSPECT:
        return None
    summands = abs(stiffness) @ np.abs(answer) + np.abs(force[:, None])
    if np.abs(stiffness @ answer - force[:, None]).max() > _RESIDUAL * summands.max():
        raise InputError("the solutions of the factor do not solve the equations: give a function "
                         "that factors the matrix it is given, of its both triangles")
    return _Columns(made)


class _Columns:
    """A factor that solves right-hand sides (n,), too."""

    def __init__(self, made: Solver):
        self._made = made

    def solve(self, forces: NDArray) -> NDArray:
        """Displacements (n,) or (n, k)."""
        columns = np.ascontiguousarray(forces.reshape(len(forces), -1))
        return np.asarray(self._made.solve(columns)).reshape(forces.shape)


def motions_without_strain(stiffness: sparse.csc_array, rigid: NDArray, lengths: NDArray,
                           held: NDArray) -> NDArray:
    """Rigid motions (n, r) of `rigid` (n, k) that leave the rows `held` where they are.

    Both times `lengths` (n,), so that their rows are comparable. None if the stiffness resists
    them: a body that is tied to the ground.
    """
    _, values, turn = linalg.svd(np.vstack([rigid[held], np.zeros((rigid.shape[1],) * 2)]))
    motions = rigid @ turn[values < _STILL * max(1.0, values.max(initial=0.0))].T
    return motions if is_strainless(stiffness, motions / lengths[:, None]) else motions[:, :0]


def is_strainless(stiffness: sparse.csc_array, motions: NDArray) -> bool:
    """Tell whether a stiffness resists motions (n, k) to rounding alone."""
    summands = (abs(stiffness) @ np.abs(motions)).max(axis=0, initial=0.0)
    return bool(np.all(np.abs(stiffness @ motions).max(axis=0, initial=0.0) <= STRAIN * summands))


def _factorise(stiffness: sparse.csc_array, name: Callable[[int], str], remedy: str) -> SuperLU:
    """Factor a stiffness, refusing one that leaves a motion free."""
    # SciPy 1.11 selects rows with 64-bit indices, which its SuperLU does not accept
    short = (array.astype(np.intc) for array in (stiffness.indices, stiffness.indptr))
    matrix = sparse.csc_array((stiffness.data.copy(), *short), shape=stiffness.shape)
    diagonal = stiffness.diagonal()
    ratios = np.ones(len(diagonal))
    if np.all(diagonal > 0):
        try:
            factor = _within_memory(matrix)
            if len(diagonal) > _SMALL and _softest(factor, diagonal) > _SUSPECT:
                return factor
        except RuntimeError:        # a pivot of exactly zero: find it beside a touch of stiffness
            touch = sparse.diags_array(_SINGULAR / 10 * diagonal, format="csc")
            factor = _within_memory(matrix + touch)
        ratios = factor.U.diagonal()[factor.perm_c] / diagonal
        if ratios.min() > _SINGULAR:
            return factor
    raise InputError(
        "S_II is singular: with the boundary clamped the body can still move without strain (a "
        f"mechanism inside): {_suspects(stiffness, ratios, name)}; {remedy}")


def _within_memory(matrix: sparse.csc_array) -> SuperLU:
    try:
        return _lu(matrix)
    except MemoryError as error:
        raise InputError(
            f"the factors of the stiffness of {matrix.shape[0]} unknowns do not fit into memory: "
            "allow more, take a coarser mesh, or a solver that stores less (factor=, or pypardiso "
            "where it is installed)") from error


def _lu(matrix: sparse.csc_array) -> SuperLU:
    # relaxed supernodes store zeros; values above SuperLU's own default overflow its histogram
    return splu(matrix, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, relax=1,
                options={"SymmetricMode": True})


def _softest(factor: Solver, diagonal: NDArray) -> float:
    """Estimate, from above, of the lowest eigenvalue beside a unit diagonal: no pivot is below it.

    Pivots themselves take a copy of the factors, as large as these.
    """
    unit = np.sqrt(diagonal)
    vector = np.random.default_rng(0).standard_normal(len(unit))
    for _ in range(3):
        vector /= np.linalg.norm(vector)
        vector = unit * factor.solve(unit * vector)
    return 1 / np.linalg.norm(vector)


def _suspects(stiffness: sparse.csc_array, ratios: NDArray, name: Callable[[int], str]) -> str:
    """DOFs without stiffness, else the smallest part with a weak pivot, else that pivot's DOF."""
    bare = np.flatnonzero(stiffness.diagonal() <= 0)
    if len(bare):
        return f"{_listed(bare, name)} {'has' if len(bare) == 1 else 'have'} no stiffness"
    count, part = connected_components(stiffness, directed=False)
    if count == 1:
        return f"the DOF held least is {name(int(np.argmin(ratios)))}"
    loose = np.unique(part[ratios <= _SINGULAR])
    smallest = loose[np.argmin(np.bincount(part)[loose])]
    rows = np.flatnonzero(part == smallest)
    return f"a part of {len(rows)} DOFs is loose, that of {_listed(rows, _node_of(name))}"


def _node_of(name: Callable[[int], str]) -> Callable[[int], str]:
    return lambda row: name(row).split(" of ", 1)[-1]


def _listed(rows: NDArray, name: Callable[[int], str]) -> str:
    names = list(dict.fromkeys(name(int(row)) for row in rows[:_LISTED]))
    more = len(rows) > _LISTED or len(names) > _SHOWN
    return ", ".join(names[:_SHOWN]) + (", ..." if more else "")
