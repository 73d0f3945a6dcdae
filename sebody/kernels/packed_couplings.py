"""Packed matrices of products with two vectors, some of which are multiples of others.

In beams a coordinate moves the body in one direction, so rows of a matrix of couplings C are
multiples of rows of one of the matrices of moments S, and others are antisymmetric: seven of
fifteen products follow from the rest, number by number.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.contract.counts import LANES, packed_size
from sebody.kernels.packed import padded, row_of
from sebody.kernels.packed_groups import MULTIPLE, Group, alone, coupled, mirrored

ROUNDING = 1e-11        # of what entries can be; in rows that are multiples some 2e-13 is left


def pack_couplings(squares: NDArray, couplings: NDArray) -> NDArray:
    """The row of products with two vectors x and y: ``S x``, ``C x``, ``C y``, ``C^T y``.

    Behind these are products of y with the last S, as many as there are C: others are made from
    them.

    Parameters
    ----------
    squares : (squares, N, N)
        Symmetric matrices S, at least as many as C.
    couplings : (couplings, N, N)
        Matrices C.
    """
    S, C = (padded(stack, stack.shape) for stack in (squares, couplings))
    first, count, height = len(S), len(C), S.shape[1]
    size = packed_size(first + 3 * count, *squares.shape[1:])
    across, of_both = C.transpose(0, 2, 1).copy(), np.zeros_like(S)
    multiples = _take_multiples(S, C, across, of_both)
    alike = ~across.any(axis=(1, 2))            # their transposes are not needed
    others = np.where(alike[:, np.newaxis, np.newaxis], 0.0, C)
    C[~alike] = 0.0
    groups = [*mirrored(S), *coupled(others, first), *alone(S), *alone(of_both, behind=4 * count)]
    groups += alone(C + others, first, behind=count)
    groups += alone(others.transpose(0, 2, 1), first + 2 * count, vector=1)
    groups += [Group(MULTIPLE, height * place, height * other, (), factors.reshape(-1, 1, LANES))
               for place, other, factors in sorted(multiples, key=lambda one: one[0])]
    return row_of(groups, size)


def _take_multiples(S: NDArray, C: NDArray, across: NDArray, of_both: NDArray
                    ) -> list[tuple[int, int, NDArray]]:
    """Take matrices whose products are multiples out of C and of their transposes.

    And those out of S that multiply both vectors for their sake. Returned are the numbers of each
    product and of the other one, and the factors.
    """
    first, count, found = len(S), len(C), []
    scale = np.sqrt(np.abs(np.diagonal(S, axis1=1, axis2=2)).sum(axis=0))
    for k in range(count):
        of_x, of_y, of_transpose = range(first + k, first + k + 3 * count, count)
        for q in range(first - count, first):
            rows, columns = (_factors(A, S[q], scale) for A in (C[k], across[k]))
            if rows is not None and columns is not None:
                behind = q + 4 * count
                found += [(of_x, q, rows), (of_y, behind, rows), (of_transpose, behind, columns)]
                of_both[q], C[k], across[k] = S[q], 0.0, 0.0
                break
        else:
            columns = _factors(across[k], C[k], scale)
            if columns is not None:
                found.append((of_transpose, of_y, columns))
                across[k] = 0.0
    S[of_both.any(axis=(1, 2))] = 0.0
    return found


def _factors(matrix: NDArray, other: NDArray, scale: NDArray) -> NDArray | None:
    """By which rows of a matrix are multiples of those of another one; None if they are not.

    `scale` has units of the coordinates: what an entry can be is a product of two of them.
    """
    if not matrix.any() or ((matrix != 0.0) & (other == 0.0)).any():
        return None
    unit = np.where(scale > 0.0, scale, 1.0)
    A, B = matrix / unit, other / unit
    squares = (B * B).sum(axis=1)
    factors = (A * B).sum(axis=1) / np.where(squares > 0.0, squares, 1.0)
    left, sizes = (np.abs(M) / unit[:, np.newaxis] for M in (A - factors[:, np.newaxis] * B, A))
    return factors if (left <= ROUNDING * sizes.max()).all() else None
