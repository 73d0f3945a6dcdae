"""Points inside reduced bodies: nodes of their FE models, placed by the recovery."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import BodyPoint, Element, Superelement
from sebody.reduction.recovery import Recovery

NODE = ".node"      # between the name of a body and the label of an FE node, as in results


def body_point(model: Mechanism, name: object, what: str) -> BodyPoint | None:
    """The point called ``BODY.nodeLABEL``, as in names of results; None for any other name.

    Raises
    ------
    InputError
        A body without FE nodes or without this one, or whose frame averages increments.
    """
    if not isinstance(name, str) or NODE not in name or name in model.nodes:
        return None
    owner, _, label = name.rpartition(NODE)
    if owner not in model.bodies:
        raise unknown(f"{what}: superelement", owner, model.bodies, "the model has",
                      "the model has none")
    body = model.bodies[owner]
    recovery = body.reduced.recovery
    if recovery is None:
        raise InputError(f"{what}: body {owner!r} has reduced matrices only, so where its FE nodes "
                         "are is unknown: reduce its FE model, by craig_bampton or import_body")
    place = label_place(recovery, label)
    if place is None:
        called = [recovery.called(0), recovery.called(len(recovery.coordinates) - 1)]
        raise InputError(f"{what}: body {owner!r} has no FE node {label!r}: its "
                         f"{len(recovery.coordinates)} nodes are {owner}{NODE}{called[0]} to "
                         f"{owner}{NODE}{called[1]}" + (
                             "" if recovery.nodes is None else
                             ", those whose recovery data was kept (recover=)"))
    if FRAMES[body.frame].traits.incremental:
        raise InputError(f"{what}: the frame {body.frame!r} of body {owner!r} averages the "
                         "rotations of a step, so it does not follow the body exactly: give the "
                         "superelement another frame, such as 'converged_mean'")
    return BodyPoint(body, place)


def label_place(recovery: Recovery, label: str) -> int | None:
    """Place of a node among those of the recovery, by its label, or number if it has none."""
    if not (label.isascii() and label.isdigit()):
        return None
    called = (recovery.labels if recovery.labels is not None else
              np.arange(len(recovery.coordinates)) if recovery.nodes is None else recovery.nodes)
    places = np.flatnonzero(called == int(label))
    return int(places[0]) if len(places) else None


def point_constants(point: BodyPoint) -> dict[str, ArrayLike]:
    """The place of a point in the frame of its body, and its displacements by local coordinates."""
    recovery, held = _recovery(point), held_points(point.body)
    second = dict(zip(("Hx", "Hy", "Hz"), second_derivatives(point), strict=False))
    return {"Phi": shapes(point), "point": recovery.points[point.place] - point.body.alpha @ held,
            **second}


def shapes(point: BodyPoint) -> NDArray:
    """Displacements of a point of unit local coordinates, (n, D)."""
    n = len(point.body.reduced.stiffness)
    displacements: NDArray = _recovery(point).displacement(np.eye(n), [point.place])[:, 0]
    return displacements


def second_derivatives(point: BodyPoint) -> NDArray:
    """Those of the displacements of a point by local coordinates, (D, n, n): of what follows."""
    Q, n = followers_of(point.body), len(point.body.reduced.stiffness)
    unit = np.eye(n + len(Q))[n:]
    by_followers = _recovery(point).displacement(unit, [point.place])[:, 0]
    second: NDArray = np.einsum("bd,bij->dij", by_followers, Q)
    return second


def followers_of(body: Superelement) -> NDArray:
    """Matrices Q_b of the coordinates that follow in second order, (m, n, n)."""
    n, invariants, recovery = len(body.reduced.stiffness), body.invariants, body.reduced.recovery
    assert recovery is not None
    if invariants is None or recovery.shapes.shape[1] < n + invariants.slaved:
        return np.zeros((0, n, n))
    return invariants.Q


def start_place(point: BodyPoint) -> NDArray:
    """The place of a point in the undeformed body at the start, global axes."""
    body = point.body
    first = body.reduced.position_nodes[0]
    placed: NDArray = body.nodes[first].point + (
        _recovery(point).points[point.place] - body.reduced.coordinates[first])
    return placed


def surface_touched(one: Element) -> tuple[str, dict[str, float | NDArray]]:
    """The surface that a contact inside a body touches, and the constants of one of a node."""
    constants = dict(one.constants)
    e, flat = constants.pop("e"), constants.pop("flat")
    if flat:
        return "plane", {"n": e} | {name: value for name, value in constants.items()
                                    if name not in ("size", "side")}
    del constants["level"]
    return ("cylinder", {"e": e} | constants) if np.any(e) else ("sphere", constants)


def held_points(body: Superelement) -> NDArray:
    """Boundary nodes that keep their position, in axes of the body."""
    return np.asarray(body.reduced.coordinates[list(body.reduced.position_nodes)])


def _recovery(point: BodyPoint) -> Recovery:
    assert point.body.reduced.recovery is not None      # see `body_point`
    return point.body.reduced.recovery
