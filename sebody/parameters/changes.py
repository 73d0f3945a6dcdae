"""Changes of a model that is built: how each quantity of a part is set and put back."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.close_rows import Grid
from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.model import Model
from sebody.model.parts import COUPLING, DofBlock, Element, Joint, Node, Superelement
from sebody.model.variants.copying import exchange
from sebody.reduction.body import ReducedBody
from sebody.reduction.scaling import scaled

MOTION, BODIES, LOADS = "motion", "bodies", "loads"     # what a change has an effect on


@dataclass(frozen=True)
class Handle:
    """A quantity of a model that can be set.

    Parameters
    ----------
    base : ndarray or ReducedBody
        Its value in the model as built.
    set : function
        Sets a value.
    reset : function
        Puts back what was there.
    touches : str
        MOTION where initial velocities may have to be fitted anew, BODIES where masses change the
        fit, LOADS where neither.
    least, above, most : float, optional
        Bounds of the values.
    as_built : function, optional
        Sets a value with the pattern of the model as built, for steps of a grid: a table keeps its
        corners, which follow from its values. Raises InputError if runs need another pattern.
    """

    base: Any
    set: Callable[[Any], None]
    reset: Callable[[], None]
    touches: str
    least: float | None = None
    above: float | None = None
    most: float | None = None
    as_built: Callable[[Any, Grid | None], None] | None = None

    @property
    def whole(self) -> bool:
        """Tell whether the values are objects."""
        return not isinstance(self.base, np.ndarray)

    def part(self, components: int | list[int]) -> "Handle":
        """Handle of some of the numbers, in this order; the others are those as built."""
        def whole(value: NDArray) -> NDArray:
            found = np.array(self.base, dtype=float)
            found.reshape(-1)[components] = value
            return found
        as_built = self.as_built
        return replace(
            self, base=np.asarray(np.array(self.base, dtype=float).reshape(-1)[components]),
            set=lambda value: self.set(whole(value)), as_built=None if as_built is None else
            lambda value, grid: as_built(whole(value), grid))

    def checked(self, name: str, values: Any) -> Any:
        """Values of some runs, (runs, *shape), or objects.

        Raises
        ------
        InputError
            Another shape, or a value outside the bounds.
        """
        if self.whole:
            found = inputs.items(values, name, "give a list of ReducedBody objects")
            for one in found:
                inputs.instance(one, f"{name}: one", ReducedBody, "give ReducedBody objects")
            return found
        remedy = "give " + (f"an array (runs, {', '.join(map(str, self.base.shape))})"
                            if self.base.shape else "one number for each run")
        found = inputs.array(values, name, (None, *self.base.shape), remedy=remedy)
        self.refuse(found, name, of_runs=True)
        return found

    def refuse(self, values: NDArray, name: str, remedy: str = "", of_runs: bool = False) -> None:
        """Refuse values outside the bounds, (runs, *shape); perhaps by the number of the run.

        Raises
        ------
        InputError
        """
        for bound, wrong, wanted in ((self.least, np.less, "at least"),
                                     (self.above, np.less_equal, "above"),
                                     (self.most, np.greater, "at most")):
            if bound is None or not (runs := np.argwhere(wrong(values, bound))).size:
                continue
            run = int(runs[0][0])
            raise InputError(f"{name}{f' of run {run}' * of_runs} is {inputs.shown(values[run])}: "
                             f"it must be {wanted} {bound:g}{remedy}")


def attribute_of(owner: object, attribute: str, touches: str, base: NDArray | None = None,
               made: Callable[[NDArray], Any] = np.array, **bounds: float) -> Handle:
    """Handle of an attribute that is replaced by ``made(value)``."""
    before = getattr(owner, attribute)
    return Handle(np.array(before, dtype=float) if base is None else base,
                  lambda value: setattr(owner, attribute, made(value)),
                  lambda: setattr(owner, attribute, before), touches, **bounds)


def constants_of(element: Element, made: Callable[[NDArray], dict], touches: str,
               base: NDArray, **bounds: float) -> Handle:
    """Handle of some constants of an element; other handles may have set others."""
    before = element.constants

    def assign(value: NDArray) -> None:
        element.constants = {**element.constants, **made(value)}

    def put_back() -> None:
        element.constants = before
    return Handle(base, assign, put_back, touches, **bounds)


def gravity(model: Model) -> Handle:
    """Acceleration of free fall; of a field with an amplitude the field.

    Raises
    ------
    InputError
        Gravity of several functions of time.
    """
    if len(model.gravity_courses) > 1:
        raise InputError("gravity has components that are functions of time, so no number of it "
                         "can be varied: give model.gravity a field and its amplitude")
    if model.gravity_courses:
        return attribute_of(model.gravity_courses[0], "direction", LOADS)
    return attribute_of(model, "gravity_field", LOADS)


# nodes and joints


def position(model: Model, node: Node, name: str) -> Handle:
    """Initial position."""
    return attribute_of(_dof_block(node, "position", name), "start", MOTION)


def rotation(model: Model, node: Node, name: str) -> Handle:
    """Initial rotation."""
    return attribute_of(_dof_block(node, "rotation", name), "start", MOTION)


def velocity(model: Model, node: Node, name: str) -> Handle:
    """Initial velocity."""
    return _rate(_dof_block(node, "position", name), name)


def angular_velocity(model: Model, node: Node, name: str) -> Handle:
    """Initial angular velocity."""
    return _rate(_dof_block(node, "rotation", name), name)


def joint_position(model: Model, joint: Joint, name: str) -> Handle:
    """The place where a joint with the ground holds its node."""
    fixed, own = joint.to.position, joint.node.position
    if joint.kind == COUPLING:
        raise InputError(f"{name}: {joint.name!r} is a coupling, which holds no position: vary "
                         f"{joint.name}.ratio")
    if joint.to not in model.grounds or fixed is None:
        raise InputError(f"{name}: joint {joint.name!r} is not to the ground, so its position "
                         "follows from its bodies: vary positions of nodes, or build the model "
                         "anew")
    if any(fixed in one.dof_blocks for one in joint.constraints):
        return attribute_of(fixed, "start", MOTION)
    for one in joint.constraints:
        if one.kind.endswith("coincident_ground"):
            return constants_of(one, lambda place: {"c": place}, MOTION,
                              np.array(one.constants["c"], dtype=float))
    if joint.kind == "drive" or own is None or not own.fixed:
        raise InputError(f"{name}: {joint.name!r} holds no position: vary that of its node")
    return attribute_of(own, "start", MOTION)     # the joint has no equations for it


def _dof_block(node: Node, kind: str, name: str) -> DofBlock:
    found = getattr(node, kind)
    if found is None:
        raise InputError(f"{name}: node {node.name!r} has no {kind}; give another node")
    if found.root is not None:
        raise InputError(f"{name}: node {node.name!r} is at the end of a rigid link: vary "
                         f"{found.root.name} and its rotation")
    return found


def _rate(dof_block: DofBlock, name: str) -> Handle:
    if dof_block.fixed:
        raise InputError(f"{name}: {dof_block.name} is fixed or moved: vary its drive")
    base, given = dof_block.rate, dof_block.given

    def assign(rate: NDArray, is_given: bool) -> None:
        dof_block.rate, dof_block.given = rate, is_given
    return Handle(np.array(base, dtype=float), lambda value: assign(np.array(value), True),
                  lambda: assign(base, given), MOTION)


# bodies


def body_factor(quantity: str) -> Callable[[Model, Superelement, str], Handle]:
    """Handle of a factor of stiffness, mass or damping; those of one body add up."""
    def make(model: Model, body: Superelement, name: str) -> Handle:
        if quantity == "damping" and body.reduced.damping is None:
            raise InputError(f"{name}: superelement {body.name!r} has no damping to scale: build "
                             "it from body.damped(...)")
        before = body.reduced

        def assign(value: NDArray) -> None:
            placed = model.bodies[body.name]        # perhaps with another body
            placed.reduced = scaled(placed.reduced, **{quantity: float(value)})

        def put_back() -> None:
            body.reduced = before
        bound = {"least": 0.0} if quantity == "damping" else {"above": 0.0}
        return Handle(np.array(1.0), assign, put_back, BODIES, **bound)
    return make


def whole_body(model: Model, body: Superelement, name: str) -> Handle:
    """Another reduced body in the place of a superelement's."""
    if any(load.body is body for load in model.loads):
        raise InputError(f"{name}: superelement {body.name!r} has loads of its own, whose vectors "
                         "belong to its body: build a model for each body")
    bodies = dict(model.bodies)

    def assign(value: ReducedBody) -> None:
        _check_like(name, value, body.reduced)
        exchange(model, body, value, body.frame, body.inertia, body.stiffening)

    def put_back() -> None:
        model.bodies = dict(bodies)
        model.own_names.add(body.name)
    return Handle(body.reduced, assign, put_back, BODIES)


def _check_like(name: str, value: ReducedBody, base: ReducedBody) -> None:
    for what in ("keeps", "modes"):
        own, wanted = getattr(value, what), getattr(base, what)
        if own != wanted:
            raise InputError(f"{name}: one has {what} {own}, the model's {wanted}: give bodies of "
                             "one layout, or build a model for each")


def rigid_mass(model: Model, body: Element, name: str) -> Handle:
    """Factor of the mass and inertia of a rigid body."""
    before = body.constants
    return constants_of(body, lambda factor: {k: factor * np.asarray(v) for k, v in before.items()},
                      BODIES, np.array(1.0), above=0.0)
