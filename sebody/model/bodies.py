"""Bodies of a model: superelements, rigid bodies and point masses."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import permutations
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.counts import layout_name
from sebody.io.body_file import load_body
from sebody.kernels.loader import superelement_kernel_name
from sebody.model.arguments import dof_block, known, refuse_taken, vector
from sebody.model.frames import (
    check_base_frame,
    check_frame,
    default_frame,
    frame_weights,
    known_frame,
)
from sebody.model.inertias import (
    chosen_inertia,
    known_inertia,
    needs_damped_kernel,
    second_order,
)
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, Superelement, positions, rotations
from sebody.model.preloads import add_preload
from sebody.reduction.body import ReducedBody
from sebody.reduction.summary import place

FEW = 5         # boundary nodes of which all orders are tried


def superelement(model: Mechanism, name: str, body: ReducedBody | str | Path,
                 nodes: Iterable[Node | str], frame: str | None = None,
                 inertia: str | None = None, rotation: ArrayLike | None = None,
                 frame_node: int | None = None, stiffening: bool | None = None) -> Superelement:
    """Place a reduced body on nodes.

    Parameters
    ----------
    body : ReducedBody, str or Path
        Reduced matrices in any axes, or the body file that holds them.
    nodes : iterable of Node or str
        One node for each boundary node of the body, in its order.
    frame : {'converged_mean', 'mean', 'mean_axes', 'mean_small', 'node', 'positions'}, optional
        By default the rotation of best fit of the positions, 'positions', for bodies with inertia
        'floating_field' and three or more positions that are not nearly on a line; mean axes,
        'mean_axes', for others of this inertia whose mass is off the line of their nodes; else the
        mean of the nodes' rotations, 'converged_mean'. Of a body held to the ground 'node', with
        the frame on its base.
    inertia : {'frame_axes', 'material', 'floating_field', 'rigid_part'}, optional
        Or their letters 'a', 'b', 'c', 'd'; a and b are those of Cardona (2000). By default
        'floating_field', the velocities of the whole displacement field, for bodies that have it:
        `craig_bampton` returns such bodies if the FE model has a mass field. Of
        reduced matrices alone 'rigid_part', in which the rigid part of the motion is exact. With
        the paper's frames 'mean' and 'mean_small' 'material', the paper's interpolation of
        velocities from the boundary nodes.
    rotation : (3, 3), planar (2, 2), optional
        Rotates vectors from FE axes to global axes; identity by default.
    frame_node : int, optional
        For ``frame='node'``: which boundary node carries the frame; by default the first, of a body
        held to the ground its base.
    stiffening : bool, optional
        Whether the body stiffens or softens with the stresses in it, with inertia
        'floating_field'; by default
        where the FE model has a geometric stiffness. Without it bodies that spin fast or carry
        high loads must be divided.

    Raises
    ------
    InputError
        A body file that cannot be used, nodes that do not fit the body, unknown options,
        stiffening requested for a body without geometric stiffness, or no kernel for the layout
        (the message says how to make it).
    """
    made = placed_superelement(model, name, body, nodes, frame, inertia, rotation, frame_node,
                               stiffening)
    add_preload(model, made)
    return made


def placed_superelement(model: Mechanism, name: str, body: ReducedBody | str | Path,
                        nodes: Iterable[Node | str], frame: str | None = None,
                        inertia: str | None = None, rotation: ArrayLike | None = None,
                        frame_node: int | None = None, stiffening: bool | None = None
                        ) -> Superelement:
    """The same without the springs of its preload, which are in the model already."""
    _check_name(model, name, "superelement")
    own_nodes = tuple(known(model, n) for n in inputs.items(
        nodes, f"nodes of superelement {name!r}", "give a list of nodes"))
    if isinstance(body, str | PathLike) and Path(body).suffix == ".npz":
        body = load_body(body)
    body = inputs.instance(body, f"body of superelement {name!r}", ReducedBody,
                           "give a ReducedBody, such as craig_bampton returns, or a body file, "
                           "BODY.npz")
    if body.planar != model.planar:
        raise InputError(f"superelement {name!r} is {'planar' if body.planar else 'spatial'} "
                         f"and the model is {'planar' if model.planar else 'spatial'}: use one "
                         "kind in a model")
    _check_units(model, name, body)
    placed = body if rotation is None else body.rotated(rotation)
    inertia = known_inertia(inertia)
    if frame is None:
        frame = "node" if placed.base is not None else default_frame(placed, inertia)
    if frame_node is None:
        frame_node = placed.base or 0
    own = known_frame(frame)
    _check_place(name, placed, own_nodes)
    check_base_frame(name, placed, frame, frame_node)
    check_frame(name, placed, frame)
    inertia, stiffening = chosen_inertia(name, placed, frame, inertia, stiffening)
    alpha, alpha_r = frame_weights(name, placed, frame, frame_node)
    layout = layout_name(placed.keeps, placed.planar)
    kernel = superelement_kernel_name(layout, own.kernel, inertia, placed.modes,
                                      needs_damped_kernel(placed, inertia),
                                      second_order(placed, inertia, stiffening))
    model.units = model.units or body.units
    model.bodies[name] = Superelement(name, placed, own_nodes, frame, inertia, stiffening, layout,
                                      alpha, alpha_r, kernel, np.zeros(placed.modes))
    model.own_names.add(name)
    return model.bodies[name]


def rigid_body(model: Mechanism, name: str, node: Node | str, mass: float, inertia: ArrayLike,
               centre: ArrayLike | None = None) -> Element:
    """A rigid body that moves with a node.

    Parameters
    ----------
    mass : float
        Its mass [mass].
    inertia : (3, 3) or (3,), planar float
        About the centre of mass, global axes at the start (three numbers: principal moments)
        [mass length^2].
    centre : (3,), planar (2,), optional
        Centre of mass at the start, global axes [length]; the node by default.

    Raises
    ------
    InputError
        A mass or inertia no body has, or a name that is taken.
    """
    mass = _check_rigid(model, name, mass)
    node = known(model, node)
    for kind in ("position", "rotation"):
        dof_block(node, kind)
    centre = node.point if centre is None else vector(model, centre, f"centre of {name!r}")
    arm = centre - node.point
    J = _inertia(model, name, inertia)
    if model.planar:
        moments = {"J_zz": J + mass * arm @ arm}
    else:
        J = J + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        moments = {f"J_{'xyz'[i]}{'xyz'[j]}": J[i, j]
                   for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))}
    return _add(model, Element(name, model.kind_of("rigid_body"), positions(node) + rotations(node),
                               {"mass": mass, "mc": mass * arm, **moments}))


def point_mass(model: Mechanism, name: str, node: Node | str, mass: float) -> Element:
    """A mass on a node, without inertia of rotation.

    Parameters
    ----------
    name : str
    node : Node or str
    mass : float
        [mass]

    Raises
    ------
    InputError
        A mass that is not positive, or a name that is taken.
    """
    mass = _check_rigid(model, name, mass)
    node = known(model, node)
    dof_block(node, "position")
    return _add(model, Element(name, model.kind_of("point_mass"), positions(node),
                               {"mass": mass}))


def _add(model: Mechanism, body: Element) -> Element:
    model.rigid_bodies[body.name] = body
    model.own_names.add(body.name)
    return body


def _check_name(model: Mechanism, name: str, what: str) -> None:
    inputs.name(name, f"name of a {what}")
    if name in model.bodies or name in model.rigid_bodies:
        raise InputError(f"{what} {name!r} exists already: give it its own name")
    refuse_taken(model, name, f"{what} {name!r}", ("node",))


def _check_units(model: Mechanism, name: str, body: ReducedBody) -> None:
    if body.units and model.units and body.units != model.units:
        raise InputError(f"superelement {name!r}: the body is in the units {body.units} and the "
                         f"model in {model.units}: import the body in the model's units")


def _check_rigid(model: Mechanism, name: str, mass: float) -> float:
    _check_name(model, name, "body")
    return inputs.number(mass, f"mass of {name!r}", above=0)


def _inertia(model: Mechanism, name: str, inertia: ArrayLike) -> NDArray | float:
    """Inertia about the centre of mass; moments must be those of a body."""
    what = f"inertia of {name!r}"
    if model.planar:
        return inputs.number(inertia, what, least=0, remedy="give one number >= 0")
    J = inputs.reals(inertia, what, "give 3 x 3 finite numbers, or three principal moments")
    J = np.diag(J) if J.shape == (3,) else J
    if J.shape != (3, 3) or not np.isfinite(J).all():
        raise InputError(f"inertia of {name!r} has shape {J.shape}: give 3 x 3 finite numbers, "
                         "or three principal moments")
    if np.abs(J - J.T).max() > 1e-9 * np.abs(J).max():
        raise InputError(f"inertia of {name!r} is not symmetric: check its entries")
    principal = np.linalg.eigvalsh(J)
    if principal[0] < -1e-9 * principal[2] or (
            principal[0] + principal[1] < (1 - 1e-9) * principal[2]):
        raise InputError(f"inertia of {name!r} has the principal moments {principal}: no body "
                         "has one that is negative or larger than the sum of the others")
    return J


def _check_place(name: str, body: ReducedBody, nodes: tuple[Node, ...]) -> None:
    if len(nodes) != len(body.keeps):
        raise InputError(f"superelement {name!r} has {len(body.keeps)} boundary nodes and "
                         f"{len(nodes)} were given: give one node for each")
    for node, keep in zip(nodes, body.keeps, strict=True):
        for kind, other in (("position", "rotation"), ("rotation", "translation")):
            if keep != other:
                dof_block(node, kind)
    points = np.array([n.point for n in nodes])
    offset = points - body.coordinates
    error = np.abs(offset - offset.mean(axis=0)).max()
    allowed = 1e-6 * max(np.ptp(points, axis=0).max(), 1e-300)
    if error > allowed:
        own = ", ".join(place(point) for point in body.coordinates)
        order = _fitting_order(points, body.coordinates, allowed)
        raise InputError(f"superelement {name!r}: the nodes do not lie where the body's "
                         f"boundary nodes are (off by {error:.3g} after the best shift), at {own}: "
                         + (f"give them in the order {', '.join(nodes[k].name for k in order)}, or "
                            if order else "")
                         + ("pass rotation=, the matrix that turns FE axes into global axes"
                            if _turned(points, body.coordinates) <= allowed else
                            "give the nodes these places, or import the body with theirs "
                            "(@x,y,z); no rotation= makes them fit"))


def _fitting_order(points: NDArray, coordinates: NDArray, allowed: float) -> tuple[int, ...]:
    """Order in which points are others after a shift; none of more than `FEW` points."""
    if len(points) > FEW:
        return ()
    for order in permutations(range(len(points))):
        offset = points[list(order)] - coordinates
        if np.abs(offset - offset.mean(axis=0)).max() <= allowed:
            return order
    return ()


def _turned(points: NDArray, coordinates: NDArray) -> float:
    """The distance of points from others after the best shift and rotation."""
    a, b = points - points.mean(axis=0), coordinates - coordinates.mean(axis=0)
    left, _, right = np.linalg.svd(a.T @ b)
    turn = left @ right
    left[:, -1] *= np.sign(np.linalg.det(turn))
    return float(np.abs(a - b @ (left @ right).T).max())
