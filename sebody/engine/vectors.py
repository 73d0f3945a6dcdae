"""Vectors element by element: assignments of whole arrays take Numba seconds to compile."""

from sebody.compiler.decorators import compiled


@compiled
def copy(source, target):
    """Set a vector to the contents of another."""
    for i in range(source.size):
        target[i] = source[i]


@compiled
def swap(a, b):
    """Exchange the contents of two vectors."""
    for i in range(a.size):
        a[i], b[i] = b[i], a[i]
