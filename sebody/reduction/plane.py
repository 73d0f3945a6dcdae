"""A body that is symmetric about a plane, restricted to motion in this plane.

Under the reflection of the plane every motion of the body is even or odd: displacements in the
plane and rotations about its normal are even, displacements along the normal and rotations about
axes in the plane odd. Matrices of a symmetric body couple even with even and odd with odd motions
alone, so even motions make a body of their own. Internal modes, load modes and stress resultants of
second order are even or odd, too, but for those of one frequency, or of one strain energy, which
are turned until they are. Displacements and stresses inside the body are kept where all its FE
nodes are in the plane.
"""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.beam_stress import BeamStress
from sebody.fem.layout import PLANAR, SPATIAL
from sebody.reduction.body import ReducedBody
from sebody.reduction.checks import coordinate_names, unit_scale
from sebody.reduction.invariants import InertiaInvariants, turned_resultants
from sebody.reduction.recovery import Recovery

_NEAR = 1e-9            # of the size of the body: nodes in the plane


def planar_recovery(body: ReducedBody, kept: NDArray, slaved: NDArray, loads: list[int]
                    ) -> Recovery | None:
    """The recovery of the even motions of a body, if all its FE nodes are in the plane.

    Parameters
    ----------
    body : ReducedBody
        In the axes of the plane, whose normal is z.
    kept : (n, n_planar)
        Old reduced coordinates of unit planar ones.
    slaved : (slaved, slaved_planar)
        The same of load modes.
    loads : list of int
        Places of the loads that are kept.

    Returns
    -------
    Recovery or None
        Its FE axes are those of the plane.
    """
    recovery = body.recovery
    if recovery is None or recovery.node_dofs != SPATIAL:
        return None
    off = recovery.points[:, 2] - body.coordinates[0, 2]
    if np.abs(off).max() > _NEAR * np.ptp(recovery.points, axis=0).max():
        return None
    n, first_mode = len(body.mass), len(body.mass) - body.modes
    # of a node: x, y and the angle by its DOFs in FE axes, and these by the former
    to_plane = block_diag(recovery.axes[:2], recovery.axes[2:])
    basis = recovery.by.T @ kept
    bound = np.count_nonzero(kept[:first_mode].any(axis=0))

    def rows(shapes: NDArray) -> NDArray:
        nodes = shapes.reshape(len(recovery.coordinates), 6, -1)
        return np.einsum("ij,njk->nik", to_plane, nodes).reshape(-1, shapes.shape[1])
    static = None
    if recovery.static is not None:
        normal = recovery.axes[2]
        pairs = [(k, m) for k in range(3) for m in range(k, 3)]
        products = np.array([normal[k] * normal[m] for k, m in pairs])
        first = first_mode + len(pairs)
        static = rows(np.hstack([recovery.static[:, :first_mode] @ basis[:first_mode, :bound],
                                 recovery.static[:, first_mode:first] @ products[:, None],
                                 recovery.static[:, first:][:, loads]]))
    return Recovery(
        rows(np.hstack([recovery.shapes[:, :n] @ basis, recovery.shapes[:, n:] @ slaved])),
        recovery.points[:, :2], PLANAR, cells=recovery.cells, labels=recovery.labels,
        outlines=None if recovery.outlines is None else recovery.outlines @ recovery.axes.T,
        stress=tuple(replace(one, forces=one.forces @ block_diag(to_plane.T, to_plane.T))
                     for one in recovery.stress if isinstance(one, BeamStress)),
        static=static, nodes=recovery.nodes)


# Couplings below this, relative to what they couple, are rounding: matrices from files have some
# eight digits. They would change motions in the plane by their squares.
_ROUNDING = 1e-6
_SECOND = 1e-3          # the same in second order: load modes of little strain energy carry more
_FLOOR = 1e-3           # of the stiffest coordinate of a kind, or the heaviest: root of a diagonal
_NONE = 1e-10           # squared couplings, relative to the largest possible: none at all
_REPEATED = 1e-6        # relative distance of squared frequencies that count as equal
AXES, TURNS = np.array([1, 1, -1]), np.array([-1, -1, 1])   # signs of vectors and of axial vectors


class PlanarBody(NamedTuple):
    """A body restricted to a plane.

    Parameters
    ----------
    body : ReducedBody
        Planar, in the axes of the plane.
    modes : (spatial modes, planar modes)
        Orthonormal: amplitudes of the spatial modes are these times those of the planar ones.
    odd_loads : tuple of str
        Loads that the planar body does not have: they push it out of the plane.
    """

    body: ReducedBody
    modes: NDArray
    odd_loads: tuple[str, ...]


class _Basis(NamedTuple):
    """Even and odd motions: new coordinates, and the sign of each."""

    turn: NDArray       # old coordinates are `turn` times the new ones
    signs: NDArray      # 1 even, -1 odd or not coupled to any other motion


def planar_body(body: ReducedBody, axes: ArrayLike, what: str = "the body") -> PlanarBody:
    """The even motions of a body about the plane of its boundary nodes.

    Displacements and stresses inside are recovered of beams, whose FE nodes are all in the plane.

    Parameters
    ----------
    body : ReducedBody
        Spatial; all its boundary nodes are in the plane.
    axes : (3, 3)
        A rotation: its columns are the x and y axes in the plane, then the normal.
    what : str
        Of messages.

    Raises
    ------
    InputError
        Matrices or constants that couple motion in the plane with motion out of it.
    """
    axes = inputs.rotation(axes, "axes of the plane")
    turned = body.rotated(axes.T)
    held = len(turned.mass) - turned.modes
    names = coordinate_names(turned.keeps, 3, turned.modes)
    boundary = np.concatenate([np.tile(AXES, len(turned.position_nodes)),
                               np.tile(TURNS, len(turned.rotation_nodes))])
    invariants = turned.invariants
    if invariants is not None:
        origin = invariants.origin.copy()
        origin[2] = turned.coordinates[:, 2].mean()
        invariants = invariants.about(origin)
    modes = _modes(turned, invariants, boundary)
    every = _Basis(block_diag(np.eye(held), modes.turn), np.concatenate([boundary, modes.signs]))
    for name in ("stiffness", "mass", "damping"):
        matrix = getattr(turned, name)
        if matrix is not None:
            _check_matrix(f"{what}: its {name} couples", every.turn.T @ matrix @ every.turn,
                          every.signs, names)
    slaved, constants = np.zeros((0, 0)), None
    if invariants is not None:
        constants, slaved = _planar_invariants(invariants, turned, every, names, what)
    odd = tuple(name for name, load in turned.loads.items()
                if _odd_load(every.turn.T @ load, every.signs, turned.stiffness))
    made = _even_body(turned, every.turn[:, every.signs > 0], odd, constants, slaved)
    return PlanarBody(made, modes.turn[:, modes.signs > 0], odd)


def _even_body(body: ReducedBody, kept: NDArray, odd: tuple[str, ...],
               constants: InertiaInvariants | None, slaved: NDArray) -> ReducedBody:
    """The body on the even coordinates, of which `kept` makes the old ones."""
    held, even = len(body.mass) - body.modes, [n for n in body.loads if n not in odd]
    stiffness, mass, damping = (
        None if matrix is None else kept.T @ matrix @ kept
        for matrix in (body.stiffness, body.mass, body.damping))
    recovery = planar_recovery(body, kept, slaved, [list(body.loads).index(name) for name in even])
    missing = dict(body.missing)
    if recovery and body.recovery.stress and not recovery.stress:
        missing["stresses"] = "a planar body keeps those of beams alone; run the spatial model"
    return ReducedBody(
        stiffness, mass, body.coordinates[:, :2], body.keeps,
        int((~kept[:held].any(axis=0)).sum()), damping, constants, recovery,
        notes=(*body.notes, "motion in a plane of symmetry"),
        loads={name: kept.T @ body.loads[name] for name in even},
        outputs={name: matrix @ kept for name, matrix in body.outputs.items()},
        missing=missing, materials=body.materials, units=body.units, base=body.base,
        paths=body.paths if recovery else {})


def _check_matrix(what: str, matrix: NDArray, signs: NDArray, names: list[str]) -> None:
    """Refuse entries between even and odd coordinates."""
    size = _sizes(matrix, names)
    odd = np.where(np.outer(signs, signs) < 0, np.abs(matrix) / np.outer(size, size), 0.0)
    i, j = sorted(np.unravel_index(np.argmax(odd), odd.shape), key=lambda k: -signs[k])
    if odd[i, j] > _ROUNDING:
        modes = any(names[k].startswith("mode") for k in (i, j))
        raise InputError(f"{what} {names[i]}, in the plane, with {names[j]}, out of it (by "
                         f"{odd[i, j]:.2g} of both; x and y are in the plane): the body is not "
                         "symmetric about the plane" + modes * (
                             ", or has a part of the modes of one frequency: keep all or none of "
                             "them"))


def _sizes(matrix: NDArray, names: list[str]) -> NDArray:
    """Roots of the diagonal, with a floor for coordinates that are much softer, or lighter."""
    names = [*names, *(f"mode slaved {k}" for k in range(len(matrix) - len(names)))]
    return np.sqrt(np.maximum(np.diag(matrix), (_FLOOR * unit_scale(matrix, names))**2))


def _odd_load(load: NDArray, signs: NDArray, stiffness: NDArray) -> bool:
    """Tell whether a load has a part out of the plane; by the stiffness forces are comparable."""
    diagonal = np.diag(stiffness)
    size = load / np.sqrt(np.maximum(diagonal, 1e-14 * diagonal.max()))
    return bool(np.abs(size[signs < 0]).max(initial=0.0) > _ROUNDING * np.abs(size).max())


def _split(rows: NDArray, signs: NDArray) -> _Basis:
    """Even and odd directions of a space, from what couples with them.

    Parameters
    ----------
    rows : (k, m)
        Couplings of k motions with the m coordinates, relative to the largest possible.
    signs : (k,)
        Of these motions: even ones couple with even directions.
    """
    values, vectors = np.linalg.eigh((rows.T * signs) @ rows)
    if not values.size:         # of a single element, whose loads need no modes
        return _Basis(vectors, values)
    order = np.argsort(-np.abs(vectors), axis=0)[0]     # as before where nothing is to be turned
    places = np.argsort(order, kind="stable")
    return _Basis(vectors[:, places], np.where(values[places] > _NONE, 1, -1))


def _couplings(body: ReducedBody, invariants: InertiaInvariants | None, mass: NDArray,
               signs: NDArray, columns: slice) -> tuple[NDArray, NDArray]:
    """Relative couplings of some coordinates with those whose signs are known, which come first."""
    known = len(signs)
    size = np.sqrt(np.where(np.diag(mass) > 0, np.diag(mass), 1.0))
    rows, of_rows = [mass[:known, columns] / size[:known, None]], [signs]
    if invariants is not None:
        i, unit = invariants, np.sqrt(np.trace(invariants.J0))
        for k in range(3):
            rows.append(i.K[k][:known, columns] / size[:known, None])
            of_rows.append(TURNS[k] * signs)
            for m in range(3):
                rows += [i.h[k, m, columns][None] / unit,
                         i.J2[k, m][:known, columns] / size[:known, None]]
                of_rows += [TURNS[[k]] * TURNS[m], TURNS[k] * TURNS[m] * signs]
    return np.vstack(rows) / size[columns], np.concatenate(of_rows)


def _modes(body: ReducedBody, invariants: InertiaInvariants | None, boundary: NDArray) -> _Basis:
    """Even and odd internal modes, those of one frequency together."""
    inner, count = len(boundary), body.modes
    rows, signs = _couplings(body, invariants, body.mass, boundary, slice(inner, inner + count))
    squares = np.diag(body.stiffness)[inner:] / np.where(
        np.diag(body.mass)[inner:] > 0, np.diag(body.mass)[inner:], 1.0)
    starts = np.flatnonzero(np.diff(squares, prepend=-np.inf) > _REPEATED * np.abs(squares))
    turns, modes = [], []
    for first, last in pairwise([*starts, count]):
        part = _split(rows[:, first:last], signs)
        turns.append(part.turn)
        modes.append(part.signs)
    if not turns:
        return _Basis(np.zeros((0, 0)), np.zeros(0, dtype=int))
    return _Basis(block_diag(*turns), np.concatenate(modes))


def _planar_invariants(i: InertiaInvariants, body: ReducedBody, every: _Basis,
                       names: list[str], what: str) -> tuple[InertiaInvariants, NDArray]:
    """Constants of the even motions, with the load modes and resultants that act on them.

    Then the old load modes of unit new ones.
    """
    turn, signs, n = every.turn, every.signs, len(every.turn)
    whole = block_diag(turn, np.eye(i.slaved))
    mass = whole.T @ i.Mbar @ whole
    i = i.rotated(np.eye(3), turn.T)
    back, slaved = _load_modes(body, i, mass, signs)
    whole = block_diag(np.eye(n), slaved.turn)
    resultants = _resultants(i, body.stiffness, signs)
    lam, E, Ghat = turned_resultants(i.lam, i.E, i.Ghat, resultants.turn)
    full = replace(
        i, S1=i.S1 @ whole, g=i.g @ whole, h=i.h @ whole, K=whole.T @ i.K @ whole,
        J2=whole.T @ i.J2 @ whole, Mbar=whole.T @ i.Mbar @ whole,
        Q=np.einsum("ab,bij->aij", back, i.Q), lam=lam, E=E, Ghat=Ghat)
    _check_constants(full, signs, slaved.signs, resultants.signs, names, what)
    even, eta = _even(full, signs, slaved.signs, resultants.signs)
    return even, slaved.turn[:, eta]


def _load_modes(body: ReducedBody, i: InertiaInvariants, mass: NDArray, signs: NDArray
                ) -> tuple[NDArray, _Basis]:
    """Even and odd load modes, of unit mass; first the inverse of their turn."""
    n, N = len(signs), len(mass)
    root = np.linalg.cholesky(mass[n:, n:])
    rows, of_rows = _couplings(body, i, mass, signs, slice(n, N))
    rows = rows * np.sqrt(np.diag(mass)[n:])        # they need another measure than their length
    split = _split(np.linalg.solve(root, rows.T).T, of_rows)
    return split.turn.T @ root.T, split._replace(turn=np.linalg.solve(root.T, split.turn))


def _resultants(i: InertiaInvariants, stiffness: NDArray, signs: NDArray) -> _Basis:
    """Even and odd stress resultants, whose squares add up to the strain energy."""
    diagonal = np.diag(stiffness)
    size = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    return _split(i.E * np.sqrt(i.lam) / size[:, None], signs)


def _check_constants(i: InertiaInvariants, signs: NDArray, slaved: NDArray, resultants: NDArray,
                     names: list[str], what: str) -> None:
    """Refuse constants that couple even with odd motions."""
    z = np.concatenate([signs, slaved])
    size = _sizes(i.Mbar, names)
    size[len(signs):] *= _SECOND / _ROUNDING
    inertia = np.sqrt(np.trace(i.J0))
    for name, array, parities, sizes in (
            ("c0", i.c0, (AXES,), (np.full(3, inertia * np.sqrt(i.mass)),)),
            ("S1", i.S1, (AXES, z), (np.full(3, np.sqrt(i.mass)), size)),
            ("J0", i.J0, (TURNS, TURNS), (np.full(3, inertia),) * 2),
            ("g", i.g, (TURNS, z), (np.full(3, inertia), size)),
            ("h", i.h, (TURNS, TURNS, z), (np.ones(3), np.full(3, inertia), size)),
            ("K", i.K, (TURNS, z, z), (np.ones(3), size, size)),
            ("J2", i.J2, (TURNS, TURNS, z, z), (np.ones(3), np.ones(3), size, size)),
            ("Q", i.Q, (slaved, signs, signs), _second_order(i.Q)),
            ("Ghat", i.Ghat, (resultants, signs, signs), _second_order(i.Ghat))):
        relative = np.abs(array) / _outer(sizes)
        odd = relative.max(initial=0.0, where=_outer(parities) < 0)
        if odd > _ROUNDING:
            raise InputError(f"{what}: {name} of its exact inertia or stiffening couples motion in "
                             f"the plane with motion out of it (by {odd:.2g} of the largest): the "
                             "body is not symmetric about the plane")


def _second_order(array: NDArray) -> tuple[NDArray, ...]:
    """Sizes of what entries of second order couple."""
    first, *others = (np.ones(size) for size in array.shape)
    return (np.abs(array).max(initial=1e-300) * _SECOND / _ROUNDING * first, *others)


def _outer(vectors: tuple[NDArray, ...]) -> NDArray:
    """Products of one entry of each vector."""
    product = np.ones(())
    for vector in vectors:
        product = np.multiply.outer(product, vector)
    return product


def _even(i: InertiaInvariants, signs: NDArray, slaved: NDArray, resultants: NDArray
          ) -> tuple[InertiaInvariants, NDArray]:
    """The part of even motions; what is of second order and does not act on them is left out.

    Then which load modes stay.
    """
    y = np.flatnonzero(signs > 0)
    Q, Ghat = (array[:, y][:, :, y] for array in (i.Q, i.Ghat))
    eta, e = (np.flatnonzero((own > 0) & (np.abs(array).max(axis=(1, 2), initial=0.0)
                                          > _ROUNDING * np.abs(whole).max(initial=1e-300)))
              for own, array, whole in ((slaved, Q, i.Q), (resultants, Ghat, i.Ghat)))
    z = np.concatenate([y, len(signs) + eta])
    pairs = np.ix_(z, z)
    return InertiaInvariants(
        i.mass, i.c0[:2], i.S1[:2, z], i.J0[2:, 2:], i.g[2:, z], i.h[2:, 2:, z],
        i.K[2:, pairs[0], pairs[1]], i.J2[2:, 2:, pairs[0], pairs[1]], i.Mbar[pairs], Q[eta],
        i.lam[e], i.E[np.ix_(y, e)], Ghat[e], i.origin[:2]), eta
