"""Component modes of Craig and Bampton (section 2 of the paper).

    FE matrices -> constraint modes (2)-(4) -> fixed-interface modes (5)-(6) -> project (25), (38)
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import block_diag, eigh
from scipy.sparse.linalg import LinearOperator, SuperLU, eigsh, splu

from sebody import inputs
from sebody.errors import InputError
from sebody.fem.model import FEModel, fe_matrix
from sebody.reduction.body import ReducedBody
from sebody.reduction.checks import KEEPS

_DENSE_LIMIT = 1000  # internal DOFs up to which the dense eigenvalue solver is used
_SINGULAR = 1e-13  # ratio of pivot to diagonal entry below which the internal stiffness is singular
_ROUNDING = 1e-11  # ratio of stiffness to its summands below which stiffness is rounding error
_REPEATED = 1e-6  # relative distance below which eigenvalues or components count as equal


@dataclass(frozen=True, eq=False)
class ComponentModes:
    """Basis of the reduction, ``q = constraint @ y_B + fixed_interface @ y_I`` (10).

    Parameters
    ----------
    constraint : (n_dofs, n_boundary)
        Static modes of unit boundary coordinates (4).
    fixed_interface : (n_dofs, m)
        Vibration modes with the boundary clamped, mass-normalised (6).
    omega_squared : (m,)
        Squares of their angular frequencies [1/time^2].
    """

    constraint: NDArray
    fixed_interface: NDArray
    omega_squared: NDArray

    @property
    def basis(self) -> NDArray:
        """All modes side by side, (n_dofs, n_boundary + m)."""
        return np.hstack([self.constraint, self.fixed_interface])

    def project(self, stiffness: sparse.csc_array, mass: sparse.csc_array) -> tuple:
        """Reduced stiffness (25) and mass (38), (n, n) each, of the FE matrices."""
        static, dynamic = self.constraint, self.fixed_interface
        boundary = static.T @ (stiffness @ static)
        summands = np.abs(static).T @ (abs(stiffness) @ np.abs(static))
        if np.all(np.abs(boundary) <= _ROUNDING * summands):
            boundary[:] = 0.0  # a boundary that holds the body without strain, e.g. one node
        coupling = static.T @ (mass @ dynamic)
        reduced_mass = np.block([
            [static.T @ (mass @ static), coupling],
            [coupling.T, np.eye(dynamic.shape[1])],
        ])
        return block_diag(boundary, np.diag(self.omega_squared)), reduced_mass


def craig_bampton(
    fe_model: FEModel,
    boundary: Mapping[int, str] | Iterable[tuple[int, str]],
    modes: int,
    select: Sequence[int] | None = None,
) -> ReducedBody:
    """Superelement of an FE model; no modes gives Guyan's reduction.

    Parameters
    ----------
    fe_model : FEModel
        Free FE model.
    boundary : mapping or pairs of node index and 'full', 'translation' or 'rotation'
        Boundary nodes, in the order wanted, and the triplets kept there. A triplet not kept is
        an internal DOF.
    modes : int
        Number of fixed-interface modes, from the lowest frequency up.
    select : sequence of int, optional
        Which of these modes to keep, counted from 0; default all. Modes that the motion cannot
        excite (out of plane, torsion) can be left out.

    Raises
    ------
    InputError
        Unknown or repeated boundary node, a triplet the nodes do not have, more modes than there
        are, or boundary nodes that leave a mechanism inside.
    """
    inputs.instance(fe_model, "fe_model", FEModel, "give an FEModel")
    pairs = _boundary_pairs(fe_model, boundary)
    dofs = np.concatenate(
        [fe_model.dofs(node, "translation") for node, keep in pairs if keep != "rotation"]
        + [fe_model.dofs(node, "rotation") for node, keep in pairs if keep != "translation"]
    )
    component = component_modes(fe_model.stiffness, fe_model.mass, dofs, modes, select)
    stiffness, mass = component.project(fe_model.stiffness, fe_model.mass)
    nodes = [node for node, _ in pairs]
    keeps = tuple(keep for _, keep in pairs)
    return ReducedBody(
        stiffness, mass, fe_model.coordinates[nodes], keeps, len(component.omega_squared)
    )


def component_modes(
    stiffness: sparse.csc_array,
    mass: sparse.csc_array,
    boundary_dofs: Sequence[int],
    modes: int,
    select: Sequence[int] | None = None,
) -> ComponentModes:
    """Constraint modes (4) and fixed-interface modes (6) of FE matrices of any DOF layout.

    Parameters
    ----------
    stiffness, mass : (n_dofs, n_dofs), dense or sparse
        FE matrices.
    boundary_dofs : sequence of int
        Rows of the boundary coordinates, in the order of the reduced coordinates.
    modes, select
        As for `craig_bampton`.

    Raises
    ------
    InputError
        More modes than there are, a wrong selection, or a mechanism inside.
    """
    stiffness, mass = fe_matrix(stiffness, "stiffness"), fe_matrix(mass, "mass")
    if not stiffness.shape == mass.shape == (stiffness.shape[0],) * 2:
        raise InputError(f"stiffness has shape {stiffness.shape} and mass {mass.shape}: give "
                         "square matrices of one size")
    boundary_dofs = _boundary_rows(boundary_dofs, stiffness.shape[0])
    internal = np.setdiff1d(np.arange(stiffness.shape[0]), boundary_dofs)
    modes = inputs.integer(modes, "modes")
    if not 0 <= modes <= len(internal):
        raise InputError(
            f"modes is {modes}, but the clamped body has {len(internal)} internal DOFs; ask for "
            f"0 to {len(internal)} or refine the FE model"
        )
    chosen = list(range(modes)) if select is None else [
        inputs.integer(mode, "select: one mode") for mode in inputs.items(
            select, "select", "give a list of modes, counted from 0")]
    if len(set(chosen)) != len(chosen) or not set(chosen) <= set(range(modes)):
        raise InputError(
            f"select = {chosen} must name different modes among the {modes} computed, counted "
            "from 0; raise modes or correct it"
        )
    constraint = np.zeros((stiffness.shape[0], len(boundary_dofs)))
    constraint[boundary_dofs, np.arange(len(boundary_dofs))] = 1.0
    fixed_interface = np.zeros((stiffness.shape[0], len(chosen)))
    omega_squared = np.zeros(0)
    if len(internal):
        inner = stiffness[internal][:, internal]
        factor = _factorise(inner)
        to_boundary = stiffness[internal][:, boundary_dofs].toarray()
        constraint[internal] = -factor.solve(to_boundary)
        inner_mass = mass[internal][:, internal]
        omega_squared, shapes = _fixed_interface_modes(inner, inner_mass, factor, modes)
        fixed_interface[internal] = shapes[:, chosen]
    return ComponentModes(constraint, fixed_interface, omega_squared[chosen])


def _boundary_rows(rows: Sequence[int], size: int) -> NDArray:
    remedy = f"give different rows of the matrices, from 0 to {size - 1}"
    found = [inputs.integer(row, "boundary_dofs: one", least=0, most=size - 1, remedy=remedy)
             for row in inputs.items(rows, "boundary_dofs", remedy)]
    if len(set(found)) != len(found):
        raise inputs.refusal("boundary_dofs", found, remedy)
    return np.array(found, dtype=int)


def _boundary_pairs(fe_model: FEModel,
                    boundary: Mapping[int, str] | Iterable[tuple[int, str]]
                    ) -> list[tuple[int, str]]:
    """Boundary nodes and what they keep."""
    remedy = "give pairs (node, 'full', 'translation' or 'rotation'), or a dict of them"
    count, pairs = len(fe_model.coordinates), []
    for one in inputs.items(boundary.items() if isinstance(boundary, Mapping) else boundary,
                            "boundary", remedy):
        pair = inputs.items(one, "a boundary node", remedy)
        if len(pair) != 2:
            raise inputs.refusal("a boundary node", one, remedy)
        pairs.append((inputs.integer(pair[0], "boundary node"), pair[1]))
    if not pairs:
        raise InputError("boundary is empty; name one boundary node at least")
    nodes = [node for node, _ in pairs]
    for node, keep in pairs:
        if not 0 <= node < count:
            raise InputError(f"boundary node {node} unknown; the model has nodes 0 to {count - 1}")
        if nodes.count(node) > 1:
            raise InputError(f"boundary node {node} appears more than once; name it once")
        if not isinstance(keep, str) or keep not in KEEPS:
            raise InputError(
                f"boundary node {node} keeps {keep!r}; choose one of {', '.join(KEEPS)}"
            )
        if keep != "translation" and not len(fe_model.dofs(node, "rotation")):
            raise InputError(
                f"boundary node {node} keeps {keep!r}, but the model's nodes have no rotations; "
                "use 'translation'"
            )
    return pairs


def _factorise(stiffness: sparse.csc_array) -> SuperLU:
    """Factor the internal stiffness S_II, refusing one that leaves a motion free."""
    options = {"SymmetricMode": True}
    # SciPy 1.11 selects rows with 64-bit indices, which its SuperLU does not accept
    short = (array.astype(np.intc) for array in (stiffness.indices, stiffness.indptr))
    matrix = sparse.csc_array((stiffness.data, *short), shape=stiffness.shape)
    try:
        factor = splu(matrix, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        pivots = factor.U.diagonal()[factor.perm_c]
        weakest = np.min(pivots / stiffness.diagonal())
    except RuntimeError:  # SuperLU met a pivot of exactly zero
        weakest = 0.0
    if not weakest > _SINGULAR:
        raise InputError(
            "S_II is singular: with the boundary clamped the body can still move without strain "
            "(a mechanism inside); keep more boundary nodes or triplets, or connect loose parts"
        )
    return factor


def _fixed_interface_modes(
    stiffness: sparse.csc_array, mass: sparse.csc_array, factor: SuperLU, modes: int
) -> tuple[NDArray, NDArray]:
    """Lowest `modes` solutions of (5): omega^2 (m,) and mass-normalised shapes (n_internal, m)."""
    size = stiffness.shape[0]
    if modes == 0:
        return np.zeros(0), np.zeros((size, 0))
    wanted = min(size, modes + 4)  # a few more, so that a repeated frequency is not cut in two
    if size <= _DENSE_LIMIT or wanted >= size:
        # The inverse problem: low modes to full accuracy, and massless DOFs do no harm.
        inverse, shapes = eigh(
            mass.toarray(), stiffness.toarray(), subset_by_index=[size - wanted, size - 1]
        )
        inverse, shapes = inverse[::-1], shapes[:, ::-1]
        with_mass = inverse > 1e-14 * inverse[0]
        omega_squared = 1.0 / inverse[with_mass]
        shapes = shapes[:, with_mass] * np.sqrt(omega_squared)
    else:
        omega_squared, shapes = eigsh(
            stiffness,
            wanted,
            mass,
            sigma=0.0,
            OPinv=LinearOperator(stiffness.shape, factor.solve),
            v0=np.random.default_rng(0).standard_normal(size),
        )
    if len(omega_squared) < modes:
        raise InputError(
            f"modes is {modes}, but only {len(omega_squared)} internal motions carry mass; ask "
            "for fewer"
        )
    shapes = _canonical(omega_squared, shapes)
    return omega_squared[:modes], shapes[:, :modes]


def _canonical(omega_squared: NDArray, shapes: NDArray) -> NDArray:
    """Shapes that do not depend on the solver's choices of sign and within equal frequencies.

    Each mode's largest component is positive, and the later modes of the same frequency vanish
    there: a beam of square section gets modes in its principal planes.
    """
    shapes = shapes.copy()
    gaps = np.diff(omega_squared) > _REPEATED * omega_squared[1:]
    for group in np.split(np.arange(len(omega_squared)), np.flatnonzero(gaps) + 1):
        for position in range(len(group)):
            rest = shapes[:, group[position:]]
            row = rest[_first_largest(np.linalg.norm(rest, axis=1))]
            # Orthonormal columns, the first along `row`, so only the first mode moves there.
            turn = np.linalg.qr(np.column_stack([row, np.eye(len(row))]))[0]
            turn[:, 0] *= np.sign(turn[:, 0] @ row)
            shapes[:, group[position:]] = rest @ turn
    return shapes


def _first_largest(values: NDArray) -> int:
    """Index of the first entry that equals the largest up to rounding."""
    return int(np.argmax(values >= (1 - _REPEATED) * np.max(values)))
