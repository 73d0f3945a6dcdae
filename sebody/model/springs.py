"""Springs and dampers of a model: between two points, about an axis, along and about all axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import chosen_name, known
from sebody.model.hinges import about, check_axes
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import check_together, pair
from sebody.model.parts import Attachment, Element, Joint, Node, positions, rotations


def spring(model: Mechanism, node: Node | str, to: Node | str, stiffness: float = 0.0,
           damping: float = 0.0, length: float | None = None, cubic: float = 0.0,
           name: str | None = None) -> Element:
    """Spring and damper between two points: ``F = k u + k3 u^3 + c u'``, u the stretch.

    Parameters
    ----------
    stiffness, damping, cubic : float
        k, c and k3 [force/length, force time/length, force/length^3].
    length : float, optional
        Length without force [length]; the initial length by default.

    Raises
    ------
    InputError
        Numbers that are negative, or nodes that coincide.
    """
    a, b = pair(model, node, known(model, to), "spring", ("position",))
    start = float(np.linalg.norm(b.point - a.point))
    if not start > 0:
        raise InputError(f"spring: nodes {a.name!r} and {b.name!r} coincide, so it has "
                         "no direction: use a bushing")
    length = start if length is None else length
    _check("spring", stiffness=stiffness, cubic=cubic, damping=damping, length=length)
    return _add(model, name, "spring", a, positions(a, b),
                {"k": stiffness, "k3": cubic, "c": damping, "length": length})


def torsion_spring(model: Mechanism, node: Joint | Node | str, stiffness: float = 0.0,
                   damping: float = 0.0, axis: ArrayLike | None = None,
                   to: Node | str | None = None, rest: float = 0.0, cubic: float = 0.0,
                   name: str | None = None) -> Element:
    """Spring and damper about the axis of a revolute joint: ``M = k u + k3 u^3 + c u'``.

    Turns are counted: in space from step to step, so in one step less than half a turn.

    Parameters
    ----------
    node : Joint, Node or str
        A revolute or cylindrical joint, which has both nodes and the axis; or the node that turns
        against `to` (the ground).
    stiffness, damping, cubic : float
        k, c and k3 [force length, force length time].
    axis : (3,), optional
        With a node: by default that of the one hinge between the nodes, or of the node; z where
        there is none.
    rest : float
        Angle of `node` against `to` without moment, zero at the start [rad].

    Raises
    ------
    InputError
        Numbers that are negative, a joint that does not turn about one axis, hinges about several
        axes, an axis that the joint between the nodes forbids.
    """
    what = "torsion spring"
    a, b, vectors = about(model, node, axis, to, what)
    rest = inputs.number(rest, f"torsion spring at {a.name!r}: rest", remedy="give a number")
    _check(what, stiffness=stiffness, cubic=cubic, damping=damping)
    constants: dict[str, float | NDArray] = {"k": stiffness, "k3": cubic, "c": damping,
                                             "rest": rest}
    if vectors:
        constants |= zip(("n", "m"), vectors[1:], strict=True)
    spring = _add(model, name, what, a, rotations(a, b), constants)
    check_axes(model, [spring])
    return spring


def bushing(model: Mechanism, node: Node | str, to: Node | str | None = None,
            stiffness: ArrayLike = 0.0, damping: ArrayLike = 0.0,
            turning_stiffness: ArrayLike = 0.0, turning_damping: ArrayLike = 0.0,
            rotation: ArrayLike | None = None, name: str | None = None) -> Element:
    """Springs and dampers along and about axes that turn with `node`, between nodes at one point.

    Each coefficient is a number, or one for each axis. Moments follow the sine of the angles:
    stay well below half a right angle.

    Parameters
    ----------
    rotation : (3, 3), planar (2, 2), optional
        Rotates the axes of space to those of the bushing at the start, its columns; by default
        they are the same.

    Raises
    ------
    InputError
        Coefficients that are negative, no rotation, or nodes that do not coincide.
    """
    a, b = pair(model, node, to, "bushing")
    check_together(model, a, b, "bushing")
    where = f"bushing at {a.name!r} has a coefficient that is negative or no number"
    lengths = (model.dimension, model.rotation_size)
    constants: dict[str, float | NDArray] = {
                 "k": _spread(stiffness, f"{where}: stiffness", lengths[0]),
                 "c": _spread(damping, f"{where}: damping", lengths[0]),
                 "kt": _spread(turning_stiffness, f"{where}: turning_stiffness", lengths[1]),
                 "ct": _spread(turning_damping, f"{where}: turning_damping", lengths[1])}
    turn = np.eye(model.dimension) if rotation is None else inputs.rotation(
        rotation, f"bushing at {a.name!r}: rotation", model.dimension)
    constants |= {f"e{k}": axis for k, axis in enumerate(turn.T, 1)}
    return _add(model, name, "bushing", a, positions(a, b) + rotations(a, b), constants)


def _add(model: Mechanism, name: str | None, what: str, a: Node,
         attachments: tuple[Attachment, ...],
         constants: dict[str, float | NDArray]) -> Element:
    name = chosen_name(model, name, f"{what} at {a.name}")
    kind = model.kind_of(what.replace(" ", "_"))
    model.loads.append(Element(name, kind, attachments, constants))
    return model.loads[-1]


def _spread(value: ArrayLike, what: str, size: int) -> NDArray:
    """A coefficient for each axis."""
    remedy = f"give one finite number >= 0, or {size}"
    given = inputs.reals(value, what, remedy)
    if given.shape not in ((), (1,), (size,)) or not (np.isfinite(given) & (given >= 0)).all():
        raise inputs.refusal(what, value, remedy)
    return np.broadcast_to(given, (size,))


def _check(what: str, **values: float) -> None:
    for name, value in values.items():
        inputs.number(value, f"{what}: {name}", least=0)
