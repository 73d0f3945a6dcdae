"""Bodies that are held to the ground: foundations, machine beds, jackets.

Given are stiffness K, mass M and damping C of a structure whose base is held, in the coordinates
q = (positions and rotations of the interfaces; modes). The base becomes a further interface. With
``R_i`` (n, 6), planar (n, 3), what a rigid motion of the base moves of q,

    q_rel = P y,  y = (base, q),  P = [-R_i, 1]                                  (1)
    K_free = P^T K P,  C_free = P^T C P                                          (2)
    M_free = Q^T [[M_RR, L^T], [L, M]] Q,  Q = [[1, 0], [P]]                     (3)

so that neither stiffness nor damping resists rigid motion. ``L = Phi^T M_FE R`` is the inertial
coupling with motions of the base, ``M_RR = R^T M_FE R`` the rigid mass about it. Without them
``L = M R_i`` and ``M_RR = R_i^T M R_i`` are taken, which makes M_free = diag(0, M): right as long
as the base is at rest and nothing asks for the weight.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.reduction import checks
from sebody.reduction.body import ReducedBody
from sebody.reduction.loads import named_outputs, named_vectors
from sebody.reduction.rigid_motions import rigid_motions
from sebody.reduction.summary import place

_PAIR = "give both, of the FE model with its base held, or neither"


def grounded_body(stiffness: ArrayLike, mass: ArrayLike, coordinates: ArrayLike,
                  keeps: Iterable[str] | None = None, modes: int = 0,
                  damping: ArrayLike | None = None, base: ArrayLike | None = None,
                  coupling: ArrayLike | None = None, rigid_mass: ArrayLike | None = None,
                  self_weight_stiffness: ArrayLike | None = None,
                  loads: Mapping[str, ArrayLike] | None = None, units: str = "",
                  outputs: Mapping[str, ArrayLike] | None = None) -> ReducedBody:
    """Superelement of matrices of a structure whose base is held.

    Its last boundary node is the base, which `Model.foundation` fixes.

    Parameters
    ----------
    stiffness, mass : (n, n)
        Of the interfaces' positions, in the order of the interfaces, their rotations, and modes.
    coordinates : (n_interfaces, 3), planar (n_interfaces, 2)
        Places of the interfaces [length].
    keeps : sequence of 'full', 'translation' or 'rotation', optional
        DOF blocks kept at each interface; both by default.
    modes : int
        Number of internal modes.
    damping : (n, n), optional
        The whole damping matrix, which may also damp rigid motions of the interfaces: they are
        motions relative to the ground.
    base : (3,), planar (2,), optional
        Place of the base [length], that `coupling` and `rigid_mass` refer to; the mean of the
        interfaces by default, as a base at rest may be anywhere.
    coupling : (n, 6), planar (n, 3), optional
        Inertial coupling ``Phi^T M_FE R`` with the translations and rotations of the base.
    rigid_mass : (6, 6), planar (3, 3), optional
        Rigid mass ``R^T M_FE R`` about the base. Gravity and motions of the base need both.
    self_weight_stiffness : (n, n), optional
        Geometric stiffness of the stresses of weights, see `self_weight_stiffness`: is added.
    loads : mapping of str to (n,), optional
        Loads on these coordinates by name, see `Model.body_load`.
    units : str
        Units of its numbers, such as ``m kg N s``.
    outputs : mapping of (m, n), optional
        Output matrices by name, of these coordinates: of motion relative to the base.

    Raises
    ------
    InputError
        Shapes that do not fit, entries that are not finite, asymmetric or indefinite matrices,
        coupling without rigid mass, or a stiffness that does not hold the interfaces.
    """
    points = inputs.reals(coordinates, "coordinates", "give one row of numbers per interface")
    keeps = ("full",) * len(points) if keeps is None else tuple(inputs.items(
        keeps, "keeps", "give a text per interface"))
    checks.check_layout(points, keeps)
    dimension = points.shape[1]
    modes = inputs.integer(modes, "modes", least=0)
    names = checks.coordinate_names(keeps, dimension, modes,
                                    [f"interface {k}" for k in range(len(keeps))])

    def symmetric(matrix: ArrayLike, name: str) -> NDArray:
        return checks.symmetric_matrix(matrix, name, names, points)
    K, M = symmetric(stiffness, "stiffness"), symmetric(mass, "mass")
    if self_weight_stiffness is not None:
        K = K + symmetric(self_weight_stiffness, "self_weight_stiffness")
    C = None if damping is None else symmetric(damping, "damping")
    at = points.mean(axis=0) if base is None else inputs.vector(base, "base", dimension)
    R = rigid_motions(points, keeps, len(K), at)
    checks.check_held(K, R, names)
    checks.check_positive(M, "mass", names)
    vectors = named_vectors({} if loads is None else loads, len(K), "coordinates of the interfaces")
    rows = named_outputs({} if outputs is None else outputs, len(K))
    P, whole = np.hstack([-R, np.eye(len(K))]), _whole_mass(M, R, coupling, rigid_mass, base)
    order = _order(keeps, dimension, modes)

    def free(matrix: NDArray) -> NDArray:
        return (P.T @ matrix @ P)[np.ix_(order, order)]
    coupled = coupling is not None
    return ReducedBody(
        free(K), whole[np.ix_(order, order)], np.vstack([points, at]), (*keeps, "full"), modes,
        None if C is None else free(C), base=len(points), units=units,
        loads={name: (P.T @ load)[order] for name, load in vectors.items()},
        outputs={name: (matrix @ P)[:, order] for name, matrix in rows.items()},
        notes=(f"held to the ground at {place(at)}: its base is boundary node {len(points)}",
               "with inertial coupling with its base" if coupled else
               "without inertial coupling with its base, which therefore stays at rest, and "
               "without weight"))


def _whole_mass(M: NDArray, R: NDArray, coupling: ArrayLike | None, rigid_mass: ArrayLike | None,
                base: ArrayLike | None) -> NDArray:
    """Equation (3) in the order of y; zeros of the base without coupling."""
    n, count = R.shape
    if (coupling is None) != (rigid_mass is None):
        given, missing = (("coupling", "rigid_mass") if rigid_mass is None else
                          ("rigid_mass", "coupling"))
        raise InputError(f"{given} is given without {missing}: {_PAIR}")
    if coupling is None or rigid_mass is None:
        whole = np.zeros((n + count, n + count))
        whole[count:, count:] = M
        return whole
    if base is None:
        raise InputError("coupling and rigid_mass are given without base: give the point that they "
                         "refer to")
    L = inputs.array(coupling, "coupling", (n, count))
    MR = inputs.array(rigid_mass, "rigid_mass", (count, count))
    scale = np.sqrt(np.abs(np.diag(MR)).clip(np.finfo(float).tiny))
    defect = np.abs(MR - MR.T) / np.outer(scale, scale)
    if defect.max() > checks.SYMMETRY_LIMIT:
        i, j = np.unravel_index(np.argmax(defect), defect.shape)
        raise InputError(f"rigid_mass is not symmetric: rigid_mass[{i}, {j}] = {MR[i, j]:.6g} but "
                         f"rigid_mass[{j}, {i}] = {MR[j, i]:.6g}; mirror one triangle")
    own = L - M @ R     # what moves with the base beside the interfaces' rigid motion
    corner = (MR + MR.T) / 2 - R.T @ L - L.T @ R + R.T @ M @ R
    return np.block([[corner, own.T], [own, M]])


def _order(keeps: tuple[str, ...], dimension: int, modes: int) -> NDArray:
    """Places of the body's coordinates in y: the base comes last of positions, of rotations.
    """
    turns = 1 if dimension == 2 else 3
    count = dimension + turns
    first = count + dimension * sum(keep != "rotation" for keep in keeps)
    second = first + turns * sum(keep != "translation" for keep in keeps)
    return np.r_[count:first, :dimension, first:second, dimension:count, second:second + modes]
