"""Displacements and stresses inside an assembly: those of its bodies, and of its nodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from sebody.explore.assemblies.placed_bodies import Placed
from sebody.fem.beam_stress import BeamStress
from sebody.fem.stress import SolidStress, StressModes
from sebody.model.parts import Path, Superelement
from sebody.model.paths import MEET
from sebody.reduction.recovery import Recovery

_DOFS = {2: ("x", "y", "rz"), 3: ("x", "y", "z", "rx", "ry", "rz")}


class Inside(NamedTuple):
    """Recovered quantities of an assembly, and which of its FE nodes are of what, in words."""

    recovery: Recovery | None
    numbers: str
    paths: Mapping[str, NDArray] = {}       # FE nodes of paths by name


def recovered(placed: Sequence[Placed], nodes: Mapping[str, tuple[NDArray, NDArray, NDArray]],
              size: int, paths: Iterable[Path]) -> Inside:
    """The FE nodes of all bodies, body after body, then nodes of the model, in the state.

    Stresses are the changes from this state.

    Parameters
    ----------
    nodes : mapping of str to (D,), (D, n) and (r, n)
        Places of nodes by name, their motion and rotation by the coordinates of the assembly.
    size : int
        How many of these there are before load modes.
    paths : iterable of Path
        Of the model: those along its bodies stay, as do those that reductions of bodies were given.
    """
    known = [one for one in placed if one.body.recovery is not None]
    parts = [_part(one, size) for one in known]
    names = [one.name for one in known]
    if nodes:
        parts.append(_of_nodes(nodes))
    if not parts:
        return Inside(None, "nothing inside is recovered: its bodies are reduced matrices alone")
    D = parts[0].dimension
    dofs = _DOFS[D] if any(len(one.node_dofs) > D for one in parts) else _DOFS[D][:D]
    coordinates = np.vstack([one.coordinates for one in parts])
    cells, stress, said, first = [], [], [], 0
    begins: dict[str, int] = {}
    for one, name in zip_longest(parts, names):
        numbers = first + np.arange(len(one.coordinates))
        cells += [(kind, corners + first) for kind, corners in one.cells]
        stress += [_renumbered(own, numbers, coordinates, first) for own in one.stress]
        said += ([f"{name} {first} to {numbers[-1]}"] if name is not None else
                 [f"{node} {number}" for node, number in zip(nodes, numbers, strict=True)])
        if name is not None:
            begins[name] = first
        first += len(numbers)
    made = Recovery(np.vstack([_widened(one, len(dofs)) for one in parts]), coordinates, dofs,
                    cells=tuple(cells), outlines=_outlines(parts), stress=tuple(stress))
    return Inside(made, f"FE nodes: {', '.join(said)}",
                  _of_model(paths, begins, coordinates) | _of_bodies(known, begins))


def _of_model(paths: Iterable[Path], begins: Mapping[str, int], coordinates: NDArray
              ) -> dict[str, NDArray]:
    """Nodes of the paths along bodies; where one hands over to the next, its last one is left out.
    """
    found = {}
    for path in paths:
        pieces = [piece for piece in path.pieces if isinstance(piece.carrier, Superelement)]
        numbers = [begins[piece.carrier.name] + np.array(piece.places) for piece in pieces]
        for k in range(len(numbers) - 1):
            gap = coordinates[numbers[k][-1]] - coordinates[numbers[k + 1][0]]
            if np.linalg.norm(gap) <= MEET * path.length:
                numbers[k] = numbers[k][:-1]
        if numbers:
            found[path.name] = np.concatenate(numbers)
    return found


def _of_bodies(known: Sequence[Placed], begins: Mapping[str, int]) -> dict[str, NDArray]:
    """Paths of reductions, by the names of their bodies, too, where several have the same name."""
    names = [name for one in known for name in one.body.paths]
    found = {}
    for one in known:
        assert one.body.recovery is not None
        for name, nodes in one.body.paths.items():
            found[name if names.count(name) == 1 else f"{one.name}.{name}"] = begins[
                one.name] + np.array([one.body.recovery.place(int(node)) for node in nodes])
    return found


def _of_nodes(nodes: Mapping[str, tuple[NDArray, NDArray, NDArray]]) -> Recovery:
    """Nodes of the model, without elements."""
    places = np.array([place for place, _, _ in nodes.values()])
    shapes = np.vstack([np.vstack([moved, turned]) for _, moved, turned in nodes.values()])
    return Recovery(shapes, places, _DOFS[places.shape[1]])


def _part(one: Placed, count: int) -> Recovery:
    """Shapes of one body in axes of space, by the coordinates of the assembly."""
    own = one.body.recovery
    assert own is not None
    n, D = len(one.body.mass), own.dimension
    turn = np.eye(D) if own.axes is None else own.axes
    size, width = len(own.coordinates), len(own.node_dofs)
    y = one.y
    # those of second order have a part of first order in a deformed state
    followers = (np.zeros((0, n)) if one.body.invariants is None else one.body.invariants.Q @ y)
    motion = np.vstack([one.rows, followers @ one.rows + one.slaved])[:own.shapes.shape[1]]
    shapes = own.all_dofs(motion.T).T
    moved = own.displacement(one.body.with_followers(y[None])[:, :own.shapes.shape[1]])[0]
    angles = width - D
    whole = block_diag(turn, *{0: [], 1: [np.eye(1)], 3: [turn]}[angles])
    stress = tuple(found for each in own.stress
                   if (found := _turned(each, own, one.rows[:, :count], whole)) is not None)
    assert shapes.shape[0] == size * width
    return replace(own, shapes=shapes, coordinates=one.place(own.points) + moved, axes=None,
                   by=None, stress=stress, static=None, labels=None, nodes=None,
                   outlines=None if own.outlines is None else own.outlines @ turn.T
                   if D == 3 else own.outlines)


def _turned(stress: SolidStress | BeamStress | StressModes, own: Recovery, rows: NDArray,
            whole: NDArray) -> SolidStress | BeamStress | StressModes | None:
    """Stresses of the displacements in axes of space; of solids along these."""
    still = own.axes is None
    if isinstance(stress, BeamStress):
        if still:
            return stress
        back = block_diag(whole.T, whole.T)
        return replace(stress, forces=stress.forces @ back)
    if isinstance(stress, SolidStress) and still:
        return stress
    turn = np.eye(3) if own.axes is None else own.axes
    if isinstance(stress, StressModes):
        modes, points, nodes = stress.modes @ own.in_fe_axes(rows.T).T, stress.points, (
            stress.nodes)
    else:
        fields = own.shapes[:, :len(rows)] @ own.in_fe_axes(rows.T).T
        moved = fields.reshape(len(own.coordinates), len(own.node_dofs), -1)
        found = stress.stress(moved)                    # (elements, points, 6, n)
        modes = found.reshape(-1, 6, found.shape[-1])
        points = stress.places().reshape(-1, 3)
        nodes = np.repeat(stress.nodes[:, 0], stress.points_per_element)
    return StressModes(points @ turn.T, _tensors(modes, turn), nodes)


def _tensors(stresses: NDArray, turn: NDArray) -> NDArray:
    """Stresses (p, 6, n) along other axes."""
    order = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
    full = np.einsum("ai,pijn,bj->pabn", turn, stresses[:, order], turn)
    return np.stack([full[:, 0, 0], full[:, 1, 1], full[:, 2, 2], full[:, 1, 2], full[:, 0, 2],
                     full[:, 0, 1]], axis=1)


def _renumbered(stress: SolidStress | BeamStress | StressModes, numbers: NDArray,
                coordinates: NDArray, first: int) -> SolidStress | BeamStress | StressModes:
    """With nodes of the whole; elements keep the undeformed places that strains are of."""
    if not isinstance(stress, SolidStress):
        return stress.restricted(numbers, coordinates)
    places = coordinates.copy()
    places[first:first + len(numbers)] = stress.coordinates
    return stress.restricted(numbers, places)


def _widened(one: Recovery, width: int) -> NDArray:
    """Shapes with zeros for rotations that the nodes of a body do not have."""
    own = len(one.node_dofs)
    whole = np.zeros((len(one.coordinates), width, one.shapes.shape[1]))
    whole[:, :own] = one.shapes.reshape(len(one.coordinates), own, -1)
    return whole.reshape(-1, one.shapes.shape[1])


def _outlines(parts: Sequence[Recovery]) -> NDArray | None:
    """Outlines of all lines, where every body with lines has them, of as many points."""
    lined = [one for one in parts if any(kind == "line" for kind, _ in one.cells)]
    if not lined or any(one.outlines is None for one in lined):
        return None
    count = max(one.outlines.shape[1] for one in lined)
    # a corner again makes a polygon of more corners that looks the same
    return np.vstack([np.concatenate([one.outlines, np.repeat(
        one.outlines[:, -1:], count - one.outlines.shape[1], axis=1)], axis=1) for one in lined])
