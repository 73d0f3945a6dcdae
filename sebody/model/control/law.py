"""A control law: a function for a controller, with the numbers it is given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError


class Flow(NamedTuple):
    """The continuous form of a law.

    Attributes
    ----------
    function : callable
        ``law(t, y, x, rates, u, parameters)``.
    states : (n,)
        Its states at the start.
    parameters : (m,)
    derivatives : callable, optional
        ``derivatives(t, y, x, derivatives, parameters)``.
    at_rest : callable, optional
        Of inputs y, states from which those of rates do not move while the inputs do not.
    """

    function: Callable[..., None]
    states: NDArray
    parameters: NDArray
    derivatives: Callable[..., None] | None = None
    at_rest: Callable[[NDArray], NDArray] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Law:
    """A ready law for `Model.controller`.

    Attributes
    ----------
    title : str
    function : callable
        ``law(t, y, x, u, parameters)``.
    inputs, outputs : tuple of int, int
        How many inputs it may have, and its outputs.
    states : (n,)
        Its states at the start.
    packed : callable
        Its parameters (m,) for a period.
    flow : Flow, optional
        Its continuous form; without one it is sampled.
    refuse : callable, optional
        Raises InputError of parameters (m,) that the builder of the law refuses.
    """

    title: str
    function: Callable[..., None]
    inputs: tuple[int, ...]
    outputs: int
    states: NDArray
    packed: Callable[[float], NDArray]
    flow: Flow | None = None
    refuse: Callable[[NDArray], None] | None = None

    def __repr__(self) -> str:
        return f"<Law: {self.title}>"

    def check(self, where: str, inputs: int, outputs: int) -> None:
        """Refuse a controller with other numbers of inputs and outputs.

        Raises
        ------
        InputError
            Other numbers; the message begins with `where`.
        """
        if inputs not in self.inputs:
            wanted = " or ".join(map(str, self.inputs))
            raise InputError(f"{where} has {inputs} input{'s' * (inputs != 1)}, but {self.title} "
                             f"takes {wanted}")
        if outputs != self.outputs:
            raise InputError(f"{where} has {outputs} output{'s' * (outputs != 1)}, but "
                             f"{self.title} has {self.outputs}")


def constant(*numbers: float | NDArray) -> Callable[[float], NDArray]:
    """Parameters that do not depend on the period."""
    packed = np.concatenate([np.ravel(np.asarray(one, dtype=float)) for one in numbers]
                            or [np.zeros(0)])
    return lambda period: packed
