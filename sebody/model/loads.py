"""Loads of a model: forces and torques, each with a name and its work."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Unpack

from numpy.typing import ArrayLike

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import offered, unknown
from sebody.contract.names import body_load_kind
from sebody.model.acting import Acting
from sebody.model.arguments import (
    chosen_name,
    dof_block,
    known,
    named_axis,
    rotation_vector,
    vector,
)
from sebody.model.frames import FRAMES
from sebody.model.functions import compiled_force
from sebody.model.histories import clock, time_function
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, Superelement, positions, rotations
from sebody.model.time_functions import TimeFunction


def force(model: Mechanism, node: Node | str, direction: ArrayLike,
          amplitude: ArrayLike | Callable[[float], float] | TimeFunction | None = None,
          follower: bool = False, name: str | None = None,
          **acting: Unpack[Acting]) -> Element:
    """Force on a node: `direction` times a number, a table, a function of time or a profile.

    Parameters
    ----------
    node : Node or str
    direction : (3,), planar (2,), or the name of an axis such as "-z"
        Global axes; its length counts [force].
    amplitude : float, (n, 2) array_like, callable or TimeFunction, optional
        Over time; 1 by default.
    follower : bool
        The direction turns with the node, and is one of space otherwise.
    name : str, optional
        By default ``force on <node>.position``.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Examples
    --------
    >>> pull = model.force("cart", (0, 0, -1), 9.81, name="pull")
    """
    node = known(model, node)
    on = dof_block(node, "position")
    what = f"force on {on.name}"
    constants = {"d": vector(model, named_axis(direction, model.dimension, what), what)}
    attachments = positions(node)
    if inputs.flag(follower, "follower"):
        dof_block(node, "rotation")
        attachments += rotations(node)
    kind = model.kind_of("follower_" * follower + "force")
    course = time_function(amplitude)
    name = chosen_name(model, name, f"force on {on.name}")
    return _add(model, Element(name, kind, attachments, constants, time_function=course))


def torque(model: Mechanism, node: Node | str, direction: ArrayLike,
           amplitude: ArrayLike | Callable[[float], float] | TimeFunction | None = None,
           follower: bool = False, name: str | None = None,
           **acting: Unpack[Acting]) -> Element:
    """Torque on a node: `direction` times a number, a table, a function of time or a profile.

    Parameters
    ----------
    node : Node or str
    direction : (3,), or the name of an axis such as "-z"; in a plane a number
        Global axes, by the right hand; its length counts [force length].
    amplitude : float, (n, 2) array_like, callable or TimeFunction, optional
        Over time; 1 by default.
    follower : bool
        The direction turns with the node, and is one of space otherwise.
    name : str, optional
        By default ``torque on <node>.rotation``.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Examples
    --------
    >>> motor = model.torque("arm", (0, 1, 0), [(0.0, 0.0), (0.5, 20.0)], name="motor")
    """
    node = known(model, node)
    on = dof_block(node, "rotation")
    what = f"torque on {on.name}"
    if not model.planar:
        direction = named_axis(direction, 3, what)
    constants = {"d": rotation_vector(model, direction, what)}
    follower = inputs.flag(follower, "follower")
    kind = model.kind_of("follower_" * (follower and not model.planar) + "torque")
    course = time_function(amplitude)
    name = chosen_name(model, name, f"torque on {on.name}")
    return _add(model, Element(name, kind, rotations(node), constants, time_function=course))


def mode_force(model: Mechanism, body: str, mode: int, factor: float,
               amplitude: ArrayLike | Callable[[float], float] | TimeFunction | None = None,
               name: str | None = None,
               **acting: Unpack[Acting]) -> Element:
    """Force on an internal mode of a superelement: `factor` times a time function.

    Parameters
    ----------
    body : str
        Name of the superelement.
    mode : int
        Number of the internal mode, from 0.
    factor : float
        Of a distributed load ``p``: ``shape . p``, the shape being mass-normalised.
    amplitude : float, (n, 2) array_like, callable or TimeFunction, optional
        Over time; 1 by default.
    name : str, optional
        By default ``force on mode <mode> of <body>``.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        No such superelement or mode.
    """
    count = _body(model, body).reduced.modes
    mode = inputs.integer(mode, f"mode of superelement {body!r}")
    if not 0 <= mode < count:
        raise InputError(f"superelement {body!r} has no mode {mode!r}: it has {count}, from 0")
    factor = inputs.number(factor, f"force on mode {mode} of {body!r}")
    course = time_function(amplitude)
    name = chosen_name(model, name, f"force on mode {mode} of {body}")
    return _add(model, Element(name, "mode_force", (), {"factor": factor}, time_function=course,
                               mode=(body, mode)))


def body_load(model: Mechanism, body: str, load: str,
              amplitude: ArrayLike | Callable[[float], float] | TimeFunction | None = None,
              name: str | None = None,
              **acting: Unpack[Acting]) -> Element:
    """A load that was reduced with a superelement: pressure, traction, a force inside, times a
    time function.

    The load turns with the frame of the body. Its parts act on the boundary nodes where these are,
    and on the internal modes.

    Parameters
    ----------
    body : str
        Name of a superelement.
    load : str
        Name of one of its loads, see `ReducedBody.loads`.
    amplitude : float, (n, 2) array_like, callable or TimeFunction, optional
        Over time; 1 by default.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        A superelement or load there is not.
    """
    placed = _body(model, body)
    loads = placed.reduced.loads
    if not isinstance(load, str) or load not in loads:
        raise InputError(f"superelement {body!r} has no load {load!r}: "
                         + offered(load, loads, "it has", "it was reduced without loads, give "
                                   "craig_bampton loads={...}"))
    kind = body_load_kind(FRAMES[placed.frame].kernel, model.planar)
    course = time_function(amplitude)
    name = chosen_name(model, name, f"{load} on {body}")
    return _add(model, Element(name, kind, placed.attachments, {"P": loads[load]},
                               time_function=course,
                               body=placed))


def user_force(model: Mechanism, name: str, nodes: Iterable[Node | str],
               function: Callable[..., None], corners: Sequence[float] = (),
               **acting: Unpack[Acting]) -> Element:
    """Forces by a function of the user, compiled for the loop.

    Parameters
    ----------
    nodes : iterable of Node or str
        Nodes whose positions and velocities the function gets, and on which its forces act.
    function : callable
        ``function(t, x, v, force)`` with arrays of all coordinates, node after node; it sets
        `force`, which is zero before. Numba compiles it; derivatives are central differences.
    corners : sequence of float
        Times at which the forces jump [time]: steps end there.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        A function that cannot be compiled, no nodes, or corners that are no times.
    """
    inputs.name(name, "name of a user force")
    attachments = positions(*(known(model, n) for n in inputs.items(
        nodes, f"nodes of user force {name!r}", "give a list of nodes")))
    for place in attachments:
        dof_block(place.node, "position")
    if not attachments:
        raise InputError(f"user force {name!r} has no nodes: give those it acts on")
    compiled = compiled_force(function, name, model.dimension * len(attachments))
    name = chosen_name(model, name, "user force")
    return _add(model, Element(name, "user_force", attachments, {}, time_function=clock(corners),
                               function=compiled))


def _body(model: Mechanism, name: str) -> Superelement:
    """A superelement by its name."""
    if not isinstance(name, str) or name not in model.bodies:
        raise unknown("superelement", name, model.bodies, "the model has", "the model has none")
    return model.bodies[name]


def _add(model: Mechanism, load: Element) -> Element:
    model.loads.append(load)
    return load
