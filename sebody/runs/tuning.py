"""Bristles of friction: stiffness from the mass they hold, and the force they carry at the start.

A bristle that is much stiffer than ``m/h^2`` makes steps of the length h fail, one that is much
softer gives way. Its stiffness is ``m/h^2`` unless it is given, where m is the least mass that
resists a force along it, ``1/(B M^-1 B^T)`` with the joints as they are.

At the start bristles of joints at rest must carry what holds them: unloaded ones would give way.
Their forces are those at which nothing that they hold is accelerated, found by Newton's iteration,
since normal forces depend on them; what needs more than the static limit slides from the start.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from sebody.assembly.contracts import counts_of
from sebody.assembly.evaluation import evaluate
from sebody.contract.layout import RESIDUAL, Row
from sebody.engine.evaluate import to_body_axes
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.kernels.loader import element_kernel
from sebody.model.body_points import start_place
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, stretch
from sebody.model.parts import Element
from sebody.runs.directions import directions, of_point, pair, rotation_of
from sebody.runs.redundancy import least

STILL = 1e-9            # of the mobility of the parts alone: that of what a drive moves
AT_REST = 1e-9          # rate of a joint at rest, relative to that of the model
HELD = 1e-12            # acceleration of what is held, relative to that without friction
MOST = 30               # iterations for the forces at the start
RESOLVED = 0.1          # angular frequency of teeth in contact, times the step, for the guard
OPEN = 1e-200           # force of a contact that is open, rounded up
BEYOND = 2.0            # of the static limit: force of a bristle that is to slide


def tune(model: Mechanism, system: System, numbering: Numbering, state: State,
         masses: csc_matrix) -> None:
    """Set what is not given of bristles, the stiffness of gear teeth, when ropes stop slipping.

    Parameters
    ----------
    masses : (n, n)
        Masses and constraints at the start.
    """
    tuned = [load for load in model.loads if load.tuned]
    if not tuned:
        return
    solve = least(masses, system)
    for load in tuned:
        constants = ElementConstants(load, system, numbering)
        if "settling" in load.tuned:
            constants["settling"] = load.tuned["settling"] * state.clock.natural
            continue
        rows = directions(load, numbering, state)
        mass = 1.0 / _mobility(rows, solve, system, state, numbering.free)
        natural = mass / state.clock.natural**2
        if "teeth" in load.tuned:
            constants["stiffness"] = RESOLVED**2 * natural
            continue
        stiffness = constants["bristle"] = load.number("bristle") or natural
        numbering.bristles[load] = stiffness
        constants["bristle_damping"] = float(
            2.0 * load.tuned["damping"] * np.sqrt(stiffness * mass))


def _mobility(rows: list[NDArray], solve: Callable[[NDArray], NDArray], system: System,
              state: State, free: int) -> float:
    """Largest acceleration by a unit force along any sum of directions, along this force.

    What a drive moves does not give way: it gets the mobility of its parts alone; what is held, or
    moved as a node, gets that of a typical inertia of the model, as its parts are not known.
    """
    inertias = system.inertias[:free]
    heavy = inertias > 0.0      # ways along paths have none
    alone = max(float((row[:free][heavy]**2 / inertias[heavy]).sum()) for row in rows)
    answers = np.array([response(row, solve, system, state, free) for row in rows])
    joint = answers @ np.array(rows).T
    mobility = float(np.linalg.eigvalsh((joint + joint.T) / 2)[-1])
    if mobility > STILL * alone:
        return mobility
    return alone or max(_typical_mobility(row, system, free) for row in rows)


def _typical_mobility(row: NDArray, system: System, free: int) -> float:
    """Mobility along a direction without unknowns, were the model's largest inertia there."""
    size = np.where(system.magnitude > 0.0, system.magnitude, 1.0)
    inertia = (system.inertias[:free] * size[:free]**2).max(initial=0.0) or 1.0
    return float(((row * size[:len(row)])**2).max() / inertia) or 1.0


def response(row: NDArray, solve: Callable[[NDArray], NDArray], system: System, state: State,
             free: int) -> NDArray:
    """Accelerations by a unit force along a direction, (coordinates,)."""
    force = row.copy()
    to_body_axes(system, state.frames, force, False)
    accelerations = np.zeros(len(row))
    accelerations[:free] = solve(force[:free])
    accelerations *= system.is_multiplier[:len(row)] == 0.0
    to_body_axes(system, state.frames, accelerations, True)
    return accelerations


class ElementConstants:
    """The constants of an element in a system, by name."""

    def __init__(self, element: Element, system: System, numbering: Numbering) -> None:
        kernel = element_kernel(element.kind)
        counts = {} if element.point is None else counts_of(element.point.body)
        self.places = Row(element.name, kernel.CONSTANTS).slices(counts)
        self.all, self.first = system.constants, numbering.constants_at[element]

    def __setitem__(self, name: str, value: float) -> None:
        self.all[self.first + self.places[name].start] = value

    def __getitem__(self, name: str) -> float:
        return float(self.all[self.first + self.places[name].start])


def unbend(model: Mechanism, numbering: Numbering, state: State) -> None:
    """Straighten all bristles: an equilibrium is sought from there."""
    for load in model.loads:
        if load in numbering.memories:
            names = element_kernel(load.kind).MEMORY
            for place, name in zip(numbering.memories[load], names, strict=True):
                if name.startswith(("bent", "slid")):
                    state.frames[place] = state.frames_old[place] = 0.0


class _Held(NamedTuple):
    """Friction at rest."""

    constants: ElementConstants
    rows: list[NDArray]
    axes: NDArray           # columns: what each row is among the bristles
    lever: float            # of the normal force
    bent: list[int]         # places of the bristles in `State.frames`
    normal: int             # place of the normal force


class LoadedBristles:
    """Forces of bristles of joints at rest; `solve_again` solves for accelerations.

    Parameters
    ----------
    model : Mechanism
    system, numbering, state
        Of a run, its accelerations solved for.
    """

    def __init__(self, model: Mechanism, system: System, numbering: Numbering, state: State):
        self.system, self.numbering, self.state = system, numbering, state
        tuned = [load for load in model.loads if load.tuned]
        if tuned:       # normals of contacts are those of their forces
            evaluate(system, state, RESIDUAL, RESIDUAL, "the initial state")
        self.held = [one for load in tuned for one in self._held(load)]

    def _held(self, load: Element) -> list[_Held]:
        """The friction, if nothing slides in it: its bristles are straight then."""
        constants = ElementConstants(load, self.system, self.numbering)
        memory, names = self.numbering.memories[load], element_kernel(load.kind).MEMORY
        bent = [place for place, name in zip(memory, names, strict=True) if name.startswith("bent")]
        if not bent or constants["speed"] > 0 or load.hidden is not None:   # of a rope: it is free
            return []
        if "friction" in load.kind:
            rows = directions(load, self.numbering, self.state)
            axes = np.eye(len(rows))
            has_lever = not load.kind.endswith(("friction_cylindrical_f2m2", "friction_way"))
            lever = constants["radius"] if has_lever else 1.0
        else:
            rows, axes = self._touching(load, constants)
            lever = 1.0
        fastest = np.abs(self.state.v).max()
        if not rows or any(abs(row @ self.state.v) > AT_REST * fastest for row in rows):
            return []
        self.state.frames_old[bent] = self.state.frames_old[memory[names.index("slid")]] = 0.0
        return [_Held(constants, rows, axes, lever, bent, memory[names.index("normal")])]

    def _touching(self, load: Element, constants: ElementConstants
                  ) -> tuple[list[NDArray], NDArray]:
        """Directions of the slip of a contact that is closed, and these in the surface's axes."""
        size = len(load.dof_blocks[0].start)
        first = self.numbering.forces_at[load]
        push = -self.state.g[first:first + size]
        if load.point is not None:
            return self._touching_inside(load, first)
        places = [t for t in load.dof_blocks if not t.rotational]
        pressing = np.linalg.norm(push)
        if not pressing > OPEN or any(t.root is not None for t in places):
            return [], np.zeros((size, 0))
        n = push / pressing
        across = np.linalg.svd(n[None])[2][1:]
        turns = [t for t in load.dof_blocks if t.rotational]
        q = [self.state.q[stretch(self.numbering, t)] for t in places]
        point = q[0] - constants["radius"] * n
        rows = []
        for t in across:
            row = pair(self.numbering, self.state, places, t, [t, t])
            for turn, centre, sign in zip(turns, q[-len(turns):], (1.0, -1.0)[-len(turns):],
                                          strict=True):
                arm = point - centre
                moment = (np.atleast_1d(arm[0] * t[1] - arm[1] * t[0]) if size == 2 else
                          rotation_of(self.numbering, self.state, turn).T @ np.cross(arm, t))
                row[stretch(self.numbering, turn)] += sign * moment
            rows.append(row)
        return rows, rotation_of(self.numbering, self.state, turns[-1]).T @ across.T

    def _touching_inside(self, load: Element, first: int) -> tuple[list[NDArray], NDArray]:
        """The same of a point inside a body: the force on the surface's node is minus its own."""
        assert load.point is not None
        size, carrier = len(load.dof_blocks[-2].start), load.dof_blocks[-2:]
        at = first + load.firsts[-2]
        push = self.state.g[at:at + size]
        pressing = np.linalg.norm(push)
        if not pressing > OPEN:
            return [], np.zeros((size, 0))
        n = push / pressing
        across = np.linalg.svd(n[None])[2][1:]
        arm = start_place(load.point) - self.state.q[stretch(self.numbering, carrier[0])]
        rows = []
        for t in across:
            row = of_point(load, self.numbering, self.state, t)
            moment = (np.atleast_1d(arm[0] * t[1] - arm[1] * t[0]) if size == 2 else
                      rotation_of(self.numbering, self.state, carrier[1]).T @ np.cross(arm, t))
            row[stretch(self.numbering, carrier[1])] -= moment
            rows.append(row)
        return rows, rotation_of(self.numbering, self.state, carrier[1]).T @ across.T

    def load(self, masses: csc_matrix, solve_again: Callable[..., Any]) -> None:
        """Bend the bristles so that what they hold stays at rest."""
        rows = [row for one in self.held for row in one.rows]
        if not rows:
            return
        B, state = np.array(rows), self.state
        solve = least(masses, self.system)
        W = B @ np.array([response(row, solve, self.system, state, self.numbering.free)
                          for row in rows]).T
        forces, slides = np.zeros(len(rows)), np.zeros(len(rows), dtype=bool)
        # weightless frictionless joints have nothing to hold
        first = np.abs(B @ state.a).max()
        for _ in range(MOST):
            acceleration = B @ state.a
            sticks = ~slides
            if np.abs(acceleration[sticks]).max(initial=0.0) <= HELD * first:
                return
            change = np.linalg.lstsq(W[np.ix_(sticks, sticks)], acceleration[sticks],
                                     rcond=1e-12)[0]
            forces[sticks] += change
            self._bend(forces, slides)
            solve_again()

    def _bend(self, forces: NDArray, slides: NDArray) -> None:
        """Set the bristles; those that would be bent beyond their limit slide."""
        at = 0
        for one in self.held:
            rows = slice(at, at + len(one.rows))
            at = rows.stop
            limit = one.constants["static"] * one.lever * self.state.frames[one.normal]
            size = np.linalg.norm(forces[rows])
            if size > limit * (1.0 + 1e-12):
                slides[rows] = True
                forces[rows] *= BEYOND * max(limit, 1e-300) / size
            else:
                slides[rows] = False
            self.state.frames_old[one.bent] = one.axes @ forces[rows] / one.constants["bristle"]
