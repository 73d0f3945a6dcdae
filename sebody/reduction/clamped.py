"""The body with its boundary clamped: static solutions and vibration modes of its interior."""

from collections.abc import Callable
from itertools import count

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from sebody.basics.errors import InputError
from sebody.reduction.factor import Factor, FactoredStiffness, motions_without_strain
from sebody.reduction.watch import SILENT, Watch

_DENSE_LIMIT = 1000  # internal DOFs up to which the dense eigenvalue solver is used
_REPEATED = 1e-6  # relative distance below which eigenvalues or components count as equal
_MORE = 4  # modes that are computed beyond those asked for, so that no repeated frequency is cut
_HELD = 1e-10  # singular value of the means of free motions below which a motion is not held
_REMEDY = "keep more boundary nodes or DOF blocks, or connect loose parts"


class ClampedInterior:
    """DOFs whose motion the boundary does not prescribe, and what holds them: stiffness and means.

    Static solutions are those of ``[S -A^T; A 0] [q; f] = [p; b]``: least strain energy under
    forces p at prescribed means b of the DOFs; f are the forces that the means take. Means alone
    may hold the body, so S has motions N without strain; with a generalised inverse ``S^-``

        q = S^- (p + A^T f) + N a,   A q = b,   N^T (p + A^T f) = 0.

    Parameters
    ----------
    stiffness, mass : (n, n), sparse
    held : (h,)
        Rows whose displacement is prescribed.
    means : (m, n), sparse, optional
        Prescribed means of other rows.
    rigid : (n, r), optional
        Rigid motions of the free body, times `lengths`.
    lengths : (n,), optional
        Unit of the displacement over that of each DOF.
    name : function, optional
        Name of the DOF of a row, for messages.
    watch : Watch
        Is told what takes long.
    factor : function, optional
        A user's, see `Factor`.

    Raises
    ------
    InputError
        A mechanism inside.
    """

    def __init__(self, stiffness: sparse.csc_array, mass: sparse.csc_array, held: NDArray,
                 means: sparse.csr_array | None = None, rigid: NDArray | None = None,
                 lengths: NDArray | None = None,
                 name: Callable[[int], str] = "row {}".format, watch: Watch = SILENT,
                 factor: Factor | None = None):
        size = stiffness.shape[0]
        self.internal = internal = np.setdiff1d(np.arange(size), held)
        self._size = size
        self._means = sparse.csr_array((0, size)) if means is None else means
        self._inner_means = self._means[:, internal]
        self._stiffness = stiffness[internal][:, internal]
        self._mass = mass[internal][:, internal]
        free = np.zeros((size, 0))
        if rigid is not None:
            free = motions_without_strain(stiffness, rigid, lengths, held)
        self._free = free[internal]
        self._lengths = (np.ones(size) if lengths is None else lengths)[internal]
        self._free = self._free / self._lengths[:, None]
        self._check_held(free[internal], name)
        watch.stage(f"factoring the stiffness of {len(internal)} DOFs")
        self._factor = FactoredStiffness(self._stiffness, free[internal],
                                         lambda row: name(internal[row]), _REMEDY, factor)
        self._border()
        self._known: tuple[NDArray, NDArray] | None = None
        self._watch = watch

    @property
    def factored_by(self) -> str:
        """Name of what has factored the stiffness."""
        return self._factor.by

    @property
    def count(self) -> int:
        """Number of independent motions with the boundary clamped."""
        return len(self.internal) - self._means.shape[0]

    def _check_held(self, free: NDArray, name: Callable[[int], str]) -> None:
        """Refuse a motion without strain, `free` in comparable units, that the means leave free."""
        if not free.shape[1]:
            return
        held = self._inner_means @ self._free
        scale = np.abs(held).max(axis=1, initial=0.0)[:, None]
        _, values, turn = linalg.svd(np.vstack([held / np.where(scale > 0, scale, 1.0),
                                                np.zeros((free.shape[1],) * 2)]))
        if values[-1] > _HELD:
            return
        largest = int(np.argmax(np.abs(free @ turn[-1])))
        raise InputError(
            "S_II is singular: with the boundary clamped the body can still move without strain "
            f"(a mechanism inside): the whole body can, most at {name(self.internal[largest])}; "
            f"{_REMEDY}")

    def _border(self) -> None:
        """Displacements by the unknowns (f, a), and the inverse of their equations."""
        count, means = self._means.shape[0], self._inner_means
        self._answers = np.hstack([self._factor.solve(means.T.toarray()), self._free])
        corner = np.zeros((self._answers.shape[1],) * 2)
        corner[:count] = means @ self._answers
        corner[count:, :count] = corner[:count, count:].T
        # rows of translations and rotations, forces and amplitudes: no one's units matter
        scale = np.ones(len(corner))
        for _ in range(4):
            largest = np.abs(scale[:, None] * corner * scale).max(axis=0, initial=0.0)
            scale /= np.sqrt(np.where(largest > 0, largest, 1.0))
        self._scale = scale
        self._corner = linalg.lu_factor(scale[:, None] * corner * scale) if len(corner) else None

    def answer(self, forces: NDArray, values: NDArray | None = None) -> tuple[NDArray, NDArray]:
        """Displacements (n, k) under forces (n, k) at means (m, k), by default 0; forces on those.

        Forces on held rows do nothing. Returns the displacements and the forces (m, k) that act on
        the means.
        """
        count = self._means.shape[0]
        inner, taken = self._inner_answer(forces[self.internal], values)
        result = np.zeros(forces.shape)
        result[self.internal] = inner
        return result, taken[:count]

    def _inner_answer(self, forces: NDArray, values: NDArray | None = None
                      ) -> tuple[NDArray, NDArray]:
        """The same of internal DOFs; forces and amplitudes (f, a)."""
        inner = self._factor.solve(forces)
        if self._corner is None:
            return inner, np.zeros((0, *forces.shape[1:]))
        missing = -(self._inner_means @ inner)
        if values is not None:
            missing = missing + values
        scale = self._scale.reshape(-1, *[1] * (forces.ndim - 1))
        unknowns = scale * linalg.lu_solve(
            self._corner, scale * np.concatenate([missing, -(self._free.T @ forces)]))
        return inner + self._answers @ unknowns, unknowns

    def displacement(self, forces: NDArray) -> NDArray:
        """Static displacement (n, k) under forces (n, k), the boundary clamped."""
        return self.answer(forces)[0]

    def vibrations(self, modes: int) -> tuple[NDArray, NDArray]:
        """Lowest modes (5): omega^2 (m,) and mass-normalised shapes (n, m).

        Raises
        ------
        InputError
            Fewer motions that carry mass.
        """
        omega_squared, shapes = self.lowest(modes)
        if len(omega_squared) < modes:
            raise InputError(
                f"modes is {modes}, but only {len(omega_squared)} internal motions carry mass; ask "
                "for fewer"
            )
        return omega_squared, shapes

    def lowest(self, modes: int) -> tuple[NDArray, NDArray]:
        """The same, or all modes if there are fewer."""
        if self._known is None or len(self._known[0]) < min(modes, self.count):
            self._known = self._computed(modes)
        shapes = np.zeros((self._size, min(modes, len(self._known[0]))))
        shapes[self.internal] = self._known[1][:, :modes]
        return self._known[0][:modes], shapes

    def _computed(self, modes: int) -> tuple[NDArray, NDArray]:
        """At least the lowest modes, of internal DOFs, in a form that a solver does not choose."""
        if not modes:
            return np.zeros(0), np.zeros((len(self.internal), 0))
        more, size = _MORE, len(self.internal)
        while True:
            wanted = min(self.count, modes + more)
            if size <= _DENSE_LIMIT or wanted >= size:
                omega_squared, inner = self._dense_modes(wanted)
            else:
                omega_squared, inner = self._sparse_modes(wanted)
            if len(omega_squared) < modes + more or not _equal(*omega_squared[[modes - 1, -1]]):
                return omega_squared, inner @ canonical_turn(omega_squared, inner)
            more *= 4

    def left_out(self, modes: int) -> int:
        """The number of modes beyond the lowest ones with the frequency of the last of these."""
        if not modes:
            return 0
        self.lowest(modes)
        values = self._known[0]
        return sum(_equal(values[modes - 1], value) for value in values[modes:])

    def _dense_modes(self, wanted: int) -> tuple[NDArray, NDArray]:
        # The inverse problem: low modes to full accuracy, and massless DOFs do no harm.
        mass, stiffness = self._mass.toarray(), self._stiffness.toarray()
        count = self._means.shape[0]
        if count:
            means = self._inner_means.T.toarray() / self._lengths[:, None]
            still = linalg.qr(means)[0][:, count:] / self._lengths[:, None]     # their means are 0
            mass, stiffness = still.T @ mass @ still, still.T @ stiffness @ still
        size = len(mass)
        inverse, shapes = linalg.eigh(mass, stiffness, subset_by_index=[size - wanted, size - 1])
        inverse, shapes = inverse[::-1], shapes[:, ::-1]
        with_mass = inverse > 1e-14 * inverse[0]
        omega_squared = 1.0 / inverse[with_mass]
        shapes = shapes[:, with_mass] * np.sqrt(omega_squared)
        return omega_squared, still @ shapes if count else shapes

    def _sparse_modes(self, wanted: int) -> tuple[NDArray, NDArray]:
        start = np.random.default_rng(0).standard_normal(len(self.internal))
        if self._corner is not None:
            start = self._inner_answer(start)[0]        # whose means are 0
        solved = count()

        def solution(force: NDArray) -> NDArray:
            self._watch.stage(f"{wanted} modes: {next(solved) + 1} static solutions")
            return self._inner_answer(force)[0]
        inverse = LinearOperator(self._stiffness.shape, solution)
        return eigsh(self._stiffness, wanted, self._mass, sigma=0.0, OPinv=inverse, v0=start)


def _equal(one: NDArray, other: NDArray) -> NDArray:
    return np.abs(one - other) <= _REPEATED * np.maximum(one, other)


def canonical_turn(values: NDArray, shapes: NDArray) -> NDArray:
    """Orthogonal turn (m, m) of shapes (n, m) that have equal values among themselves.

    What it makes of them does not depend on a solver's choices of sign and within equal values:
    each shape's largest component is positive, and the later shapes of the same value vanish
    there: a beam of square section gets modes in its principal planes.
    """
    whole = np.eye(len(values))
    gaps = ~_equal(values[1:], values[:-1])
    for group in np.split(np.arange(len(values)), np.flatnonzero(gaps) + 1):
        for position in range(len(group)):
            rest = shapes @ whole[:, group[position:]]
            row = rest[_first_largest(np.linalg.norm(rest, axis=1))]
            # Orthonormal columns, the first along `row`, so only the first shape moves there.
            turn = np.linalg.qr(np.column_stack([row, np.eye(len(row))]))[0]
            turn[:, 0] *= np.sign(turn[:, 0] @ row)
            whole[:, group[position:]] = whole[:, group[position:]] @ turn
    return whole


def _first_largest(values: NDArray) -> int:
    """Index of the first entry that equals the largest up to rounding."""
    return int(np.argmax(values >= (1 - _REPEATED) * np.max(values)))
