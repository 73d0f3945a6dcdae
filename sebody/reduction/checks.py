"""Checks of reduced matrices. Every message names the matrix, the entry and the remedy.

Matrices are compared in unit-free form: positions, rotations and each internal mode are scaled
by the square root of their largest diagonal entry, so no verdict depends on the units. Of slender
bodies the stiffness of rotations is rounding beside what a turn about the other end would take.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

KEEPS = ("full", "translation", "rotation")
SYMMETRY_LIMIT = 1e-8
ROUNDING = 1e-14        # of the sums a reduced matrix is made of, relative to the largest of them
NEGATIVE_MASS_LIMIT = 1e-8
NEGATIVE_STIFFNESS_LIMIT = 1e-6
RIGID_LIMIT = 1e-6
_DIGITS = 1e-4      # residual of rigid motion that few printed digits may leave
HELD_LIMIT = 1e-2       # residual of rigid motions from which on a body is held, not rounded
_HELD = ("if the body is held to the ground: use grounded_body, or import the FE model free with "
         "the base as an interface; else ")


def check_layout(coordinates: NDArray, keeps: tuple[str, ...]) -> None:
    """Raise InputError unless coordinates and kept DOF blocks describe a body."""
    if coordinates.ndim != 2 or coordinates.shape[1] not in (2, 3) or not len(coordinates):
        raise InputError(
            f"coordinates have shape {coordinates.shape}; give one row per boundary node, "
            "(n_nodes, 3) or planar (n_nodes, 2)"
        )
    if not np.all(np.isfinite(coordinates)):
        node = np.argwhere(~np.isfinite(coordinates))[0][0]
        raise InputError(f"coordinates of node {node} are not finite; correct them")
    if len(keeps) != len(coordinates):
        raise InputError(
            f"keeps has {len(keeps)} entries for {len(coordinates)} boundary nodes; give one each"
        )
    for node, keep in enumerate(keeps):
        if not isinstance(keep, str) or keep not in KEEPS:
            raise InputError(f"keeps[{node}] is {keep!r}; choose one of {', '.join(KEEPS)}")
    if all(keep == "rotation" for keep in keeps):
        raise InputError(
            "no boundary node keeps its position, so the body's place is undefined; "
            "keep 'full' or 'translation' at one node at least"
        )


def check_base(base: object, keeps: tuple[str, ...]) -> None:
    """Raise InputError unless the base of a held body is a boundary node that keeps everything."""
    node = inputs.integer(base, "base", least=0, most=len(keeps) - 1,
                          remedy=f"give a boundary node, from 0 to {len(keeps) - 1}")
    if keeps[node] != "full":
        raise InputError(f"base is boundary node {node}, which keeps {keeps[node]!r}: the base of "
                         "a body held to the ground keeps position and rotation, 'full'")


def coordinate_names(keeps: tuple[str, ...], dimension: int, modes: int,
                     names: Sequence[str] = ()) -> list[str]:
    """Name of every reduced coordinate, in order: positions, rotations, internal modes.

    With the names of the boundary nodes, or their numbers.
    """
    axes, about = "xyz"[:dimension], "z" if dimension == 2 else "xyz"
    nodes = list(zip(names or [f"node {i}" for i in range(len(keeps))], keeps, strict=True))
    return (
        [f"position {a} of {name}" for name, keep in nodes if keep != "rotation" for a in axes]
        + [f"rotation {a} of {name}" for name, keep in nodes if keep != "translation"
           for a in about]
        + [f"mode {i}" for i in range(modes)]
    )


def symmetric_matrix(value: object, name: str, names: list[str], coordinates: NDArray) -> NDArray:
    """A reduced matrix without the rounding by which it is not symmetric.

    Parameters
    ----------
    value : (n, n)
    name : str
        Of the matrix, for the message.
    names : list of str
        Of the coordinates.
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        Boundary nodes.

    Raises
    ------
    InputError
        No real numbers, another size than the layout's, entries that are not finite or symmetric.
    """
    matrix = inputs.reals(value, name, "give a matrix of real numbers")
    size = len(names)
    if matrix.shape != (size, size):
        raise InputError(
            f"{name} has shape {matrix.shape}; the layout has {size} coordinates "
            "(positions, then rotations, then internal modes) and needs "
            f"({size}, {size})"
        )
    if not np.all(np.isfinite(matrix)):
        i, j = np.argwhere(~np.isfinite(matrix))[0]
        raise InputError(
            f"{name}[{i}, {j}] is {matrix[i, j]}; the matrix must be finite, export it again"
        )
    defect = asymmetry(matrix, names, coordinates)
    i, j = np.unravel_index(np.argmax(defect), defect.shape)
    if defect[i, j] > SYMMETRY_LIMIT:
        raise InputError(
            f"{name} is not symmetric: {name}[{i}, {j}] = {matrix[i, j]:.6g} but "
            f"{name}[{j}, {i}] = {matrix[j, i]:.6g} ({names[i]}, {names[j]}); "
            "export both triangles or mirror one"
        )
    return (matrix + matrix.T) / 2


def asymmetry(matrix: NDArray, names: list[str], coordinates: NDArray) -> NDArray:
    """Differences across the diagonal (n, n), relative to its entries.

    Where these are small beside the forces that a rotation by the body's length would take,
    rounding of those forces counts as part of them.
    """
    scale = unit_scale(matrix, names)
    kind = np.array([name.split()[0] for name in names])
    across = np.linalg.norm(np.ptp(coordinates, axis=0))
    turned = across * scale.max(where=kind == "position", initial=0.0)
    summed = np.where(kind == "rotation", np.maximum(scale, turned), scale)
    allowed = np.outer(scale, scale) + ROUNDING / SYMMETRY_LIMIT * np.outer(summed, summed)
    return np.abs(matrix - matrix.T) / allowed


def check_stiffness(stiffness: NDArray, rigid: NDArray, names: list[str]) -> None:
    """Raise InputError unless rigid motion costs no force and no other motion gains energy."""
    residual, row = rigid_residual(stiffness, rigid, names)
    if residual > RIGID_LIMIT:
        raise InputError(
            f"stiffness resists rigid motion: |K R| is {residual:.2e} of |K| |R| (limit "
            f"{RIGID_LIMIT:.0e}), worst in row {row} ({names[row]}); "
            + _HELD * (residual > HELD_LIMIT) + why_resisted(residual)
        )
    check_positive(stiffness, "stiffness", names)


def check_held(stiffness: NDArray, rigid: NDArray, names: list[str]) -> None:
    """Raise InputError unless a stiffness holds a body whose base is held.

    Parameters
    ----------
    stiffness : (n, n)
    rigid : (n, 6), planar (n, 3)
        Motions of the coordinates in rigid motions of the base.
    names : list of str
        Of the coordinates.
    """
    residual, _ = rigid_residual(stiffness, rigid, names)
    if residual < RIGID_LIMIT:
        raise InputError("stiffness does not resist rigid motion of the interfaces, so the "
                         "matrices are not of a body that is held to the ground: use ReducedBody, "
                         "or import the FE model")
    check_positive(stiffness, "stiffness", names)


def check_positive(matrix: NDArray, what: str, names: list[str]) -> None:
    """Raise InputError where a matrix of a held body has a negative eigenvalue."""
    value, row = _lowest(matrix, names)
    if value < -NEGATIVE_STIFFNESS_LIMIT:
        raise InputError(f"{what} has a negative eigenvalue, {value:.2e} of the largest, mostly in "
                         f"row {row} ({names[row]}); check its sign and the digits it was exported "
                         "with")


def why_resisted(residual: float, turns: bool = False, local: bool = False) -> str:
    """Reason why a stiffness may resist rigid motion by this part of its entries, and the remedy.

    Parameters
    ----------
    residual : float
    turns : bool
        Whether it resists rotations alone.
    local : bool
        Whether the forces are at few nodes.
    """
    axes = ("places of nodes, axes (systems of nodes, CD, *TRANSFORM) or the order of rows that "
            "are not those of the matrix")
    if turns:
        return ("translations are free, rotations are not, as of matrices of a prestressed state, "
                f"or of {axes}; export the matrices of the unloaded body, and check these")
    if residual < _DIGITS and not local:
        return ("as of matrices that are printed with few digits; export them with 14 digits or "
                "more before reducing, and check for soft springs to the ground")
    return (f"as of supports, springs to the ground or equations with it, or of {axes}; the body "
            "must be free, so remove them and hold it in the model")


def check_live(stiffness: NDArray, mass: NDArray, names: list[str], beside: NDArray) -> None:
    """Raise InputError where a boundary coordinate has neither stiffness nor mass.

    The coordinates `beside` (k,) may be so.
    """
    still = dead_rows((stiffness, mass), names)
    still[beside] = False
    dead = [name for name, one in zip(names, still, strict=True)
            if one and not name.startswith("mode")]
    if dead:
        shown = ", ".join(dead[:6]) + ", ..." * (len(dead) > 6)
        raise InputError(f"{shown} {'has' if len(dead) == 1 else 'have'} neither stiffness nor "
                         "mass, as rotations of nodes of solids: nothing determines how they move; "
                         "leave these rows out and keep 'translation' there")


def dead_rows(matrices: Sequence[NDArray], names: list[str]) -> NDArray:
    """Rows that are zero in all matrices, relative to the largest of their kind, (n,) of bool."""
    return np.all([np.abs(matrix / np.outer(scale, scale)).max(axis=1, initial=0.0) <= ROUNDING
                   for matrix in matrices for scale in [unit_scale(matrix, names)]], axis=0)


def check_mass(mass: NDArray, rigid: NDArray, names: list[str]) -> None:
    """Raise InputError unless the mass is semidefinite and the body has some."""
    value, row = _lowest(mass, names)
    if value < -NEGATIVE_MASS_LIMIT:
        raise InputError(
            f"mass is indefinite: eigenvalue {value:.2e} of the largest, mostly in row {row} "
            f"({names[row]}); check the matrix and the order of its rows"
        )
    translations = rigid[:, : 2 if rigid.shape[1] == 3 else 3]
    total = np.trace(translations.T @ mass @ translations)
    # of what it is the sum: modal masses are ones in all units
    added = np.trace(np.abs(translations.T) @ np.abs(mass) @ np.abs(translations))
    if total <= 1e-12 * added:
        raise InputError("the body has no mass: mass gives no inertia to a rigid translation; "
                         "give the FE model a density")


def check_damping(damping: NDArray, rigid: NDArray, names: list[str]) -> None:
    """Raise InputError unless damping takes energy out, and none out of rigid motion."""
    lowest, worst = _lowest(damping, names)
    if lowest < -NEGATIVE_STIFFNESS_LIMIT:
        raise InputError(
            f"damping is negative ({lowest:.2g} of its largest, mostly {names[worst]}), so it "
            "would put energy in; check the reduction"
        )
    residual, worst = rigid_residual(damping, rigid, names)
    if residual > RIGID_LIMIT:
        raise InputError(
            f"damping resists rigid motion ({residual:.2g}, mostly {names[worst]}); use damped(), "
            "or damping of the deformation alone"
        )


def rigid_residual(stiffness: NDArray, rigid: NDArray, names: list[str]) -> tuple[float, int]:
    """Largest ``|K r| / (|K_B| |r|)`` over the rigid modes r (columns), and its worst row.

    K_B are the columns of the boundary coordinates; all in unit-free form.
    """
    scale = unit_scale(stiffness, names)
    boundary = [not name.startswith("mode") for name in names]
    scaled = stiffness / np.outer(scale, scale)
    motion = rigid * scale[:, None]
    force = scaled @ motion
    reference = np.linalg.norm(scaled[:, boundary]) * np.linalg.norm(motion, axis=0)
    relative = np.abs(force) / np.where(reference > 0, reference, 1.0)
    row, _ = np.unravel_index(np.argmax(relative), relative.shape)
    return float(np.max(np.linalg.norm(relative, axis=0))), int(row)


def unit_scale(matrix: NDArray, names: list[str]) -> NDArray:
    """Scale (n,): root of the largest diagonal entry of positions, rotations and each mode."""
    groups = np.array([name if name.startswith("mode") else name.split()[0] for name in names])
    largest = np.ones(len(names))
    diagonal = np.diag(matrix)
    for group in dict.fromkeys(groups):
        top = np.max(diagonal[groups == group])
        largest[groups == group] = top if top > 0 else 1.0
    return np.sqrt(largest)


def _lowest(matrix: NDArray, names: list[str]) -> tuple[float, int]:
    """Lowest eigenvalue over the largest, unit-free, and the row that dominates its vector."""
    scale = unit_scale(matrix, names)
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    largest = np.max(np.abs(values))
    row = int(np.argmax(np.abs(vectors[:, 0])))
    return float(values[0] / largest) if largest > 0 else 0.0, row
