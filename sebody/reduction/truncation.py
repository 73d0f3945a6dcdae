"""A reduced body with fewer of its internal modes, without its FE model."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.stress import StressModes
from sebody.reduction.body import ReducedBody
from sebody.reduction.invariants import InertiaInvariants, turned_resultants
from sebody.reduction.recovery import Recovery

_NO_SHARE = 1e-6    # of a resultant in the modes that stay: what stays without it is rounding


def truncated(body: ReducedBody, modes: int) -> ReducedBody:
    """The same body with the first of its internal modes alone.

    The body is that of a reduction with fewer modes: fixed-interface modes are nested, if those of
    one frequency stay together. The static
    response of the omitted modes goes to the static shapes of the recovery. What stiffens is
    projected on the modes that stay; a new reduction may choose and turn load modes and resultants
    differently. Damping is projected, too: it is not made anew from damping ratios.

    Parameters
    ----------
    body : ReducedBody
        Its modes are in the order of the reduction, which is from the lowest frequency up.
    modes : int
        Number of modes to keep.

    Returns
    -------
    ReducedBody

    Raises
    ------
    InputError
        More modes than the body has, or no number.
    """
    inputs.instance(body, "body", ReducedBody, "give a ReducedBody")
    modes = inputs.integer(modes, "modes")
    if not 0 <= modes <= body.modes:
        raise InputError(f"modes is {modes}, but the body has {body.modes} internal modes: keep 0 "
                         f"to {body.modes}, or reduce the FE model with more")
    if modes == body.modes:
        return body
    size = len(body.stiffness) - body.modes + modes
    first = slice(0, size)
    return replace(
        body, stiffness=body.stiffness[first, first], mass=body.mass[first, first], modes=modes,
        damping=None if body.damping is None else body.damping[first, first],
        invariants=body.invariants and _truncated_invariants(body, size),
        recovery=body.recovery and _truncated_recovery(body, size),
        notes=(*body.notes, f"{modes} of {body.modes} internal modes kept"),
        loads={name: load[first] for name, load in body.loads.items()},
        outputs={name: matrix[:, first] for name, matrix in body.outputs.items()})


def _kept(size: int, before: int, count: int) -> NDArray:
    """Columns that stay of `count`: the first `size`, and those behind the reduced coordinates."""
    return np.r_[:size, before:count]


def _truncated_invariants(body: ReducedBody, size: int) -> InertiaInvariants:
    i, n = body.invariants, len(body.mass)
    kept, first = _kept(size, n, len(i.Mbar)), slice(0, size)
    lam, E, Ghat = _truncated_resultants(i, body.stiffness, size)
    return replace(
        i, S1=i.S1[:, kept], g=i.g[:, kept], h=i.h[..., kept], K=i.K[:, kept][:, :, kept],
        J2=i.J2[:, :, kept][..., kept], Mbar=i.Mbar[np.ix_(kept, kept)], Q=i.Q[:, first, first],
        lam=lam, E=E, Ghat=Ghat)


def _truncated_resultants(i: InertiaInvariants, stiffness: NDArray, size: int
                          ) -> tuple[NDArray, NDArray, NDArray]:
    """Resultants, where what they have of omitted modes gives way at once: lam, E, Ghat.

    Of resultants ``c_e + q_e`` of unit strain energy, ``q_e = y^T G_e y / 2``, the least energy of
    given coordinates that stay is ``sum_e c_e q_e + q . R q / 2`` beyond the linear one, with the
    products R of their parts in these. The eigenvectors of R make it a sum of squares again.
    """
    first, cut = slice(0, size), i.E[size:].any(axis=0)
    if not cut.any():
        return i.lam, i.E[first], i.Ghat[:, first, first]
    diagonal = np.diag(stiffness)[first]
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, np.inf))
    forces = scale[:, None] * i.E[first, cut] * np.sqrt(i.lam[cut])
    inverse = np.linalg.pinv(scale[:, None] * stiffness[first, first] * scale, rcond=1e-12,
                             hermitian=True)
    shares, turn = np.linalg.eigh(forces.T @ inverse @ forces)
    shares, turn = shares[shares > _NO_SHARE], turn[:, shares > _NO_SHARE]
    lam, E, Ghat = turned_resultants(i.lam[cut], i.E[first, cut], i.Ghat[cut, first, first], turn)
    less = np.sqrt(shares)
    return (np.concatenate([i.lam[~cut], lam]), np.hstack([i.E[first, ~cut], E / less]),
            np.concatenate([i.Ghat[~cut, first, first], less[:, None, None] * Ghat]))


def _truncated_recovery(body: ReducedBody, size: int) -> Recovery:
    recovery, n = body.recovery, len(body.stiffness)
    return replace(
        recovery, shapes=recovery.shapes[:, _kept(size, n, recovery.shapes.shape[1])],
        by=None if recovery.by is None else recovery.by[:size, :size],
        stress=tuple(replace(one, modes=one.modes[..., :size]) if isinstance(one, StressModes)
                     else one for one in recovery.stress),
        static=None if recovery.static is None else recovery.static + _static(body, size))


def _static(body: ReducedBody, size: int) -> NDArray:
    """Static responses of the omitted modes, under the loads of `Recovery.static`.

    ``sum phi (phi^T load) / omega^2``: the loads of boundary accelerations make the coupling of
    the reduced mass on the modes, those of spins make h, see `sebody.reduction.static_correction`.
    """
    recovery, left, held = body.recovery, slice(size, None), len(body.stiffness) - body.modes
    turned = np.eye(len(body.mass)) if recovery.by is None else recovery.by
    on_modes = [(turned.T @ body.mass @ turned)[left, :held], _spins(body)[left],
                np.column_stack([*body.loads.values(), np.zeros((len(body.mass), 0))])[left]]
    squares = np.diag(body.stiffness)[left]
    return recovery.shapes[:, size:len(body.mass)] @ (np.hstack(on_modes) / squares[:, None])


def _spins(body: ReducedBody) -> NDArray:
    """Loads of centripetal accelerations of unit ``w_k w_l``, k <= l, on y: (n, pairs)."""
    n, angles = len(body.mass), 1 if body.planar else 3
    pairs = [(k, m) for k in range(angles) for m in range(k, angles)]
    if body.invariants is None:
        return np.zeros((n, len(pairs)))
    invariants = body.invariants
    if body.recovery.by is not None:
        invariants = invariants.rotated(body.recovery.axes.T, body.recovery.by.T)
        middle = body.coordinates.mean(axis=0) @ body.recovery.axes
    else:
        middle = body.coordinates.mean(axis=0)
    h = invariants.about(middle).h[..., :n]
    return np.column_stack([h[k, m] if k == m else h[k, m] + h[m, k] for k, m in pairs])
