"""Loads, springs, dampers and gravity of a model."""

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import ArrayLike

from sebody.errors import InputError
from sebody.model.histories import History, clock, history
from sebody.model.nodes import Element, Node, unit_vectors


class Forces:
    """The forces of `sebody.Model`."""

    def force(self, node: Node | str, direction: ArrayLike,
              amplitude: ArrayLike | Callable[[float], float] | History | None = None,
              follower: bool = False) -> None:
        """Force on a node: `direction` times a history.

        The direction is one of space, or with ``follower=True`` turns with the node.
        """
        node = self._known(node)
        triplet = self._triplet(node, "position")
        vector = self._vector(direction, f"force on {triplet.name}")
        triplets = (triplet, self._triplet(node, "rotation")) if follower else (triplet,)
        self._load("force", triplet.name, triplets, vector, history(amplitude), follower)

    def torque(self, node: Node | str, direction: ArrayLike,
               amplitude: ArrayLike | Callable[[float], float] | History | None = None,
               follower: bool = False) -> None:
        """Torque on a node: `direction` (a number in a plane) times a history.

        The direction is one of space, or with ``follower=True`` turns with the node.
        """
        triplet = self._triplet(self._known(node), "rotation")
        vector = self._turning(direction, f"torque on {triplet.name}")
        self._load("torque", triplet.name, (triplet,), vector, history(amplitude),
                   follower and not self.planar)

    def mode_force(self, body: str, mode: int, factor: float,
                   amplitude: ArrayLike | Callable[[float], float] | History | None = None) -> None:
        """Force on an internal mode of a superelement: `factor` times a history.

        A distributed load ``p`` has the factor ``shape . p``, the shape being mass-normalised.
        """
        if body not in self.bodies:
            raise InputError(f"superelement {body!r} is unknown: the model has "
                             f"{', '.join(self.bodies) or 'none'}")
        count = self.bodies[body].body.modes
        if mode not in range(count):
            raise InputError(f"superelement {body!r} has no mode {mode!r}: it has {count}, from 0")
        if not np.isfinite(factor):
            raise InputError(f"force on mode {mode} of {body!r} is {factor}: give a finite number")
        self.loads.append(Element(f"force on mode {mode} of {body}", "mode_force", (),
                                  np.array([float(factor)]), 0, history(amplitude), (body, mode)))

    def user_force(self, name: str, nodes: Iterable[Node | str],
                   function: Callable[..., None]) -> None:
        """Forces of a user's own, compiled into the loop.

        Parameters
        ----------
        nodes : iterable of Node or str
            Whose positions and velocities the function is given, and on which it acts.
        function : callable
            ``function(t, x, v, force)`` with arrays of all coordinates, node after node: sets
            `force`, which comes as zeros. Numba compiles it; its derivatives are differences.

        Raises
        ------
        InputError
            A function that cannot be compiled, or no nodes.
        """
        from sebody.kernels.user_functions import compile_force

        triplets = tuple(self._triplet(self._known(n), "position") for n in nodes)
        if not triplets:
            raise InputError(f"user force {name!r} has no nodes: give those it acts on")
        self.loads.append(Element(name, "user_force", triplets, np.zeros(1), 0, clock(),
                                  function=compile_force(name, function)))

    def spring(self, node: Node | str, to: Node | str, stiffness: float = 0.0,
               damping: float = 0.0, length: float | None = None, cubic: float = 0.0) -> None:
        """Spring and damper between two points: ``F = k u + k3 u^3 + c u'``, u the stretch.

        Parameters
        ----------
        stiffness, damping, cubic : float
            k, c and k3.
        length : float, optional
            Without force; that at the start by default.

        Raises
        ------
        InputError
            Numbers that are negative, or nodes that start together.
        """
        a, b = self._pair(node, to, "spring", ("position",))
        start = np.linalg.norm(b.point - a.point)
        if not start > 0:
            raise InputError(f"spring: nodes {a.name!r} and {b.name!r} start together, so it has "
                             "no direction: use a bushing")
        constants = self._coefficients("spring", stiffness=stiffness, cubic=cubic,
                                       damping=damping, length=start if length is None else length)
        self._act("spring", a, b, "spring", (a.position, b.position), constants)

    def torsion_spring(self, node: Node | str, stiffness: float = 0.0, damping: float = 0.0,
                       axis: ArrayLike = (0.0, 0.0, 1.0), to: Node | str | None = None,
                       rest: float = 0.0, cubic: float = 0.0) -> None:
        """Spring and damper about the axis of a revolute joint: ``M = k u + k3 u^3 + c u'``.

        `rest` is the angle of `node` against `to` (the ground) without moment, zero at the start.
        In space the angle stays within half a turn of the start.
        """
        a, b = self._pair(node, to, "torsion spring", ("rotation",))
        if not np.isfinite(rest):
            raise InputError(f"torsion spring at {a.name!r}: rest is {rest}: give a number")
        constants = self._coefficients("torsion spring", stiffness=stiffness, cubic=cubic,
                                       damping=damping)
        constants = np.append(constants, rest)
        if not self.planar:
            _, n, m = unit_vectors(self._direction(axis, "torsion spring", a))
            constants = np.concatenate([constants, n, m])
        self._act("torsion spring", a, b, "torsion_spring", (a.rotation, b.rotation), constants)

    def bushing(self, node: Node | str, to: Node | str | None = None,
                stiffness: ArrayLike = 0.0, damping: ArrayLike = 0.0,
                turning_stiffness: ArrayLike = 0.0, turning_damping: ArrayLike = 0.0) -> None:
        """Springs and dampers along and about the axes of `node`, between nodes at one point.

        Each is a number, or one for each axis. Turns count as their sine: stay well below half a
        right angle.
        """
        a, b = self._pair(node, to, "bushing")
        self._check_together(a, b, "bushing")
        sizes = self.dimension, self.dimension, self.rotation_size, self.rotation_size
        values = stiffness, damping, turning_stiffness, turning_damping
        constants = np.concatenate([np.broadcast_to(np.asarray(v, dtype=float), (size,))
                                    for v, size in zip(values, sizes, strict=True)])
        if not (np.isfinite(constants).all() and (constants >= 0).all()):
            raise InputError(f"bushing at {a.name!r} has a coefficient that is negative or no "
                             "number: give finite numbers >= 0")
        self._act("bushing", a, b, "bushing", (a.position, b.position, a.rotation, b.rotation),
                  constants)

    def gravity(self, field: ArrayLike) -> None:
        """Uniform gravity on every body, through its (reduced) mass.

        Parameters
        ----------
        field : (3,), planar (2,)
            Acceleration of free fall [length/time^2].

        Raises
        ------
        InputError
            Not so many finite numbers.
        """
        self.gravity_field = self._vector(field, "gravity")

    def _load(self, kind: str, on: str, triplets, vector, amplitude: History,
              follower: bool) -> None:
        self.loads.append(Element(f"{kind} on {on}", self._kind("follower_" * follower + kind),
                                  triplets, vector, 0, amplitude))

    def _act(self, what: str, a: Node, b: Node, kind: str, triplets, constants) -> None:
        self.loads.append(Element(f"{what} at {a.name}", self._kind(kind), triplets, constants))

    @staticmethod
    def _coefficients(what: str, **values: float):
        for name, value in values.items():
            if not (np.isfinite(value) and value >= 0):
                raise InputError(f"{what}: {name} is {value}: give a finite number >= 0")
        return np.array(list(values.values()), dtype=float)
