"""Names inside superelements: FE nodes, ``<body>.node<k>``, and outputs, ``<body>.<output>``."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sebody.quantities.algebra import total
from sebody.quantities.expressions import Number
from sebody.quantities.numbers import Numbers, Parts
from sebody.reduction.recovery import Recovery

UNITS = {"position": "length", "velocity": "length/time", "acceleration": "length/time^2",
         "displacement": "length", "stress": "force/length^2", "von_mises": "force/length^2",
         "section_forces": "force, from the fourth on force length",
         "section_strains": "1, from the fourth on 1/length"}


class FENodes:
    """Names of all FE nodes of all superelements, without a list of them.

    Nodes are named by their labels in the FE program, or by their numbers if they have none.
    """

    def __init__(self, of: Parts):
        self._bodies = {name: body.reduced.recovery for name, body in of.model.bodies.items()
                        if body.reduced.recovery is not None}

    def __contains__(self, name: str) -> bool:
        body, dot, node = name.rpartition(".node")
        if not dot or body not in self._bodies or not (node.isascii() and node.isdigit()):
            return False
        return str(int(node)) == node and number_of(self._bodies[body], int(node)) is not None

    def __iter__(self) -> Iterator[str]:
        for name, recovery in self._bodies.items():
            yield from (f"{name}.node{recovery.called(place)}"
                        for place in range(len(recovery.coordinates)))


def outputs(of: Parts) -> dict[str, NDArray]:
    """Output matrices of bodies, by ``<body>.<output>``."""
    return {f"{name}.{output}": matrix for name, body in of.model.bodies.items()
            for output, matrix in body.reduced.outputs.items()}


def output(of: Numbers, owner: str) -> list[Number]:
    """An output matrix times the reduced coordinates of its body, relative to the frame."""
    local = of.local(owner.rpartition(".")[0])
    return [total(float(x) * y for x, y in zip(row, local, strict=True) if x != 0.0)
            for row in outputs(of)[owner]]


def number_of(recovery: Recovery, node: int) -> int | None:
    """Number in the FE model of a node by its label, or number if it has none; None for no node."""
    if recovery.labels is None:
        return node if recovery.has(node) else None
    numbers = np.flatnonzero(recovery.labels == node)
    return recovery.number(int(numbers[0])) if len(numbers) else None
