"""Values and gradients as functions of one vector, for optimizers of other libraries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.engine.state import Scheme
from sebody.gradients.gradient import MODES, Gradient, differentiate, fitting
from sebody.gradients.objectives import checked
from sebody.gradients.point import Point
from sebody.gradients.support import refuse_model
from sebody.model.model import Model
from sebody.model.variants.copying import copied
from sebody.runs.outputs import Output
from sebody.runs.steps import whole_steps


class ValueAndGradient:
    """A function of numbers of a model: ``f(x)`` returns a value of a run and its gradient.

    The form that ``scipy.optimize.minimize(f, f.base, jac=True)`` takes. Values that a run was
    made for last are kept: `gradient_at` of the same vector costs nothing.

    Parameters
    ----------
    model : Model
        Is copied.
    h, t_end : float
        As of `gradient`.
    objectives : mapping
        As of `gradient`. A function of one value needs one; see `gradient_at` for several.
    parameters : sequence of str
        As of `gradient`: numbers of x, in this order.
    mode : {'adjoint', 'forward'}
    scheme : Scheme, optional

    Attributes
    ----------
    base : (p,)
        The numbers in the model as built: factors count from 1.
    labels : list of str
        What the numbers are of.
    runs : int
        Runs so far.

    Raises
    ------
    InputError
        As of `gradient`.

    Examples
    --------
    >>> f = ValueAndGradient(model, 0.01, 2.0, {"miss": rms("tip.position.y")}, ["motor.table"])
    >>> found = scipy.optimize.minimize(f, f.base, jac=True)
    """

    def __init__(self, model: Model, h: float, t_end: float,
                 objectives: dict[str, Output] | Output, parameters: Sequence[str],
                 mode: str = "adjoint", scheme: Scheme | None = None):
        inputs.instance(model, "model", Model, "give a sebody.Model")
        self.model = cast(Model, copied(model))
        self.mode = inputs.choice(mode, "mode", MODES)
        self.h = inputs.number(h, "h", above=0)
        self.t_end = self.h * whole_steps(inputs.number(t_end, "t_end", above=0), self.h)
        self.outputs = checked(objectives, self.t_end)
        refuse_model(self.model)
        self.point, self.scheme = Point(self.model, parameters), fitting(scheme)
        self.base, self.labels = self.point.base, self.point.labels
        self.runs = 0
        self._last: tuple[NDArray, Gradient] | None = None

    def __call__(self, x: ArrayLike) -> tuple[float, NDArray]:
        """Value and gradient, (p,), of the only objective.

        Raises
        ------
        InputError
            Several objectives, or numbers that the model cannot have.
        SimulationError
            The run fails.
        """
        found = self.gradient_at(x)
        if len(found.value) != 1:
            raise InputError(f"the objectives have {len(found.value)} values, "
                             f"{', '.join(found.rows)}: give one number, such as a component or "
                             "norm=True, or use gradient_at")
        return float(found.value[0]), found.matrix[0]

    def gradient_at(self, x: ArrayLike) -> Gradient:
        """All objectives and their derivatives."""
        values = inputs.vector(x, "x", len(self.base),
                               remedy=f"give {len(self.base)} numbers, one for each parameter")
        if self._last is None or not np.array_equal(self._last[0], values):
            with self.point.at(values) as columns:
                found = differentiate(self.model, self.h, self.t_end, self.outputs, columns,
                                      self.mode, self.scheme)
            self.runs += 1
            self._last = values, found
        return self._last[1]
