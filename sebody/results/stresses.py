"""Stresses inside a superelement in recorded states: of whole fields, or of single nodes over time.

The displacements whose stresses are taken are those of the reduced coordinates, with two changes:

* Coordinates that follow in second order shorten a bent body without straining it, so they are
  left out. With inertia option C the resultants ``s_e = lam_e E_e^T y + y^T Ghat_e y / 2`` carry
  what bending adds to them: y moves on by ``S^+ E_e y^T Ghat_e y / 2``.
* The static response of the omitted modes to the body's inertia and weight, and to the loads on the
  body itself, is added, see `sebody.reduction.static_correction`.
"""

from __future__ import annotations

from copy import copy
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.fem.beam_stress import BeamStress
from sebody.fem.stress import SolidStress, StressModes, von_mises
from sebody.generated.options import INERTIA_OPTIONS
from sebody.model.parts import Superelement
from sebody.results.motion import BodyMotion

BLOCK = 2**23       # numbers that the stresses of some states may take at once


class Stresses:
    """Stresses of a superelement.

    Parameters
    ----------
    body : Superelement
    motion : BodyMotion
        In all recorded states.
    gravity : (n, D)
        In global axes, in all recorded states.
    loads : (n, loads of the body), optional
        Their amplitudes in all recorded states, if the static response of the omitted modes is
        added.

    Raises
    ------
    InputError
        A body whose FE model has no stress operator.
    """

    def __init__(self, body: Superelement, motion: BodyMotion, gravity: NDArray,
                 loads: NDArray | None):
        self._body, self._motion, self._gravity = body, motion, gravity
        recovery = body.reduced.recovery
        assert recovery is not None     # see FieldStates
        self._recovery = recovery
        if not self._recovery.stress:
            raise InputError(f"body {body.name!r} has no known stresses: "
                             f"{body.reduced.lacks['stresses']}")
        operators = self._recovery.stress
        self._solids = [one for one in operators if isinstance(one, SolidStress)]
        self._beams = [one for one in operators if isinstance(one, BeamStress)]
        self._modes = [one for one in operators if isinstance(one, StressModes)]
        n, width = len(body.reduced.stiffness), len(self._recovery.node_dofs)
        count = len(self._recovery.coordinates)
        self._shapes = [self._recovery.shapes[:, :n].reshape(count, width, n)]
        self._amplitudes = [self._recovery.in_fe_axes(self._strained())]
        if loads is not None and self._recovery.static is not None:
            self._shapes.append(self._recovery.static.reshape(count, width, -1))
            self._amplitudes.append(np.hstack([self._inertia(), loads]))

    @property
    def amplitudes(self) -> NDArray:
        """Amplitudes of all shapes that strain the body, the static ones last, (n, s)."""
        return np.hstack(self._amplitudes)

    def of_unit_amplitudes(self) -> Stresses:
        """The same in s states, in each of which one amplitude is one and all others are zero."""
        other = copy(self)
        ends = np.cumsum([part.shape[1] for part in self._amplitudes])
        other._amplitudes = np.split(np.eye(ends[-1]), ends[:-1], axis=1)
        return other

    @property
    def states_at_once(self) -> int:
        """States whose stresses are computed together."""
        numbers = 6 * 4 * (sum(one.nodes.size for one in self._solids)
                           + sum(one.nodes.size for one in self._beams))
        return int(max(1, BLOCK // max(numbers, 1)))

    def at_nodes(self, states: NDArray, what: str = "stress") -> NDArray:
        """Stresses or strains of all nodes, (states, nodes, 6): means of the solid elements around.

        Of beams that of the most stressed fibre of the sections at a node, in the axes of its
        section. NaN where nothing is known.
        """
        count = len(self._recovery.coordinates)
        nodal = np.full((len(states), count, 6), np.nan)
        self._refuse_strain(what)
        moved = self._moved(states)
        if self._solids:
            parts = [one.at_nodes(getattr(one, what)(moved)) for one in self._solids]
            # (elements and nodes, 6 states)
            whole = np.concatenate([part.reshape(-1, 6 * len(states)) for part in parts])
            mean = (self._averaging @ whole).reshape(count, 6, len(states)).transpose(2, 0, 1)
            nodal[:, self._held] = mean[:, self._held]
        for one in self._modes:
            known = np.flatnonzero(one.nodes >= 0)
            values = np.einsum("pca,sa->spc", one.modes[known], self._amplitudes[0][states])
            nodal[:, one.nodes[known]] = values
        for beam in self._beams:
            self._most_stressed(beam, beam.stress(moved), nodal)
        return nodal

    def at_points(self, states: NDArray, what: str = "stress") -> NDArray:
        """Stresses at points of integration or fibres, in the order of `places`, (states, p, 6)."""
        self._refuse_strain(what)
        moved = self._moved(states)
        parts = [getattr(one, what)(moved) for one in (*self._solids, *self._beams)]
        parts = [part.reshape(-1, 6, len(states)).transpose(2, 0, 1) for part in parts]
        parts += [np.einsum("pca,sa->spc", one.modes, self._amplitudes[0][states])
                  for one in self._modes]
        return np.concatenate(parts, axis=1)

    def places(self) -> NDArray:
        """The points of integration, and the nodes of the fibres, in FE axes, (p, D)."""
        coordinates = self._recovery.coordinates
        points = [one.places().reshape(-1, 3) for one in self._solids]
        points += [np.repeat(coordinates[one.nodes.ravel()], one.fibres.shape[2], axis=0)
                   for one in self._beams]
        return np.concatenate(points + [one.points for one in self._modes])

    def of_node(self, node: int, what: str = "stress") -> NDArray:
        """History at one node, (n, 6): the elements around it alone, each shape once."""
        self._refuse_strain(what)
        # of the shapes, then of the static ones: (6, s) of each element around
        rows: list[NDArray] = []
        for one in self._solids:
            elements, local = np.nonzero(one.nodes == node)
            if len(elements):
                values = self._of_elements(one, elements, what)
                values = one.at_nodes(values)[np.arange(len(elements)), local]
                rows.extend(values)
        if rows:
            return self._history(np.mean(rows, axis=0))
        for modes in self._modes:
            own = np.flatnonzero(modes.nodes == node)
            if len(own):
                return self._amplitudes[0] @ modes.modes[own[-1]].T
        fibres = self.fibres_of_node(node)
        if not fibres.shape[1]:
            raise InputError(f"the stress of body {self._body.name!r} is unknown at node "
                             f"{self._recovery.called(node)}: no element with a known stress has "
                             "this node")
        worst = von_mises(fibres).argmax(axis=1)
        return fibres[np.arange(len(fibres)), worst]

    def fibres_of_node(self, node: int) -> NDArray:
        """Histories in all fibres of the sections at a node, (n, fibres, 6)."""
        rows = [values.reshape(-1, *values.shape[2:])
                for values in self._at_ends(node, "stress")]
        whole = np.concatenate(rows) if rows else np.zeros((0, 6, self._size))
        return np.stack([self._history(row) for row in whole], axis=1) if len(whole) else (
            np.zeros((len(self._amplitudes[0]), 0, 6)))

    def fibres_by_section_forces(self, node: int) -> NDArray | None:
        """Stresses of unit section forces in all fibres at a node, (fibres, 6, ends * 6).

        Fibres and ends of elements are in the order of `fibres_of_node` and
        `sections_of_node`. None where the stress is that of solid elements.
        """
        of_solids = [one.nodes for one in self._solids] + [one.nodes for one in self._modes]
        if any((nodes == node).any() for nodes in of_solids):
            return None
        fibres = [own for one in self._beams for own in one.fibres[one.nodes == node]]
        whole = np.zeros((sum(map(len, fibres)), 6, 6 * len(fibres)))
        first = 0
        for k, own in enumerate(fibres):
            whole[first:first + len(own), [0, 5, 4], 6 * k:6 * k + 6] = own
            first += len(own)
        return whole

    def sections_of_node(self, node: int, what: str = "section_forces") -> NDArray:
        """Section forces, or section_strains, of the element ends at a node, (n, ends, 6)."""
        rows = [row for values in self._at_ends(node, what) for row in values]
        if not rows:
            raise InputError(f"body {self._body.name!r} has no beam element at node "
                             f"{self._recovery.called(node)}, so there are no "
                             f"{what.replace('_', ' ')}")
        return np.stack([self._history(row) for row in rows], axis=1)

    def of_sections(self, states: NDArray, what: str = "section_forces") -> NDArray:
        """Section forces, or section_strains, at both ends, (states, elements, 2, 6)."""
        if not self._beams:
            raise InputError(f"body {self._body.name!r} has no beam elements, so there are no "
                             f"{what.replace('_', ' ')}")
        moved = self._moved(states)
        return np.concatenate([getattr(one, what)(moved) for one in self._beams]).transpose(
            3, 0, 1, 2)

    @property
    def _size(self) -> int:
        return sum(part.shape[1] for part in self._amplitudes)

    def _history(self, row: NDArray) -> NDArray:
        """Values over time (n, 6) of those of unit amplitudes (6, s)."""
        return self.amplitudes @ row.T

    def _of_elements(self, one: SolidStress | BeamStress, elements: NDArray, what: str) -> NDArray:
        """Values of unit amplitudes, the shapes along the last axis."""
        return np.concatenate([getattr(one, what)(shapes, elements) for shapes in self._shapes],
                              axis=-1)

    def _at_ends(self, node: int, what: str) -> list[NDArray]:
        """Values of unit amplitudes at the element ends at a node, (ends, ..., s) a kind."""
        values = []
        for one in self._beams:
            elements, end = np.nonzero(one.nodes == node)
            if len(elements):
                values.append(self._of_elements(one, elements, what)[np.arange(len(end)), end])
        return values

    def _moved(self, states: NDArray) -> NDArray:
        """DOFs of all nodes in some states, in FE axes, (nodes, width, states)."""
        count, width, _ = self._shapes[0].shape
        return sum(shapes.reshape(count * width, -1) @ amplitudes[states].T
                   for shapes, amplitudes in zip(self._shapes, self._amplitudes, strict=True)
                   ).reshape(count, width, -1)

    def _strained(self) -> NDArray:
        """Reduced coordinates (n, N) whose linear stresses are those of the body."""
        y, reduced = self._motion.y, self._body.reduced
        i = reduced.invariants
        if not INERTIA_OPTIONS[self._body.inertia].field or i is None or not i.resultants:
            return y
        second = np.einsum("si,eij,sj->se", y, i.Ghat, y, optimize=True) / 2
        return y + second @ (np.linalg.pinv(reduced.stiffness, rcond=1e-12, hermitian=True) @ i.E).T

    def _inertia(self) -> NDArray:
        """Amplitudes of the static shapes: minus the accelerations that load the body, (n, ...)."""
        reduced, m = self._body.reduced, self._motion
        planar, first_mode = reduced.planar, len(reduced.stiffness) - reduced.modes
        middle = reduced.coordinates.mean(axis=0)
        arm = middle - self._body.alpha @ reduced.coordinates[list(reduced.position_nodes)]
        if planar:
            across = np.array([-arm[1], arm[0]])
            centre = m.acceleration + m.spin_rate * across - m.spin**2 * arm
        else:
            centre = (m.acceleration + np.cross(m.spin_rate, arm)
                      + np.cross(m.spin, np.cross(m.spin, arm)))
        felt = centre - np.einsum("nji,nj->ni", m.rotation, self._gravity)
        rigid = reduced.rigid_modes_about(middle)[:first_mode]
        boundary = np.hstack([felt, m.spin_rate]) @ rigid.T + m.y_second[:, :first_mode]
        spin, recovery = m.spin, self._recovery
        if recovery.by is not None:
            boundary = boundary @ recovery.by[:first_mode, :first_mode]
            spin = spin if planar else spin @ recovery.axes
        pairs = [(k, j) for k in range(spin.shape[1]) for j in range(k, spin.shape[1])]
        products = np.stack([spin[:, k] * spin[:, j] for k, j in pairs], axis=1)
        return np.hstack([-boundary, products])

    @cached_property
    def _averaging(self) -> sparse.csr_array:
        """Mean over the elements around each node, (nodes, elements and nodes)."""
        owners = np.concatenate([one.nodes.ravel() for one in self._solids])
        count = np.bincount(owners, minlength=len(self._recovery.coordinates))
        return sparse.csr_array((1.0 / count[owners], (owners, np.arange(len(owners)))),
                                shape=(len(count), len(owners)))

    @cached_property
    def _held(self) -> NDArray:
        """Nodes of solid elements."""
        return np.unique(np.concatenate([one.nodes.ravel() for one in self._solids]))

    @staticmethod
    def _most_stressed(one: BeamStress, stress: NDArray, found: NDArray) -> None:
        """Enter the stress of the worst fibre at each node, of (elements, 2, p, 6, states)."""
        _, _, p, _, states = stress.shape
        owners = np.repeat(one.nodes.ravel(), p)
        flat = stress.reshape(-1, 6, states)
        for k in range(states):
            worst = np.lexsort((von_mises(flat[:, :, k]), owners))
            last = worst[np.flatnonzero(np.diff(owners[worst], append=-1))]
            found[k, owners[last]] = flat[last, :, k]

    def _refuse_strain(self, what: str) -> None:
        if what == "strain" and not self._solids:
            raise InputError(f"body {self._body.name!r} has no solid elements, so there are no "
                             "strains: of beams there are section_strains, section_forces and "
                             "stress")
