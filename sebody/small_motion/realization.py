"""Minimal and reduced state spaces, by the share that every mode has in the response.

The share of a mode with pole s and vectors l, r is the largest entry of ``(l B)(C r)``, divided by
|s|. Poles that are so near to each other that their vectors are not determined, such as those at
zero, are a block of their own, whose part is found that inputs reach and outputs show.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, matrix_balance, schur, solve_sylvester

from sebody.basics.errors import InputError

NEAR = 1e-5         # distance of poles, of the larger one or of the typical one, in one block
RANK = 1e-9         # singular value, of the largest, of a direction that is not reached


class Block(NamedTuple):
    """A part that does not act on the others."""

    A: NDArray
    B: NDArray
    C: NDArray
    names: tuple[str, ...]
    share: float        # of the response, largest
    kept: bool          # whether a reduction keeps it: a pole at zero, or an unstable one


def minimal(A: NDArray, B: NDArray, C: NDArray, D: NDArray, tolerance: float) -> dict:
    """The members of a `StateSpace` without modes of a smaller share."""
    parts = blocks(A, B, C)
    largest = max((one.share for one in parts if np.isfinite(one.share)), default=0.0)
    return joined([one for one in parts if one.share > tolerance * largest], B, C, D)


def reduced(A: NDArray, B: NDArray, C: NDArray, D: NDArray, order: int) -> dict:
    """The modes of the largest shares; the others' static response is added to D.

    Raises
    ------
    InputError
        An order that does not hold what must be kept.
    """
    ranked = sorted(blocks(A, B, C), key=lambda one: (not one.kept, -one.share))
    needed = sum(len(one.A) for one in ranked if one.kept and one.share > 0.0)
    if order < needed:
        raise InputError(f"order is {order}: poles at zero and unstable ones alone have {needed} "
                         "states, give at least these")
    kept, left, D = [], order, D.copy()
    for one in ranked:
        if len(one.A) <= left and one.share > 0.0:
            kept.append(one)
            left -= len(one.A)
        elif one.share > 0.0:
            left = 0        # of the others none is larger
            D -= one.C @ np.linalg.solve(one.A, one.B)
    return joined(kept, B, C, D)


def joined(parts: list[Block], B: NDArray, C: NDArray, D: NDArray) -> dict:
    """The members of a `StateSpace` of some blocks."""
    n = sum(len(one.A) for one in parts)
    return {"A": block_diag(*(one.A for one in parts)).reshape(n, n),
            "B": np.vstack([B[:0], *(one.B for one in parts)]),
            "C": np.hstack([C[:, :0], *(one.C for one in parts)]), "D": D,
            "states": tuple(name for one in parts for name in one.names)}


def blocks(A: NDArray, B: NDArray, C: NDArray) -> list[Block]:
    """Blocks that do not act on each other: of one pole, of a pair, or of poles that are near."""
    # states of one size: rounding is relative to the largest entry
    A, (size, _) = matrix_balance(A, permute=False, separate=True)
    parts, rest, poles = [], (A, B / size[:, None], C * size), np.linalg.eigvals(A)
    typical = float(np.median(np.abs(poles))) if len(poles) else 0.0
    for group in _near_groups(poles, typical):
        one, rest = _parted(*rest, group)
        parts += _reached(*one, typical)
    return parts + _single(*rest)


def _near_groups(poles: NDArray, size: float) -> list[NDArray]:
    """Groups of poles that are near each other, with their conjugates, except single ones.

    Poles are at zero if they are far below the typical `size`.
    """
    left, groups = list(poles), []
    while left:
        group = [left.pop()]
        for one in group:
            near = [p for p in left
                    if min(abs(p - one), abs(p - one.conjugate()))
                    <= NEAR * max(abs(p), abs(one), NEAR * size)
                    or max(abs(p), abs(one)) <= NEAR * size]
            left = [p for p in left if p not in near]
            group += near
        pair = len(group) == 2 and group[0] == group[1].conjugate() and group[0].imag != 0.0
        if len(group) > 1 and not (pair and abs(group[0]) > NEAR * size):
            groups.append(np.array(group))
    return groups


def _parted(A: NDArray, B: NDArray, C: NDArray, group: NDArray
            ) -> tuple[tuple[NDArray, ...], tuple[NDArray, ...]]:
    """The part with some poles, and the rest."""
    away = np.sort(np.abs(np.linalg.eigvals(A)[:, None] - group).min(axis=1))
    # half way to the nearest pole of the others: the poles of a group are not known well
    reach = 0.5 * (away[len(group)] + away[len(group) - 1]) if len(group) < len(A) else np.inf

    def of_group(real: float, imaginary: float = 0.0) -> bool:
        return bool(np.abs(group - complex(real, imaginary)).min() <= reach)
    T, Z, k = schur(A, output="real", sort=of_group)
    first, last = slice(0, k), slice(k, len(A))
    X = solve_sylvester(T[first, first], -T[last, last], -T[first, last])
    right = Z @ np.block([[np.eye(k), X], [np.zeros((len(A) - k, k)), np.eye(len(A) - k)]])
    left = np.block([[np.eye(k), -X], [np.zeros((len(A) - k, k)), np.eye(len(A) - k)]]) @ Z.T
    return tuple((T[part, part], left[part] @ B, C @ right[:, part]) for part in (first, last))


def _single(A: NDArray, B: NDArray, C: NDArray) -> list[Block]:
    """Blocks of single poles and pairs, in real form."""
    poles, right = np.linalg.eig(A)
    left = np.linalg.inv(right) if len(A) else right
    parts = []
    for k in np.argsort(np.abs(poles)):
        s, reached, shown = poles[k], left[k] @ B, C @ right[:, k]
        if s.imag < 0.0:
            continue
        share = np.abs(shown).max(initial=0.0) * np.abs(reached).max(initial=0.0) / abs(s)
        balance = np.sqrt(np.linalg.norm(reached) / max(np.linalg.norm(shown), 1e-300)) or 1.0
        reached, shown = reached / balance, shown * balance
        if s.imag == 0.0:
            parts.append(Block(np.array([[s.real]]), reached.real[None], shown.real[:, None],
                               (f"pole {s.real:.4g}",), share, s.real >= 0.0))
            continue
        names = tuple(f"pole {s.real:.4g} + {s.imag:.4g}i {part}" for part in ("real", "imaginary"))
        parts.append(Block(
            np.array([[s.real, s.imag], [-s.imag, s.real]]),
            np.stack([2.0 * reached.real, -2.0 * reached.imag]),
            np.stack([shown.real, shown.imag], axis=1), names, 2.0 * share,
            s.real > NEAR * abs(s)))
    return parts


def _reached(A: NDArray, B: NDArray, C: NDArray, typical: float) -> list[Block]:
    """The part of a block of near poles that inputs reach and outputs show."""
    for _ in range(2):      # what is reached, then of this what is shown: the same, transposed
        basis = _krylov(A, B)
        A, B, C = (basis.T @ A @ basis).T, (C @ basis).T, (basis.T @ B).T
    if not len(A):
        return []
    poles = np.linalg.eigvals(A)
    size = np.abs(poles).max()
    names = tuple(f"poles near {poles.mean().real:.4g} + {abs(poles.imag).max():.4g}i, {k}"
                  for k in range(len(A)))
    stays = size < NEAR * typical or poles.real.max() > NEAR * size
    return [Block(A, B, C, names, np.inf, bool(stays))]


def _krylov(A: NDArray, B: NDArray) -> NDArray:
    """Orthonormal basis, (n, k), of what the inputs reach."""
    size = max(np.linalg.norm(A), 1e-300)
    columns, parts = B / np.maximum(np.linalg.norm(B, axis=0), 1e-300), []
    for _ in range(len(A)):
        parts.append(columns)
        columns = A @ columns / size
    basis = np.hstack(parts) if parts else np.zeros((0, 1))
    U, s, _ = np.linalg.svd(basis, full_matrices=False)
    return U[:, s > RANK * s.max(initial=0.0)]
