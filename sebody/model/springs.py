"""Springs and dampers of a model: between two points, along a path, about an axis."""

from __future__ import annotations

from typing import Unpack, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, known, warn_of_degrees
from sebody.model.hinges import about, check_axes
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import pair
from sebody.model.parts import Attachment, Element, Joint, Node, positions, rotations
from sebody.model.special_laws import Special, check
from sebody.model.spring_laws import Given


def spring(model: Mechanism, node: Joint | Node | str, to: Node | str | None = None,
           stiffness: float = 0.0, damping: float | Given = 0.0, length: float | None = None,
           cubic: float = 0.0, name: str | None = None, force: Given | None = None,
           gap: float = 0.0, tension_only: bool = False, preload: float = 0.0,
           between: ArrayLike | None = None, **acting: Unpack[Acting]) -> Element:
    """Spring and damper between two points: ``F = k u + k3 u^3 + c u'``, u the stretch.

    In place of the stiffness a `force` may be given by a table of the stretch, and a `damping` by
    one of its rate: monotone cubics between the rows, of which the energy is the exact integral.

    Parameters
    ----------
    node : Node, str or Joint
        Also a joint on a path, without `to`: the spring then acts along the path, on its way.
    to : Node or str
    stiffness, damping, cubic : float
        k, c and k3 [force/length, force time/length, force/length^3].
    length : float, optional
        Length without force [length], along a path the way; that of the start by default.
    force, damping : table, path of a CSV file, or function
        Rows (stretch, force) or (rate, force), 2 to 65; beyond the ends with the slope there. A
        function is read at 63 places.
    gap : float
        Stretch, of either sign, that takes no force [length].
    tension_only : bool
        Whether it never pushes, as a rope does.
    preload : float
        Force that is added: that without stretch [force].
    between : (2,)
        Of a function `force`: stretches between which it is read.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Numbers that are negative, or nodes that coincide.
    """
    joint = _joint_on_path(model, node)
    if joint is not None and to is None:
        if Special(force, damping, gap, tension_only, preload, between).given:
            raise InputError(f"spring of {joint.name!r} acts along its path: give it stiffness, "
                             "cubic and damping, tables are of springs between nodes")
        return _way_spring(model, joint, stiffness, cast(float, damping), length, cubic, name)
    if joint is not None:
        raise InputError(f"spring of {joint.name!r} acts along its path and has the node "
                         f"{getattr(to, 'name', to)!r}: leave to= out, or give two nodes")
    if to is None or isinstance(node, Joint):
        raise InputError(f"spring at {getattr(node, 'name', node)!r} has one end: give to=, the "
                         "node at the other one, or a joint on a path, along which it acts")
    a, b = pair(model, node, known(model, to), "spring", ("position",))
    start = float(np.linalg.norm(b.point - a.point))
    if not start > 0:
        raise InputError(f"spring: nodes {a.name!r} and {b.name!r} coincide, so it has "
                         "no direction: use a bushing")
    length = start if length is None else length
    law = Special(force, damping, gap, tension_only, preload, between)
    if law.given:
        check("spring", length=length)
        tables = law.tables(f"spring at {a.name!r}", stiffness, cubic)
        return _add(model, name, "spring", a, positions(a, b), {"length": length} | tables,
                    "table_spring")
    damping = cast(float, damping)
    check("spring", stiffness=stiffness, cubic=cubic, damping=damping, length=length)
    return _add(model, name, "spring", a, positions(a, b),
                {"k": stiffness, "k3": cubic, "c": damping, "length": length})


def _joint_on_path(model: Mechanism, given: Joint | Node | str) -> Joint | None:
    """A joint of the model that is on a path; none of anything else."""
    return next((one for one in model.joints if one.kind == "path" and (
        one is given or isinstance(given, str) and one.name == given
        and given not in model.nodes)), None)


def _way_spring(model: Mechanism, joint: Joint, stiffness: float, damping: float,
                length: float | None, cubic: float, name: str | None) -> Element:
    """Spring along a path."""
    what, place = f"spring of {joint.name!r}", joint.constraints[0].attachments[-1]
    at = place.dof_block.start[0] if length is None else inputs.number(length, f"{what}: length")
    check(what, stiffness=stiffness, cubic=cubic, damping=damping)
    name = chosen_name(model, name, f"spring of {joint.name}")
    model.loads.append(Element(name, "way_spring", (place,), {
        "k": stiffness, "k3": cubic, "c": damping, "length": float(at)}))
    return model.loads[-1]


def torsion_spring(model: Mechanism, node: Joint | Node | str, stiffness: float = 0.0,
                   damping: float | Given = 0.0, axis: ArrayLike | None = None,
                   to: Node | str | None = None, rest: float = 0.0, cubic: float = 0.0,
                   name: str | None = None, force: Given | None = None, gap: float = 0.0,
                   tension_only: bool = False, preload: float = 0.0,
                   between: ArrayLike | None = None, **acting: Unpack[Acting]) -> Element:
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
    force, damping, gap, tension_only, preload, between
        As of `spring`, of the angle less `rest` and the moment that takes it back: a positive
        moment is against a positive angle.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Numbers that are negative, a joint that does not turn about one axis, hinges about several
        axes, an axis that the joint between the nodes forbids.
    """
    what = "torsion spring"
    a, b, vectors = about(model, node, axis, to, what)
    rest = inputs.number(rest, f"torsion spring at {a.name!r}: rest", remedy="give a number")
    warn_of_degrees(f"torsion spring at {a.name!r}", rest=rest)
    law = Special(force, damping, gap, tension_only, preload, between)
    constants: dict[str, float | NDArray]
    if law.given:
        constants = {**law.tables(f"{what} at {a.name!r}", stiffness, cubic)}
    else:
        damping = cast(float, damping)
        check(what, stiffness=stiffness, cubic=cubic, damping=damping)
        constants = {"k": stiffness, "k3": cubic, "c": damping}
    constants["rest"] = rest
    if vectors:
        constants |= zip(("n", "m"), vectors[1:], strict=True)
    spring = _add(model, name, what, a, rotations(a, b), constants,
                  "table_torsion_spring" if law.given else None)
    check_axes(model, [spring])
    return spring


def _add(model: Mechanism, name: str | None, what: str, a: Node,
         attachments: tuple[Attachment, ...],
         constants: dict[str, float | NDArray], kind: str | None = None) -> Element:
    name = chosen_name(model, name, f"{what} at {a.name}")
    kind = model.kind_of(kind or what.replace(" ", "_"))
    model.loads.append(Element(name, kind, attachments, constants))
    return model.loads[-1]
