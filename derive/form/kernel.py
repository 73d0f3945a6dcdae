"""A kernel as a whole: what a target prints."""

from typing import NamedTuple

from sebody.derive.form.statements import Statement
from sebody.derive.form.whole import Count


class Operations(NamedTuple):
    """Arithmetic of one evaluation."""

    element: int
    position: int       # of each
    rotation: int       # of each
    products: int       # with n x n matrices


class Kernel(NamedTuple):
    """Statements with the arguments of `sebody.contract.layout`, and what they need.

    Counts in `known` are constants: a target prints their names or their values.
    """

    name: str
    body: tuple[Statement, ...]
    known: dict[Count, int]
    rows: int                   # of scratch memory
    squares: int                # of scratch memory, each of as many rows as coordinates
    residual: Operations
    column: Operations          # of a column of the matrix
    kept: int = 0               # numbers before the scratch memory that stay between two calls
    sizes_known: bool = False       # of the products that it calls
