"""Vectors and matrices of numbers, as lists: of histories or of symbols."""

from collections.abc import Iterable

from sebody.quantities.expressions import Matrix, Number, Vector


def total(numbers: Iterable[Number]) -> Number:
    """Sum of some numbers."""
    found: Number = 0.0
    for x in numbers:
        found = x + found
    return found


def dot(a: Vector, b: Vector) -> Number:
    """Scalar product; what is multiplied by a constant zero does not enter."""
    return total(x * y for x, y in zip(a, b, strict=True) if not (_is_zero(x) or _is_zero(y)))


def times(A: Matrix, b: Vector) -> list[Number]:
    """Matrix times vector."""
    return [dot(row, b) for row in A]


def back(A: Matrix, b: Vector) -> list[Number]:
    """Transpose of a matrix times vector."""
    return [dot([row[k] for row in A], b) for k in range(len(A[0]))]


def plus(a: Vector, b: Vector) -> list[Number]:
    """Sum of two vectors."""
    return [x + y for x, y in zip(a, b, strict=True)]


def minus(a: Vector, b: Vector) -> list[Number]:
    """Difference of two vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def scaled(factor: Number, a: Vector) -> list[Number]:
    """A vector times a number."""
    return [factor * x if not _is_zero(x) else 0.0 for x in a]


def cross(a: Vector, b: Vector) -> list[Number]:
    """Vector product in space."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def spun(spin: Vector, a: Vector) -> list[Number]:
    """Product of an angular velocity and a vector; in a plane the former is one number."""
    return cross(spin, a) if len(a) == 3 else [-(spin[0] * a[1]), spin[0] * a[0]]


def moment(arm: Vector, force: Vector) -> list[Number]:
    """Moment of a force; in a plane about its normal."""
    if len(arm) == 3:
        return cross(arm, force)
    return [arm[0] * force[1] - arm[1] * force[0]]


def _is_zero(x: Number) -> bool:
    return isinstance(x, float | int) and x == 0.0
