"""Beams and frames of two-node elements, spatial and planar."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs, memory
from sebody.basics.errors import InputError
from sebody.fem.axis import Axis
from sebody.fem.beam_elements import BeamElements
from sebody.fem.beam_model import beam_model
from sebody.fem.exact_elements import Rule, Straight, exact_elements, rules_of
from sebody.fem.general_section import GeneralSection
from sebody.fem.model import FEModel
from sebody.fem.section import StiffnessSection
from sebody.fem.section_along import AnySection
from sebody.fem.straight_elements import straight_elements

OF_ELEMENT = 4000       # bytes: entries of its matrices, and what their assembly needs


def straight_beam(
    start: ArrayLike,
    end: ArrayLike,
    section: AnySection,
    elements: int,
    up: ArrayLike | None = None,
) -> FEModel:
    """Spatial beam of equal elements; node 0 at `start`, node `elements` at `end`.

    Parameters
    ----------
    start, end : (3,)
        Ends of the beam's axis [length].
    section : Section, StiffnessSection or function
        Cross-section: one for the whole beam, or a function of the place along its axis, from 0
        at `start` to 1 at `end`, that returns one, for tapered beams and for beams of pieces. Each
        element has the section of its middle: errors of second order in its length.
    elements : int
        Number of elements.
    up : (3,), optional
        Direction of the section's y axis (its part normal to the beam). Default: the section's
        z axis points along global z as far as it can, so `inertia_z` bends in the xy plane.

    Raises
    ------
    InputError
        Coincident ends, no element, or `up` along the beam.
    """
    return _line(_points([start, end], 3), section, elements, up)


def planar_beam(start: ArrayLike, end: ArrayLike, section: AnySection, elements: int) -> FEModel:
    """Beam in the xy plane, DOFs (x, y, rz) per node, bending with `inertia_z`.

    Parameters as for `straight_beam`, with `start` and `end` of shape (2,).
    """
    return _line(_points([start, end], 2), section, elements, None)


def frame(
    points: ArrayLike,
    members: Sequence[tuple[int, int]],
    section: AnySection,
    elements: int,
    up: ArrayLike | None = None,
) -> FEModel:
    """Straight members joined rigidly where they share a point.

    Parameters
    ----------
    points : (n_points, 3), planar (n_points, 2)
        Joints and free ends [length]; they are nodes 0 to n_points - 1 of the model, the nodes
        inside the members follow.
    members : sequence of (int, int)
        Start and end point of each member.
    section : Section, StiffnessSection or function
        Cross-section of all members, or a function of the place along each, as for
        `straight_beam`.
    elements : int
        Number of elements in each member.
    up : (3,), optional
        As for `straight_beam`.

    Raises
    ------
    InputError
        A member with an unknown point or no length, one that is given twice, no element, `up`
        along a member, or `up` in a plane.
    """
    points = inputs.reals(points, "points", "give 2 or 3 finite coordinates for each")
    points = _points(points, 2 if points.shape[-1:] == (2,) else 3)
    pairs_of_nodes = _members(members, len(points))
    elements = _count(elements, len(pairs_of_nodes))
    nodes, pairs = list(points), []
    for first, last in pairs_of_nodes:
        inner = range(len(nodes), len(nodes) + elements - 1)
        nodes.extend(np.linspace(points[first], points[last], elements + 1)[1:-1])
        chain = [first, *inner, last]
        pairs.extend(pairwise(chain))
    return _beam_model(np.array(nodes), np.array(pairs), section, elements, up)


def _members(members: Sequence[tuple[int, int]], points: int) -> list[tuple[int, int]]:
    """Start and end of each member."""
    remedy = "give pairs (start, end) of numbers of points"
    pairs: list[tuple[int, int]] = []
    for member in inputs.items(members, "members", remedy):
        pair = inputs.items(member, "a member", remedy)
        if len(pair) != 2:
            raise inputs.refusal("a member", member, remedy)
        ends = tuple(inputs.integer(point, f"a point of member {member}") for point in pair)
        if not all(0 <= point < points for point in ends):
            raise InputError(f"member {member} names an unknown point: there are points 0 to "
                             f"{points - 1}")
        if ends in pairs or ends[::-1] in pairs:
            raise InputError(f"member {member} is given twice: leave one out")
        pairs.append(ends)
    if not pairs:
        raise InputError(f"members is empty: {remedy}")
    return pairs


def _line(ends: NDArray, section: AnySection, elements: int, up: ArrayLike | None) -> FEModel:
    elements = _count(elements)
    nodes = np.linspace(ends[0], ends[1], elements + 1)
    first = np.arange(elements)
    return _beam_model(nodes, np.column_stack([first, first + 1]), section, elements, up)


def _points(points: ArrayLike, dimension: int) -> NDArray:
    remedy = f"give {dimension} finite coordinates for each"
    return inputs.array(points, "points", (None, dimension), remedy=remedy)


def _count(elements: int, members: int = 1) -> int:
    """Number of elements, of each member of a frame."""
    count = inputs.integer(elements, "elements", least=1)
    memory.check(float(OF_ELEMENT) * count * members, f"elements is {count}: the model",
                 "give fewer elements")
    return count


def _beam_model(
    nodes: NDArray, pairs: NDArray, section: AnySection, elements: int, up: ArrayLike | None
) -> FEModel:
    """One element for each pair of nodes; `elements` of them in a row make a member."""
    if up is not None:
        if nodes.shape[1] == 2:
            raise InputError("up is for beams in space: a planar beam bends with inertia_z")
        up = inputs.vector(up, "up", 3)
    places = np.linspace(0, 1, elements + 1)
    groups: list[BeamElements] = []
    uniform, axes, lengths, middles = [], [], [], []
    for k, own in enumerate(pairs.reshape(-1, elements, 2)):
        ends = np.zeros((2, 3))
        ends[:, :nodes.shape[1]] = nodes[[own[0, 0], own[-1, 1]]]
        turn = section_axes(ends[1] - ends[0], up)
        line = Straight(ends[0], ends[1], turn.T)
        rules = rules_of(line, section, places)
        exact = [i for i, one in enumerate(rules) if not _has_closed_form(one)]
        uniform += [k * elements + i for i, one in enumerate(rules) if _has_closed_form(one)]
        if exact:
            if nodes.shape[1] == 2:
                _refuse_coupled(rules)
            groups += exact_elements(line, [rules[i] for i in exact], own[exact],
                                     nodes.shape[1] == 2)
        axes += [turn] * elements
        lengths += [line.length / elements] * elements
        middles += [one.middle for one in rules]
    if uniform:
        groups.append(straight_elements(nodes, pairs[uniform], np.array(lengths)[uniform],
                                        np.array(axes)[uniform], [middles[i] for i in uniform]))
    return beam_model(nodes, groups, pairs, np.array(axes), middles)


def _has_closed_form(one: Rule) -> bool:
    return isinstance(one.middle, StiffnessSection) and one.uniform


def _refuse_coupled(rules: list[Rule]) -> None:
    if any(isinstance(one.middle, GeneralSection) for one in rules):
        raise InputError("a GeneralSection is for beams in space: give a planar beam a "
                         "StiffnessSection")


def section_axes(axis: NDArray, up: ArrayLike | None) -> NDArray:
    """Rows: member axis x, section axes y and z, in global axes."""
    length = np.linalg.norm(axis)
    if length == 0:
        raise InputError("a beam has both ends at the same point; give it a length")
    x = axis / length
    if up is None:
        vertical = np.hypot(x[0], x[1]) < 1e-6
        up = np.array([0.0, 1.0, 0.0]) if vertical else np.cross([0.0, 0.0, 1.0], x)
    y = up - (up @ x) * x
    if np.linalg.norm(y) <= 1e-6 * np.linalg.norm(up):
        raise InputError(f"up = {up.tolist()} lies along a beam; choose another direction")
    y /= np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])


def beam_along(axis: Axis, section: AnySection, elements: int | ArrayLike) -> FEModel:
    """Beam along an axis that may curve and twist, in space.

    Elements are exact for end loads whatever the axis and the sections, see
    `sebody.fem.exact_elements`: two of them give the tip of a twisted blade to 1e-9. Frequencies
    converge with the square of their length.

    Parameters
    ----------
    axis : Axis
    section : Section, StiffnessSection, GeneralSection, Stations or function
        As for `straight_beam`, in the axes of `axis`; a function must be smooth within the
        elements, `Stations` need not be.
    elements : int or (n + 1,)
        Number of elements of equal length, or the places of their ends, parts of the length of
        the axis: of the whole axis or of a part of it.

    Raises
    ------
    InputError
        No axis, no section, no element, or places that do not ascend between 0 and 1.

    Examples
    --------
    >>> spring = beam_along(Axis(helix), circle(0.01, 2.1e11, 0.3, 7850.0), 80)
    """
    inputs.instance(axis, "axis", Axis, "give an Axis")
    if np.ndim(elements) == 0:
        places = np.linspace(0, 1, _count(inputs.integer(elements, "elements", least=1)) + 1)
    else:
        remedy = "give a number of elements, or two places at least that ascend from 0 to 1"
        places = inputs.vector(elements, "elements: places", remedy=remedy)
        if len(places) < 2 or places[0] < 0 or places[-1] > 1 or (np.diff(places) <= 0).any():
            raise inputs.refusal("elements: places", places.tolist(), remedy)
        _count(len(places) - 1)
    rules = rules_of(axis, section, places)
    first = np.arange(len(rules))
    pairs = np.column_stack([first, first + 1])
    groups = exact_elements(axis, rules, pairs)
    axes = axis.axes((places[1:] + places[:-1]) / 2).transpose(0, 2, 1)
    return beam_model(axis.position(places), groups, pairs, axes, [one.middle for one in rules])
