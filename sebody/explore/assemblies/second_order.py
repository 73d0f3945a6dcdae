"""Geometric stiffness of an assembly: that of its bodies, of their turning, and of its joints.

A displacement u stresses every body by ``sigma = S_b D_b u``, every joint by its multipliers. On
motions v of the assembly these do work of second order,

    G(u)(v, v) = sum_b [ sigma . Y_b + sum_e (E_e . L_b u) Ghat_e(L_b v, L_b v)
                         - sum_s eta_s kap_s Q_s(L_b v, L_b v) ] + sum_c lambda_c g_c''    (1)

with coordinates ``L v + Y(v, v) / 2`` of a body in its frame. Its frame turns by phi, so that about
one origin, with rotation vectors psi and places X of the nodes,

    L v = D v - phi x X,   Y = phi x (phi x X) - 2 phi x u + x'',   psi:  Y = - phi x psi      (2)

where x'' is the second derivative of the place of a node on a rigid link. A turn of second order
does no work. Inertia loads p do work on the second derivative of places inside,

    W(v, v) = p . (phi x (phi x X) + 2 phi x Phi L v + Phi Y)                                  (3)

and their geometric stiffness is ``G(u_p) - W``. Slaved coordinates of the bodies are coordinates
of their own in the answers u_p.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.vectors import axes_cross
from sebody.explore.assemblies.placed_bodies import Placed
from sebody.fem.beam_elements import symmetric
from sebody.reduction.invariants import InertiaInvariants


class SecondOrder(NamedTuple):
    """Forms of one body on the kept shapes of an assembly."""

    turned: NDArray         # (n_b, n, n) Y of equation (2)
    local: NDArray          # (n_b, n) L
    work: NDArray           # (loads, n, n) W of equation (3), of unit loads


def of_body(one: Placed, own: InertiaInvariants, rows: NDArray, linked: NDArray, origin: NDArray,
            size: float) -> SecondOrder:
    """Equations (2) and (3).

    Parameters
    ----------
    own : InertiaInvariants
        About the origin.
    rows : (n_b, n)
        Motion of the coordinates of the body.
    linked : (n_b, n, n)
        Second derivatives of the places of its nodes.
    origin : (D,)
        In the coordinates of the body.
    size : float
        By which loads of turning and spinning are divided.
    """
    body, D, E = one.body, len(origin), axes_cross(np.eye(len(origin)))
    n = rows.shape[1]
    arms = body.rigid_modes_about(origin)[:, D:]
    phi = one.frame @ rows
    local = rows - arms @ phi
    Y = np.zeros((len(rows), n, n))
    for i, node in enumerate(body.position_nodes):
        at = slice(D * i, D * i + D)
        X = body.coordinates[node] - origin + one.y[at]
        twice = np.einsum("kab,lbc,c->akl", E, E, X)
        Y[at] = (np.einsum("akl,ki,lj->aij", twice, phi, phi)
                 - 2 * np.einsum("kab,ki,bj->aij", E, phi, rows[at]))
    if D == 3:
        first = D * len(body.position_nodes)
        for i in range(len(body.rotation_nodes)):
            at = slice(first + 3 * i, first + 3 * i + 3)
            Y[at] = -np.einsum("kab,ki,bj->aij", E, phi, rows[at])
    Y = symmetric(Y + linked)
    count = len(rows)
    turned = _loads_on_turned(own, E, size)[..., :count]        # (loads, r, n_b)
    work = np.einsum("cka,ki,aj->cij", turned, phi, rows + local)
    work = work + np.einsum("ca,aij->cij", unit_loads(own, size)[:, :count], Y)
    return SecondOrder(Y, local, symmetric(work))


def _isotropic(r: int) -> NDArray:
    spins = [1.0 if k == m else np.sqrt(2.0) for k in range(r) for m in range(k, r)]
    return np.array([1.0] * ((3 if r == 3 else 2) + r) + spins)


def unit_loads(own: InertiaInvariants, size: float) -> NDArray:
    """Forces on the coordinates of accelerating, turning and spinning, (loads, N)."""
    r = len(own.J0)
    spins = [(own.h[k, m] + own.h[m, k]) / (2 * size) for k in range(r) for m in range(k, r)]
    return np.vstack([own.S1, own.g / size, *spins]) * _isotropic(r)[:, None]


def _loads_on_turned(own: InertiaInvariants, E: NDArray, size: float) -> NDArray:
    """``p . A_k Phi`` of the same loads, (loads, r, N)."""
    r = len(own.J0)
    moved = np.einsum("kab,bn->akn", E, own.S1)
    if r == 1:
        spins = [-own.g[None, 0] / size]
    else:
        trace = np.einsum("kkn->n", own.h)
        N = np.eye(3)[:, :, None] * trace / 2 - own.h.transpose(1, 0, 2)    # of X_i w_j
        each = np.einsum("mai,pab,kbc,icn->mpkn", E, E, E, N, optimize=True)
        spins = [(each[k, m] + each[m, k]) / (2 * size) for k in range(r) for m in range(k, r)]
    found = np.concatenate([moved, own.h / size, np.array(spins)])
    return found * _isotropic(r)[:, None, None]


def of_point(mass: float, place: NDArray, moved: NDArray, size: float) -> NDArray:
    """Work of unit loads on the second derivative (D, n, n) of a point's place, (loads, n, n).

    Parameters
    ----------
    place : (D,)
        From the origin.
    """
    E = axes_cross(np.eye(len(place)))
    r = len(E)
    turns = np.einsum("kab,b->ka", E, place)
    spins = np.einsum("mba,kb->kma", E, turns)      # A_m^T e_k x X
    loads = np.vstack([np.eye(len(place)), turns / size, *[
        (spins[k, m] + spins[m, k]) / (2 * size) for k in range(r) for m in range(k, r)]])
    return mass * np.einsum("ca,aij->cij", loads * _isotropic(r)[:, None], moved)
