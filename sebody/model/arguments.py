"""Checks of input: nodes, joints, vectors, names."""

from collections.abc import Collection

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.basics.warned import warn
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Element, Joint, Motion, Node, Superelement

PLANE = 1e-9        # largest part of an axis in the plane that is rounding
AXES = "x", "y", "z"
TURN = 2.0 * np.pi  # an angle beyond is warned of


def known(model: Mechanism, node: Node | str) -> Node:
    """A node of this model."""
    if not isinstance(node, Node | str):
        raise inputs.refusal("node", node, "give a node of the model or its name")
    name = node.name if isinstance(node, Node) else node
    if name not in model.nodes:
        raise unknown("node", name, model.nodes, "the model has", "the model has no nodes")
    if isinstance(node, Node) and model.nodes[name] is not node:
        raise InputError(f"node {name!r} is of another model: use that of this one")
    return model.nodes[name]


def dof_block(node: Node, kind: str) -> DofBlock:
    """A DOF block of a node, which must have it."""
    block = getattr(node, kind)
    if block is None:
        raise InputError(f"node {node.name!r} has no {kind}: make it with keeps='full'")
    return block


def vector(model: Mechanism, value: ArrayLike, what: str) -> NDArray:
    """A vector of space or of the plane."""
    return inputs.vector(value, what, model.dimension)


def rotation_vector(model: Mechanism, value: ArrayLike, what: str) -> NDArray:
    """A rotation vector, axis or angular velocity: three numbers, in a plane one."""
    if not model.planar:
        return inputs.vector(value, what, 3)
    remedy = "give 1 finite number"
    numbers = inputs.reals(value, what, remedy)
    if numbers.shape not in ((), (1,)) or not np.isfinite(numbers).all():
        raise inputs.refusal(what, value, remedy)
    return np.atleast_1d(numbers)


def named_axis(axis: ArrayLike, dimension: int, what: str) -> ArrayLike:
    """The direction that ``"x"``, ``"y"`` or ``"z"`` names, with a sign or not; others as given."""
    sign, letter = (-1.0, axis[1:]) if isinstance(axis, str) and axis[:1] == "-" else (1.0, axis)
    if isinstance(letter, str) and letter in AXES[:dimension]:
        return sign * np.eye(dimension)[AXES.index(letter)] + 0.0      # no -0
    if isinstance(axis, str):
        raise inputs.refusal(what, axis, f"give {dimension} finite numbers, or "
                                         f"{' or '.join(AXES[:dimension])}, with a minus or not")
    return axis


def direction(model: Mechanism, axis: ArrayLike, what: str, node: Node) -> NDArray:
    """Unit vector along an axis."""
    name = f"axis of the {what} at {node.name!r}"
    axis = vector(model, named_axis(axis, model.dimension, name), name)
    largest = np.abs(axis).max()
    if not largest > 0:
        raise InputError(f"{name} is zero: give its direction")
    along: NDArray = axis / largest     # squares of very large or small numbers leave the range
    return along / np.linalg.norm(along)


def axes(model: Mechanism, axis: ArrayLike, what: str,
         node: Node) -> tuple[NDArray, NDArray, NDArray]:
    """Unit vector along an axis in space and two normal to it, right-handed."""
    e = direction(model, axis, what, node)
    e = e / np.linalg.norm(e)       # the length may still be off by a rounding error
    first = np.cross(e, np.eye(3)[np.argmin(np.abs(e))])
    first /= np.linalg.norm(first)
    return e, first, np.cross(e, first)


def turning_axes(model: Mechanism, axis: ArrayLike, what: str, node: Node, signed: bool = False
                 ) -> tuple[NDArray, NDArray, NDArray] | None:
    """Axes as of `axes` of what turns; none in a plane, where the axis is normal to it.

    Parameters
    ----------
    signed : bool
        Whether it makes a difference which way the axis points.

    Raises
    ------
    InputError
        In a plane, an axis that is not normal to it or, where signs matter, points to -z.
    """
    if not model.planar:
        return axes(model, axis, what, node)
    what = f"axis of the {what} at {node.name!r}"
    axis = named_axis(axis, 3, what)
    remedy = "the model is planar, where all rotations are about (0, 0, 1): leave the axis out, "
    other = remedy + "or take a model in space, Model()"
    normal = np.array([0.0, 0.0, 1.0])
    axes_given = (inputs.number(axis, what, remedy=other) * normal if np.ndim(axis) == 0 else
                  inputs.vector(axis, what, 3, remedy=other))
    size = np.abs(axes_given).max()
    if not size > 0 or np.abs(axes_given[:2]).max() > PLANE * size:
        raise inputs.refusal(what, axis, other)
    if signed and axes_given[2] < 0:
        raise inputs.refusal(what, axis, remedy + "and change the sign of angles and torques "
                                                 "about it")
    return None


def along(model: Mechanism, axis: ArrayLike, what: str, node: Node) -> tuple[NDArray, ...]:
    """Unit vector along an axis and those normal to it: two in space, one in a plane."""
    if not model.planar:
        return axes(model, axis, what, node)
    e = direction(model, axis, what, node)
    return e, np.array([-e[1], e[0]])


def chosen_name(model: Mechanism, name: str | None, default: str,
                shares: Collection[str] = ()) -> str:
    """The name of a joint, load or drive: the given one, or the default, with a number behind it.

    The number is left out where it is one: ``spring at a``, then ``spring at a (2)``.

    Parameters
    ----------
    shares : collection of str
        See `refuse_taken`.
    """
    if name is None:
        if default in model.own_names:
            refuse_taken(model, default, default)
        while True:
            model.default_names[default] += 1
            count = model.default_names[default]
            numbered = default if count == 1 else f"{default} ({count})"
            if numbered not in model.own_names:
                return numbered
    name = inputs.name(name, f"name of the {default}")
    refuse_taken(model, name, default, shares)
    model.own_names.add(name)
    return name


def refuse_taken(model: Mechanism, name: str, what: str, shares: Collection[str] = ()) -> None:
    """Refuse a name that something else of the model has: all names are in one space.

    Parameters
    ----------
    shares : collection of str
        Kinds of things that may have the same name: of a body, joint or drive a node, and of a
        node a ``part``, which is one of these, since no quantity is one of both; of an actuator the
        signal by which a controller sets it.
    """
    if (holder := _holder(model, name, shares)) is not None:
        raise InputError(f"{what} cannot be called {name!r}: a {holder} has that name; give it its "
                         "own with name=")


def _holder(model: Mechanism, name: str, shares: Collection[str]) -> str | None:
    """In words what has a name, of what does not share it."""
    for element in model.elements():
        if element.name == name and not ("part" in shares and element not in model.loads):
            return _described(element)
    tables: dict[str, Collection[str]] = {
        "node": model.nodes, "sensor": model.sensors, "controller": model.controllers,
        "sheave": model.sheaves,
        "signal": {out for one in model.controllers.values() for out in one.outputs}}
    return next((kind for kind, names in tables.items() if kind not in shares and name in names),
                None)


def _described(element: Superelement | Element | Joint | Motion) -> str:
    return element.kind.replace("_", " ") if isinstance(element, Element) else (
        type(element).__name__.lower())


def known_joint(model: Mechanism, joint: object, what: str) -> Joint:
    """A joint of this model."""
    element = model.element(joint) if isinstance(joint, str) else joint
    if not isinstance(element, Joint) or element not in model.joints:
        raise inputs.refusal(what, joint, "give a joint of the model or its name")
    return element


def warn_of_degrees(what: str, **angles: float) -> None:
    """Warn of an angle beyond a turn, which may be one in degrees."""
    for word, limit in angles.items():
        if np.isfinite(limit) and abs(limit) > TURN:
            warn(f"{what}: {word} is {limit:g}, which is {abs(limit) / TURN:.3g} turns: angles are "
                 f"in radians, {limit:g} degrees are {np.radians(limit):.6g}")
