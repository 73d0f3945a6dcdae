"""Reduction of a model to one superelement."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.names import IN_PLANE
from sebody.explore.assemblies.inertia_sums import summed_invariants
from sebody.explore.assemblies.kept_shapes import Kept, LooseInside, kept_shapes
from sebody.explore.assemblies.placed_bodies import Motion, Placed, placed_bodies
from sebody.explore.assemblies.recovered import recovered
from sebody.explore.assemblies.states import AT_REST, Given, given_state
from sebody.explore.assemblies.stiffened import KNOWN, Stiffened
from sebody.explore.assemblies.wanted import Interfaces, interfaces_of
from sebody.model.extent import extent
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.reduction.accuracy import Accuracy
from sebody.reduction.body import ReducedBody
from sebody.reduction.preload import Preload, preload_of
from sebody.reduction.rigid_motions import rigid_motions
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.small_motion.shapes import Shapes

SYMMETRIC = 1e-8        # part of a matrix that may be skew: rounding, or loads that turn
BALANCED = 1e-7         # way by which loads inside move a node, over the size of the model, or rad
UNBALANCED = 1e-4       # of the forces on the interfaces: a sum that is rounding of the equilibrium
DEFINITE = 1e-12        # of the largest: strain energy that is none
NO_STIFFENING = "divide the body where it spins fast or bears high loads"


def reduce_model(run_or_model: Simulation | Result | Model,
                 interfaces: Iterable[Node | str] | Mapping[str, str],
                 modes: int | Accuracy | None = None, preload: bool = True) -> ReducedBody:
    """A model, with its joints and springs, as one superelement on some of its nodes.

    The model is linearized about its equilibrium, without gravity, and reduced: its bodies, rigid
    parts, joints, springs, dampers, and contacts and friction as they are in that state. Supports
    of interfaces, and loads on them, are left out: they belong to the model that the body is put
    in. Inertia is exact at any rotation; all FE nodes of all bodies are recovered.

    Parameters
    ----------
    run_or_model : Simulation, Result or Model
        Of a model, the state is that of its equilibrium; of a run, the one it has reached, which
        must be at rest.
    interfaces : iterable of Node or str, or mapping of str to str
        Nodes that the body is on, in their order; a mapping says what each keeps, 'full',
        'translation' or 'rotation', by default all that the node has.
    modes : int or Accuracy, optional
        Number of modes with the interfaces at rest, or how exact these are to be; all by default.
    preload : bool
        Whether the model is in equilibrium, under stresses inside; otherwise it is taken as built.

    Returns
    -------
    ReducedBody
        In axes of space, with coordinates that are the places of the interfaces in the state. Its
        loads are those of its bodies by name, its paths those along its bodies. Notes say what was
        left out, which of its FE nodes are those of which body or node, and what contacts do.

    Raises
    ------
    InputError
        Unknown interfaces; controllers, drives, supports or loads inside; friction that slides; a
        mechanism inside; forces that matrices alone cannot have, by the names of the nodes.
    SimulationError
        The model has no equilibrium.
    """
    inputs.instance(run_or_model, "run_or_model", Simulation | Result | Model,
                    "give a Simulation, a Result or a Model")
    preload = inputs.flag(preload, "preload")
    if isinstance(modes, Accuracy) or modes is None:
        count = modes
    else:
        count = inputs.integer(modes, "modes", least=0)
    model = run_or_model if isinstance(run_or_model, Model) else run_or_model.model
    wanted = interfaces_of(model, interfaces)
    given = given_state(run_or_model, wanted, preload)
    return _reduced(given, wanted, count)


def _reduced(given: Given, wanted: Interfaces, modes: int | Accuracy | None) -> ReducedBody:
    linear, names = given.linear, Shapes(given.run)
    _refuse_sliding(given)
    M, C, K = linear.mass, linear.damping, _symmetric(linear.stiffness, given)
    B = np.vstack([np.atleast_2d(names.of(row, linear.free)) for row in wanted.rows])
    try:
        kept = kept_shapes((M + M.T) / 2, K, B, linear.free, modes)
    except LooseInside as error:
        raise InputError(_loose(given, names, error.shape)) from error
    _refuse_inner_forces(given, names, kept)
    whole = linear.free @ kept.shapes

    def motion(name: str) -> NDArray:
        return np.atleast_2d(names.of(name, whole))
    places = _places(given)
    points = np.array([places[name] for name in wanted.names])
    mass, stiffness, damping = (_congruent(A, kept.shapes) for A in (M, K, C))
    preload = _preload(given, wanted, kept, stiffness, points)
    if preload is not None:
        stiffness = stiffness - preload.stiffness(points, wanted.keeps, len(stiffness))
    placed = placed_bodies(given.held, motion)
    lacks = _missing(placed, given)
    if not _definite(stiffness, points, wanted.keeps):
        lacks["stiffening"] = f"in the state reduced it has buckled, or nearly: {NO_STIFFENING}"
    stiffening = None
    if not {"stiffening", "exact inertia"} & lacks.keys():
        stiffened = Stiffened(given, wanted, kept, K, placed, places)
        stiffening = stiffened.constants(mass, stiffness, (M + M.T) / 2)
        whole, placed = stiffened.with_load_modes(stiffening)
    invariants = summed_invariants(placed, given.run.model.rigid_bodies.values(), motion, places,
                                   mass, points, wanted.keeps, stiffening)
    inside = recovered(placed, _nodes_inside(given, wanted, motion, places), len(mass),
                       given.run.model.paths.values())
    return ReducedBody(
        stiffness, mass, points, wanted.keeps, kept.modes, damping if damping.any() else None,
        invariants, inside.recovery, _notes(given, wanted, kept, inside.numbers),
        _loads(placed, len(mass)), lacks,
        tuple(dict.fromkeys(m for one in placed for m in one.body.materials)),
        given.run.model.units, preload=preload, paths=inside.paths)


def _congruent(matrix: NDArray, shapes: NDArray) -> NDArray:
    made = shapes.T @ matrix @ shapes
    return (made + made.T) / 2


def _symmetric(K: NDArray, given: Given) -> NDArray:
    """The symmetric part: that of forces with a potential, in rotation vectors."""
    units = np.sqrt(np.abs(np.diag(K)))
    units[units == 0.0] = 1.0
    skew = np.abs(K - K.T) / np.outer(units, units)
    forces = np.abs(given.forces).max(initial=0.0)
    if skew.max(initial=0.0) > SYMMETRIC and forces == 0.0:
        raise InputError("the stiffness is not symmetric: loads turn with the model inside; leave "
                         "them out")
    return (K + K.T) / 2


def _refuse_sliding(given: Given) -> None:
    """Refuse friction that slides, or that slid on the way to the equilibrium: it is at its limit.
    """
    for name, state in given.linear.contacts.items():
        sticks = f"{name}.sticks"
        path = given.held[sticks] if state == "sticks" and sticks in given.held else np.ones(1)
        if state == "slides" or (given.sought and np.min(path) < 0.5):
            load = next(one for one in given.run.model.loads if one.name == name)
            node = f" at node {load.attachments[0].node.name!r}" * bool(load.attachments)
            raise InputError(f"friction {name!r}{node} slides in the state reduced, or on the way "
                             "to it, and forces of sliding are none of a superelement: reduce a "
                             "state in which it sticks, make the node an interface, or leave "
                             "friction out")


def _loose(given: Given, names: Shapes, shape: NDArray) -> str:
    """Message about a motion inside without stiffness, by the node that moves most."""
    node, _ = _most_moved(given, names, given.linear.free @ shape[:, None])
    return (f"with the interfaces at rest, node {node!r} moves without any resistance: there is a "
            "mechanism inside. Make this node an interface, or hold it by a spring or a weld")


def _most_moved(given: Given, names: Shapes, motion: NDArray) -> tuple[str, float]:
    """The node that moves most, over the size of the model, or turns most, and how far."""
    size, largest = extent(given.run.model) or 1.0, {}
    for node in given.run.model.nodes.values():
        for kind, unit in (("position", size), ("rotation", 1.0)):
            if getattr(node, kind) in given.run.numbering.dof_blocks:
                rows = names.of(f"{node.name}.{kind}", motion)
                largest[node.name] = max(largest.get(node.name, 0.0),
                                         float(np.linalg.norm(rows)) / unit)
    node = max(largest, key=lambda name: largest[name])
    return node, largest[node]


def _places(given: Given) -> dict[str, NDArray]:
    """Places of nodes in the state, and their rotations, (D, D)."""
    run, found = given.run, {}
    state, numbering = run.state, run.numbering
    D = run.model.dimension
    for node in run.model.nodes.values():
        found[node.name] = node.point
        if node.position in numbering.dof_blocks:
            found[node.name] = given.held[f"{node.name}.position"][-1].copy()
        if node.rotation not in numbering.dof_blocks:
            continue
        if D == 3:
            k = numbering.rotations[node.rotation]
            found[f"{node.name}.rotation"] = state.R[9 * k:9 * k + 9].reshape(3, 3).copy()
        else:
            first = numbering.dof_blocks[node.rotation]
            c, s = np.cos(state.q[first]), np.sin(state.q[first])
            found[f"{node.name}.rotation"] = np.array([[c, -s], [s, c]])
    return found


def _refuse_inner_forces(given: Given, names: Shapes, kept: Kept) -> None:
    """Refuse a state out of balance inside, such as of a run under gravity."""
    left = given.linear.free @ (kept.flexibility @ given.forces)[:, None]
    node, way = _most_moved(given, names, left)
    if way > BALANCED:
        raise InputError(f"node {node!r} inside bears loads in the state reduced, such as gravity: "
                         "give the model, whose equilibrium without gravity is found, or the "
                         "equilibrium of one without loads inside")


def _preload(given: Given, wanted: Interfaces, kept: Kept, stiffness: NDArray, points: NDArray
             ) -> Preload | None:
    """Forces that the interfaces bear in the state, in balance; None where they are rounding."""
    forces = kept.shapes.T @ given.forces
    forces[len(forces) - kept.modes:] = 0.0
    size = extent(given.run.model) or 1.0
    unit = np.sqrt(np.abs(np.diag(stiffness)))
    unit[unit == 0.0] = 1.0
    moved = np.linalg.lstsq(stiffness / np.outer(unit, unit), forces / unit, 1e-12)[0] / unit
    if np.abs(moved[:len(forces) - kept.modes]).max() <= AT_REST * size:
        return None
    rigid = rigid_motions(points, wanted.keeps, len(forces), points.mean(axis=0))
    scale = np.linalg.norm(rigid, axis=0)
    unit = rigid / scale
    left = unit @ np.linalg.lstsq(unit, forces, None)[0]        # rounding of the equilibrium
    if np.linalg.norm(left) > UNBALANCED * np.linalg.norm(forces):
        raise InputError(f"interfaces {', '.join(wanted.names)} bear forces that are not in "
                         "balance in the state reduced, so that something else holds the model: "
                         "make every node that is held or loaded an interface")
    return preload_of(forces - left, points, wanted.keeps, len(forces))


def _loads(placed: list[Placed], n: int) -> dict[str, NDArray]:
    """Loads of the bodies by name: those of one name act together."""
    found: dict[str, NDArray] = {}
    for one in placed:
        for name, load in one.body.loads.items():
            found[name] = found.get(name, 0.0) + one.rows[:, :n].T @ load
    return found


def _definite(stiffness: NDArray, points: NDArray, keeps: tuple[str, ...]) -> bool:
    """Tell if only rigid motion costs no strain energy, so that stresses have shapes of their own.
    """
    rigid = rigid_motions(points, keeps, len(stiffness), points.mean(axis=0))
    unit = np.sqrt(np.abs(np.diag(stiffness)))
    unit[unit == 0.0] = 1.0
    count = np.linalg.matrix_rank(rigid)
    values = np.linalg.eigvalsh(stiffness / np.outer(unit, unit))
    return not len(values) > count or bool(values[count] > DEFINITE * values[-1])


def _missing(placed: list[Placed], given: Given) -> dict[str, str]:
    found: dict[str, str] = {}
    for one in placed:
        for what in ("stresses", "exact inertia", "stiffening"):
            if what in one.body.lacks:
                found[what] = f"body {one.name!r} has none: {one.body.lacks[what]}"
        if one.body.invariants is None:
            found.setdefault("exact inertia", f"body {one.name!r} has none")
    for load in given.run.model.loads:
        kind = load.kind.removeprefix(IN_PLANE)
        if kind not in KNOWN:
            found["stiffening"] = f"{kind.replace('_', ' ')} {load.name!r} inside: {NO_STIFFENING}"
    return found


def _nodes_inside(given: Given, wanted: Interfaces, motion: Motion, places: dict[str, NDArray]
                  ) -> dict[str, tuple[NDArray, NDArray, NDArray]]:
    """Places, motions and rotations of the nodes that are no interfaces, by name."""
    found, turns = {}, given.run.model.rotation_size
    for node in given.run.model.nodes.values():
        if node.name in wanted.names or node.position not in given.run.numbering.dof_blocks:
            continue
        moved = motion(f"{node.name}.position")
        turned = (motion(f"{node.name}.rotation") if f"{node.name}.rotation" in places else
                  np.zeros((turns, moved.shape[1])))
        found[node.name] = places[node.name], moved, turned
    return found


def _notes(given: Given, wanted: Interfaces, kept: Kept, numbers: str) -> tuple[str, ...]:
    notes = [*given.notes, f"its interfaces are {', '.join(wanted.names)}", numbers]
    if np.isfinite(kept.omitted):
        notes.append("with the interfaces at rest its first vibration left out has the frequency "
                     f"{kept.omitted / (2 * np.pi):.6g}")
    states: dict[str, list[str]] = {}
    for name, state in given.linear.contacts.items():
        states.setdefault(state, []).append(name)
    notes += [f"contact {', '.join(names)}: {state}, and stays so"
              for state, names in states.items()]
    return tuple(notes)
