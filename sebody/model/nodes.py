"""Nodes of a model: positions, shared DOF blocks, rigid links and initial velocities."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.arguments import dof_block, known, refuse_taken, rotation_vector, vector
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, DofBlock, Node

RESERVED = ("constraints", "energy")    # first parts of quantities of the whole model


def node(model: Mechanism, name: str, point: ArrayLike, keeps: str = "full",
         at: Node | str | None = None) -> Node:
    """Add a node.

    Parameters
    ----------
    name : str
    point : (3,), planar (2,)
        Initial position, global axes [length].
    keeps : {'full', 'translation', 'rotation'}
        ``'position'`` is the translation, as `fix` has it.
    at : Node or str, optional
        Share the position DOF block of this node: a spherical joint with no multiplier.

    Raises
    ------
    InputError
        Name taken, wrong shape, or `at` is somewhere else.
    """
    _check_new(model, name)
    at = None if at is None else known(model, at)
    point = vector(model, point, f"point of node {name!r}")
    keeps = "translation" if isinstance(keeps, str) and keeps == "position" else keeps
    if not isinstance(keeps, str) or keeps not in ("full", "translation", "rotation"):
        raise InputError(f"node {name!r} keeps {keeps!r}: use full, translation or rotation")
    size = max(1.0, np.abs(point).max())
    if at is not None and np.abs(at.point - point).max() > 1e-9 * size:
        raise InputError(f"node {name!r} at {point} cannot share the position of "
                         f"{at.name!r} at {at.point}: give both the same point")
    position = None if keeps == "rotation" else (
        at.position if at is not None else
        DofBlock(f"{name}.position", point, np.zeros(model.dimension)))
    rotation = None if keeps == "translation" else _rotation(model, f"{name}.rotation")
    added = model.nodes[name] = Node(name, point, position, rotation)
    if at is not None:
        model.connections.append(Connection("position", added, at, spare=True))
    return added


def attach(model: Mechanism, name: str, point: ArrayLike, to: Node | str) -> Node:
    """A node at the end of a massless rigid link from another one: no unknown, no equation.

    Its rotation is that of `to`. Bodies, joints and loads may act on it as on any node, and
    further links may start from it.

    Parameters
    ----------
    name : str
        Of the new node.
    point : (3,), planar (2,)
        Its initial position, global axes [length].
    to : Node or str
        Where the link begins.

    Raises
    ------
    InputError
        Name taken, or `to` lacks a DOF block.
    """
    master = known(model, to)
    _check_new(model, name)
    point = vector(model, point, f"point of node {name!r}")
    position, rotation = (dof_block(master, k) for k in ("position", "rotation"))
    root = position if position.root is None else position.root
    arms = (*position.arms, (rotation, point - master.point))
    dependent = DofBlock(f"{name}.position", point, np.zeros(model.dimension), root=root, arms=arms)
    added = model.nodes[name] = Node(name, point, dependent, rotation)
    model.connections += [Connection(kind, added, master) for kind in ("position", "rotation")]
    return added


def ground(model: Mechanism, node: Node) -> Node:
    """A fixed node at the position of another one."""
    fixed = Node(f"ground at {node.name}", node.point,
                 DofBlock("ground.position", node.point, np.zeros(model.dimension), fixed=True),
                 _rotation(model, "ground.rotation", fixed=True))
    model.grounds.append(fixed)
    return fixed


def initial_velocity(model: Mechanism, node: Node | str, linear: ArrayLike | None = None,
                     angular: ArrayLike | None = None) -> None:
    """Initial velocity of a node, global axes.

    Velocities that are not given are solved for, see `sebody.Simulation`.

    Parameters
    ----------
    node : Node or str
    linear : (3,), planar (2,), optional
        [length/time]
    angular : (3,), in a plane a number, optional
        [rad/time]

    Raises
    ------
    InputError
        A velocity of what is fixed, prescribed or follows another node.
    """
    node, rates = known(model, node), []
    for kind, value, check in (("position", linear, vector),
                               ("rotation", angular, rotation_vector)):
        if value is None:
            continue
        moving = dof_block(node, kind)
        rate = check(model, value, f"initial rate of {moving.name}")
        if not moving.solved and np.any(rate):
            raise InputError(f"initial rate of {moving.name} is {value}, but it is fixed, "
                             "prescribed or follows another node: leave it out")
        rates.append((moving, rate))
    for moving, rate in rates:
        moving.rate, moving.given = rate, True


def rigid_velocity(model: Mechanism, linear: ArrayLike, angular: ArrayLike,
                   about: ArrayLike | None = None, body: str | None = None,
                   nodes: Iterable[Node | str] | None = None) -> None:
    """Start the whole model, a body or some nodes in a rigid motion.

    Of the whole model all that is free starts with it, as far as joints and drives allow: a run
    warns where they demand other velocities. A body or nodes keep it as they keep what
    `initial_velocity` gives: a run is refused where it contradicts a joint or drive.

    Parameters
    ----------
    linear : (3,), planar (2,)
        Velocity of the point `about`, global axes.
    angular : (3,), planar a number
    about : (3,), planar (2,), optional
        The origin by default.
    body : str, optional
        Name of a superelement, a rigid body or a beam: its nodes alone.
    nodes : iterable of Node or str, optional
        These nodes alone.

    Raises
    ------
    InputError
        Wrong shapes, a body or node there is not, or both `body` and `nodes`.
    """
    linear = vector(model, linear, "linear velocity")
    angular = rotation_vector(model, angular, "angular velocity")
    centre = np.zeros(model.dimension) if about is None else vector(model, about, "about")
    whole = body is None and nodes is None
    moved = model.nodes.values() if whole else _moved(model, body, nodes)
    for node in moved:
        arm = node.point - centre
        spin = (angular[0] * np.array([-arm[1], arm[0]]) if model.planar
                else np.cross(angular, arm))
        for block, rate in ((node.position, linear + spin), (node.rotation, angular)):
            if block is not None and (block.solved or not whole):
                block.rate, block.given = rate.copy(), block.given or not whole


def _moved(model: Mechanism, body: str | None,
           nodes: Iterable[Node | str] | None) -> list[Node]:
    """The nodes of a body, or some nodes."""
    if body is None:
        return [known(model, node) for node in inputs.items(nodes, "nodes", "give a list of nodes")]
    if nodes is not None:
        raise InputError("rigid_velocity takes body= or nodes=: leave one of them out")
    named: dict[str, Iterable[Node]] = {beam.name: beam.nodes for beam in model.beams}
    named |= {one.name: one.nodes for one in model.bodies.values()}
    named |= {one.name: [place.node for place in one.attachments]
              for one in model.rigid_bodies.values()}
    if not isinstance(body, str) or body not in named:
        raise unknown("body", body, named, "the model has", "the model has none")
    return list(dict.fromkeys(named[body]))


def _check_new(model: Mechanism, name: str) -> None:
    inputs.name(name, "name of a node")
    if name in RESERVED:
        raise InputError(f"a node cannot be called {name!r}: results have {name}.* of the model; "
                         "give it another name")
    if name in model.nodes:
        raise InputError(f"node {name!r} exists already: give every node its own name")
    refuse_taken(model, name, "a node", ("part",))


def _rotation(model: Mechanism, name: str, fixed: bool = False) -> DofBlock:
    return DofBlock(name, np.zeros(model.rotation_size), np.zeros(model.rotation_size), fixed,
                   rotational=True)
