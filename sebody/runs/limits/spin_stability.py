"""Stiffness that a steady spin takes from one body.

In axes that spin with ``W n`` about a node of the body the kinetic energy is ``W^2`` times half a
function of the reduced coordinates y. Its second derivative D acts against the stiffness: the body
has ``S - W^2 D``, and diverges where that has no more stiffness for some motion. What D contains
depends on the inertia option:

* A and B: velocities ``n x (X + u)`` of the nodes; with B also their material angular velocities
  ``exp(-psi) n``, whose second order the momenta of the nodes multiply. In slender beams that is
  the larger part: it twists a blade with soft torsion apart.
* C: the moment of inertia of the deformed body, and with geometric stiffening the stress that the
  spin makes, by resultants and load modes.
* D: the rigid body that takes part in the deformation, whose own axes turn as the nodes' do in B.

The body is held at the node: its displacement, and, as what the frame follows is no deformation,
the rotation of the frame, or that of the node itself. A node can only hold the undeformed body in
place by itself where the axis is a principal one there; elsewhere spinning takes a moment that
bends it.
"""

from collections.abc import Callable
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from sebody.assembly.body_constants import frame_constants
from sebody.assembly.contracts import frame_counts
from sebody.assembly.floating import frame_conditions
from sebody.assembly.rigid_part_constants import rigid_part_constants
from sebody.basics.vectors import skew
from sebody.generated.options import INERTIA_OPTIONS
from sebody.model.frames import FRAMES
from sebody.model.parts import Superelement
from sebody.reduction.body import ReducedBody

ALIGNED = 1e-2      # rad: how far a principal axis may be off


class Carriers(NamedTuple):
    """Coordinates with velocities: places that move with y, rotations that may turn with it."""

    arms: NDArray           # (p, 3) from the pivot
    moved: NDArray          # (p, 3, n) displacements by y
    rotated: NDArray         # (q, 3, n) rotations by y that turn their own axes
    mass: NDArray           # (3 (p + q), 3 (p + q)) of their velocities


class Held(NamedTuple):
    """One way to hold a body."""

    pivot: NDArray          # (3,) the node that stays
    turn: NDArray           # (3, n) rotation of the whole body by y, zero if the frame is held
    free: NDArray           # (n, m) basis of the motions that are left


def softening(part: Superelement, axis: NDArray, held: Held) -> NDArray:
    """D, (n, n), for a spin about an axis, (3,): a quadratic form of it."""
    traits = INERTIA_OPTIONS[part.inertia]
    if traits.field:
        return _of_field(part, axis, held)
    carriers = (_rigid_part(part.reduced, held) if traits.rates else
                _of_nodes(part.reduced, traits.material, held))
    return _of_carriers(carriers, axis, held.turn)


def divergence(part: Superelement, axis: NDArray | None) -> float:
    """Lowest spin at which the body diverges, held in any way, infinite where it does not.

    About an axis, (3,), or at most that about any: ``y . D(n) y`` is a quadratic form of the
    products ``n_k y_i``, and the largest ratio of all such numbers to the strain energy counts.
    """
    lowest = 0.0
    for pivot in holds(part, axis):
        elastic = pivot.free.T @ part.reduced.stiffness @ pivot.free
        if axis is not None:
            soft = pivot.free.T @ softening(part, axis, pivot) @ pivot.free
        else:
            soft = _of_all_axes(part, pivot)
            elastic = np.kron(np.eye(3), elastic)
        if len(soft):
            lowest = max(lowest, eigh(soft, elastic, eigvals_only=True)[-1])
    return float(1.0 / np.sqrt(lowest)) if lowest > 0.0 else np.inf


def _of_all_axes(part: Superelement, held: Held) -> NDArray:
    """The blocks D_kl of ``D(n) = n_k n_l D_kl``, of the motions that are left, (3 m, 3 m)."""
    m, e = held.free.shape[1], np.eye(3)

    def of(axis: NDArray) -> NDArray:
        return held.free.T @ softening(part, axis, held) @ held.free
    blocks = np.zeros((3, m, 3, m))
    for k in range(3):
        blocks[k, :, k] = of(e[k])
    for k, other in combinations(range(3), 2):
        mixed = of(e[k] + e[other]) - blocks[k, :, k] - blocks[other, :, other]
        blocks[k, :, other] = blocks[other, :, k] = mixed / 2
    return blocks.reshape(3 * m, 3 * m)


def holds(part: Superelement, axis: NDArray | None) -> list[Held]:
    """Every node as the pivot, held with the frame and by itself, for an axis or for all."""
    body = part.reduced
    moved, rotated = rows_of(body)
    points = _in_space(body.coordinates)
    of_frame = _frame_rotation(part)
    holders = []
    for k, node in enumerate(body.position_nodes):
        free = null_space(np.vstack([moved[k], of_frame]))
        turns = [np.zeros((3, len(body.mass)))]
        if node in body.rotation_nodes and _principal(body, node, axis):
            turns.append(rotated[body.rotation_nodes.index(node)])
        holders += [Held(points[node], turn, free) for turn in turns]
    return holders


def _frame_rotation(part: Superelement) -> NDArray:
    """Rows that vanish where y leaves the rotation of the frame as it is, (k, n)."""
    counts = frame_counts(part)
    D, p = counts["D"], counts["N_POSITIONS"]
    conditions = frame_conditions(FRAMES[part.frame].kernel, counts, frame_constants(part))
    origin, turned = conditions[:D], conditions[D:]
    # of displacements relative to the origin, which moves with y
    return turned - turned[:, :D * p] @ np.tile(np.eye(D), (p, 1)) @ origin


def first_frequency(part: Superelement) -> float:
    """Lowest vibration with one boundary node held, of all nodes; infinite where none can move.

    A node without a rotation is held with the rotation of best fit, or where all nodes are on a
    line, which it does not see rotate about itself, with the mean of the rotations.
    """
    return _lowest(part, lambda k: part.reduced.mass)


def cautious_limit(part: Superelement) -> float:
    """A spin below the first frequency and below `divergence` about any axis, in less time.

    By half the first frequency and, where nodes turn their own axes, the largest part that their
    momenta may have in D: it is for deciding whether the limits are looked at.
    """
    body = part.reduced
    rotated = rows_of(body)[1]
    d, traits = body.coordinates.shape[1], INERTIA_OPTIONS[part.inertia]
    own_axes = traits.material and not (traits.rates or traits.field or body.planar)

    def softest(k: int) -> NDArray:
        soft = 4.0 * body.mass
        if own_axes:
            point = body.coordinates[body.position_nodes[k]]
            momenta = rotated @ (body.mass @ body.rigid_modes_about(point)[:, d:])
            for psi, p in zip(rotated, momenta, strict=True):
                soft = soft + 4.0 * np.linalg.norm(p) * psi.T @ psi
        return soft
    return _lowest(part, softest)


def _lowest(part: Superelement, inertia: Callable[[int], NDArray]) -> float:
    """Lowest frequency with the k-th position held, of all, with an inertia (n, n) for each."""
    body = part.reduced
    moved, rotated = rows_of(body)
    largest = 0.0
    for k, node in enumerate(body.position_nodes):
        if node in body.rotation_nodes:     # held coordinates are left out
            own = rotated[body.rotation_nodes.index(node)]
            free = np.eye(len(body.mass))[:, ~np.vstack([moved[k], own]).any(axis=0)]
        else:
            free = null_space(np.vstack([moved[k], _turn(body, moved, rotated)]))
        if free.shape[1]:
            largest = max(largest, eigh(free.T @ inertia(k) @ free, free.T @ body.stiffness @ free,
                                        eigvals_only=True)[-1])
    return float(1.0 / np.sqrt(largest)) if largest > 0.0 else np.inf


def reach(part: Superelement, axis: NDArray) -> float:
    """Part of a spin that stresses the body: by its moments of inertia about a node, 0 to 1.

    With an exact kinetic energy a body that spins about its own line misses no stiffening.
    """
    body, share = part.reduced, 0.0
    if body.planar or not INERTIA_OPTIONS[part.inertia].field:
        return 1.0
    for node in body.position_nodes:
        J = _moments(body, node)
        share = max(share, axis @ J @ axis / np.linalg.norm(J, 2))
    return float(np.sqrt(share))


def rows_of(body: ReducedBody) -> tuple[NDArray, NDArray]:
    """Displacements (p, 3, n) and rotations (q, 3, n) of the boundary nodes by y, in space."""
    n, d = len(body.mass), body.coordinates.shape[1]
    positions, rotations = len(body.position_nodes), len(body.rotation_nodes)
    unit = np.eye(n)
    moved, rotated = np.zeros((positions, 3, n)), np.zeros((rotations, 3, n))
    moved[:, :d] = unit[:d * positions].reshape(positions, d, n)
    axes = slice(2, 3) if body.planar else slice(0, 3)
    angles = 1 if body.planar else 3
    first = d * positions
    rotated[:, axes] = unit[first:first + angles * rotations].reshape(rotations, angles, n)
    return moved, rotated


def _principal(body: ReducedBody, node: int, axis: NDArray | None) -> bool:
    """Tell whether an axis, (3,), is a principal one about a node; None counts as one."""
    if axis is None or body.planar:
        return True
    J = _moments(body, node)
    return bool(np.linalg.norm(np.cross(axis, J @ axis)) <= ALIGNED * np.linalg.norm(J, 2))


def _moments(body: ReducedBody, node: int) -> NDArray:
    """Moments of inertia about a boundary node, (3, 3)."""
    rigid = body.rigid_modes_about(body.coordinates[node])[:, 3:]
    return rigid.T @ body.mass @ rigid


def _of_nodes(body: ReducedBody, material: bool, held: Held) -> Carriers:
    """The boundary nodes, with angular velocities in axes of the nodes (B) or of the frame (A)."""
    moved, rotated = rows_of(body)
    points = _in_space(body.coordinates[list(body.position_nodes)])
    rows = np.vstack([moved.reshape(-1, moved.shape[2]), rotated.reshape(-1, moved.shape[2])])
    return Carriers(points - held.pivot, moved, rotated if material else 0.0 * rotated,
                    rows @ body.mass @ rows.T)


def _rigid_part(body: ReducedBody, held: Held) -> Carriers:
    """The centre of mass and the mean rotation of option D."""
    rows = rigid_part_constants(body)["rigid_rows"]
    d, n = body.coordinates.shape[1], len(body.mass)
    axes = slice(2, 3) if body.planar else slice(0, 3)
    moved, rotated, mass = np.zeros((1, 3, n)), np.zeros((1, 3, n)), np.zeros((6, 6))
    moved[0, :d], rotated[0, axes] = rows[:d] / body.total_mass, rows[d:]
    rigid = body.rigid_modes_about(body.centre_of_mass)[:, d:]
    mass[:3, :3] = body.total_mass * np.eye(3)
    mass[3:, 3:][axes, axes] = rigid.T @ body.mass @ rigid
    return Carriers(_in_space(body.centre_of_mass[None]) - held.pivot, moved, rotated, mass)


def _of_carriers(carriers: Carriers, axis: NDArray, turn: NDArray) -> NDArray:
    """Second derivative of half the product of velocities with the mass, for a unit spin.

    Velocities are ``n' x (X + u)`` and ``exp(-psi) n'`` with ``n' = exp(t) n`` for a body that
    turns by -t.
    """
    across = skew(axis)
    places, angles = len(carriers.arms), len(carriers.rotated)
    rest = np.concatenate([np.cross(axis, carriers.arms).ravel(), np.tile(axis, angles)])
    tilt = -across @ turn                                   # t x n
    first = np.vstack([
        *(across @ u - skew(X) @ tilt for X, u in zip(carriers.arms, carriers.moved, strict=True)),
        *(across @ (psi - turn) for psi in carriers.rotated)])
    D = first.T @ carriers.mass @ first
    momenta = (carriers.mass @ rest).reshape(-1, 3)
    for X, u, p in zip(carriers.arms, carriers.moved, momenta[:places], strict=True):
        mixed = tilt.T @ (-skew(p) @ u)                    # p . ((t x n) x u)
        D += mixed + mixed.T + turn.T @ _twice(np.cross(X, p), axis) @ turn
    for psi, p in zip(carriers.rotated, momenta[places:], strict=True):
        mixed = tilt.T @ (-skew(p) @ psi)                  # -p . (psi x (t x n))
        D += mixed + mixed.T + psi.T @ _twice(p, axis) @ psi + turn.T @ _twice(p, axis) @ turn
    return D


def _of_field(part: Superelement, axis: NDArray, held: Held) -> NDArray:
    """Option C: of the moment of inertia ``n' . J(z) n'``, and of the stress by the spin."""
    body, d = part.reduced, part.reduced.coordinates.shape[1]
    i, n = part.invariants.about(held.pivot[:d]), len(body.mass)
    direction = axis[2:] if body.planar else axis
    h = np.einsum("k,l,kln->n", direction, direction, i.h)
    D = np.einsum("k,l,klmn->mn", direction, direction, i.J2[..., :n, :n], optimize=True)
    D = D + np.tensordot(h[n:], i.Q, 1)
    if i.resultants:
        pulled = held.free @ np.linalg.solve(held.free.T @ body.stiffness @ held.free,
                                             held.free.T @ h[:n])
        D = D - np.tensordot(i.E.T @ pulled, i.Ghat, 1)
    if body.planar:
        return D            # the spin of a plane body stays where it is
    tilt = -skew(axis) @ held.turn
    linear = np.einsum("kln,l->kn", i.h + i.h.transpose(1, 0, 2), axis)[:, :n]
    mixed = tilt.T @ linear
    return (D + mixed + mixed.T + tilt.T @ i.J0 @ tilt
            + held.turn.T @ _twice(i.J0 @ axis, axis) @ held.turn)


def _twice(p: NDArray, n: NDArray) -> NDArray:
    """H with ``t . H t / 2 = p . (t x (t x n)) / 2``."""
    return (np.outer(n, p) + np.outer(p, n)) / 2 - p @ n * np.eye(3)


def _turn(body: ReducedBody, moved: NDArray, rotated: NDArray) -> NDArray:
    """Rows of the rotation with which a node that has none is held."""
    points = body.coordinates[list(body.position_nodes)]
    on_line = np.linalg.matrix_rank(points - points.mean(axis=0), tol=1e-6 * np.abs(
        points - points.mean(axis=0)).max()) < 2
    return rotated.mean(axis=0) if on_line and len(rotated) else fit(body, moved)


def fit(body: ReducedBody, moved: NDArray) -> NDArray:
    """Rotation of the frame of best fit by small deflections, rows of ``sum X_j x u_j``."""
    points = _in_space(body.coordinates[list(body.position_nodes)])
    return np.einsum("jik,jkn->in", [skew(X) for X in points - points.mean(axis=0)], moved)


def _in_space(points: NDArray) -> NDArray:
    """Points (k, 2) or (k, 3) as (k, 3)."""
    return np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
