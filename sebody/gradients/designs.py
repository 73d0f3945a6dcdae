"""Bodies that are functions of numbers: sections and materials of beams, or any reduction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.section_along import AnySection
from sebody.model.beams import part_bodies, part_shapes
from sebody.model.model import Model
from sebody.parameters.changes import BODIES, Handle, whole_body
from sebody.reduction.body import ReducedBody


@dataclass(frozen=True, eq=False)
class Design:
    """A parameter that bodies are made of anew; takes the place of a name among parameters.

    Parameters
    ----------
    name : str
        Of the parameter, for columns.
    values : array_like
        Its numbers, at which it is differentiated; they need not be those of the model as built.
    bodies : sequence of str
        Superelements that follow.
    make : function
        Of an array of numbers: the `ReducedBody` of each superelement. It has to be smooth: of
        repeated frequencies that change places, and of modes that leave, there is no derivative,
        and the gradient is refused.

    Examples
    --------
    >>> height = Design("height", [0.03], ["rod"], lambda x: [reduced(rectangle(x[0], 0.02, ...))])
    >>> gradient(model, 0.01, 1.0, {"tip": final("tip.position")}, [height, "gravity.y"])
    """

    name: str
    values: ArrayLike
    bodies: Sequence[str]
    make: Callable[[NDArray], Sequence[ReducedBody]]

    def handle(self, model: Model) -> Handle:
        """Handle that sets the numbers of a model.

        Raises
        ------
        InputError
            Superelements that the model does not have, or a maker that is no function.
        """
        base = np.array(inputs.reals(self.values, f"values of {self.name!r}", "give numbers"),
                        dtype=float)
        names = inputs.items(self.bodies, f"bodies of {self.name!r}", "give a list of names")
        if unknown := [name for name in names if name not in model.bodies]:
            raise InputError(f"design {self.name!r}: the model has no superelement {unknown[0]!r}: "
                             f"it has {', '.join(model.bodies) or 'none'}")
        if not callable(self.make):
            raise inputs.refusal(f"make of {self.name!r}", self.make,
                                 "give a function of an array of numbers")
        remedy = "return one ReducedBody for each superelement"
        each = [whole_body(model, model.bodies[name], self.name) for name in names]

        def assign(value: NDArray) -> None:
            made = inputs.items(self.make(np.array(value)), f"what {self.name!r} makes", remedy)
            if len(made) != len(each):
                raise InputError(f"design {self.name!r}: its function made {len(made)} bodies for "
                                 f"{len(each)} superelements, {', '.join(names)}: {remedy}")
            for handle, body in zip(each, made, strict=True):
                handle.set(handle.checked(self.name, [body])[0])

        def put_back() -> None:
            for handle in reversed(each):
                handle.reset()
        return Handle(base, assign, put_back, BODIES)


def sections(model: Model, beam: str, values: ArrayLike,
             section: Callable[[NDArray], AnySection], name: str | None = None,
             held_modes: bool = True) -> Design:
    """Numbers that the section of a beam is made of: heights, walls, moduli, densities.

    Bodies are reduced anew for every number, with constraint modes of their own and, unless
    `held_modes` is false, the vibration modes of the section as built: these need not be
    differentiated, and equal frequencies, as of square sections, do no harm.

    Parameters
    ----------
    model : Model
    beam : str
        Name of a beam that was built by `Model.beam`.
    values : array_like
        The numbers, at which they are differentiated.
    section : function
        Of an array of numbers like these: the section, or a function of the place along the beam.
    name : str, optional
        Of the parameter, ``<beam>.section`` by default.
    held_modes : bool
        Whether vibration modes stay; otherwise they are those of every section, and where they
        change places there is no gradient.

    Raises
    ------
    InputError
        A beam that the model does not have.

    Examples
    --------
    >>> height = sections(model, "rod", [0.03], lambda x: rectangle(x[0], 0.02, E, nu, rho))
    """
    found = [one for one in model.beams if one.name == beam]
    if not found:
        known = ", ".join(repr(one.name) for one in model.beams) or "no beams"
        raise InputError(f"sections: there is no beam {beam!r}; the model has {known}: give a beam "
                         "that was built by model.beam, or a Design of any body")
    inputs.function(section, "sections: section", "give a function of the numbers, such as "
                                                  "lambda x: rectangle(x[0], 0.02, E, nu, rho)")
    one = found[0]
    held = None
    if inputs.flag(held_modes, "held_modes"):
        held = part_shapes(model, one, section(np.array(values, dtype=float)))
    return Design(name or f"{beam}.section", values, [part.name for part in one.parts],
                  lambda x: part_bodies(model, one, section(x), held))
