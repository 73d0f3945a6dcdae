"""Stiffening of an assembly: load modes and stress resultants, from those of its bodies.

Displacements have rows for the coordinates xi of the linearization, for the slaved coordinates of
all bodies, and for the inertia loads that they answer, which do work of second order themselves.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.vectors import axes_cross
from sebody.contract.names import IN_PLANE
from sebody.explore.assemblies.inertia_sums import of_rigid
from sebody.explore.assemblies.kept_shapes import Kept
from sebody.explore.assemblies.placed_bodies import Placed
from sebody.explore.assemblies.second_order import (
    SecondOrder,
    of_body,
    of_point,
    unit_loads,
)
from sebody.explore.assemblies.states import Given
from sebody.explore.assemblies.wanted import Interfaces
from sebody.fem.beam_elements import symmetric
from sebody.model.parts import DofBlock, Element
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.rigid_motions import rigid_motions
from sebody.reduction.stiffening import GeometricStiffness, Stiffening
from sebody.runs.state_derivatives import derivative
from sebody.small_motion.shapes import Shapes

KNOWN = ("spring", "torsion_spring")    # elements beside joints whose forces have a stiffness here
# Squared frequency of a slaved coordinate over the largest ratio of boundary stiffness and mass:
# that of an axial vibration between clamped ends.
SLAVED = np.pi**2


class Part(NamedTuple):
    """A body, its integrals about the origin, its rows of xi and what it makes of second order."""

    placed: Placed
    inertia: InertiaInvariants
    rows: NDArray           # (n_b, m)
    slaved: slice           # of its slaved coordinates among all
    kappa: NDArray          # their stiffnesses
    second: SecondOrder


class Stiffened:
    """Kept shapes, and what stiffens a model that moves by them.

    Parameters
    ----------
    stiffness : (m, m)
        Of the coordinates of the linearization.
    places : dict
        Of nodes by name, and their rotations, in the state.
    """

    def __init__(self, given: Given, wanted: Interfaces, kept: Kept, stiffness: NDArray,
                 placed: Iterable[Placed], places: dict[str, NDArray]):
        self._run, self._given, self._kept, self._K = given.run, given, kept, stiffness
        self._names, self._places = Shapes(given.run), places
        self._m, self._n = kept.shapes.shape
        self._wanted = wanted
        self._points = np.array([places[name] for name in wanted.names])
        self._origin = self._points.mean(axis=0)
        self._r = given.run.model.rotation_size
        corners = np.array([place for name, place in places.items() if place.ndim == 1])
        self._size = float(np.linalg.norm(corners - self._origin, axis=1).max())
        self._linked: dict[DofBlock, NDArray] = {}
        self.parts: list[Part] = []
        for one in placed:
            self._add(one)
        self._slaved = self.parts[-1].slaved.stop
        self._loads()
        self._tied()

    def _rows(self, name: str, shapes: NDArray | None = None) -> NDArray:
        """Rows of a quantity by xi, or of shapes of the unknowns."""
        free = self._given.linear.free
        return np.atleast_2d(self._names.of(name, free if shapes is None else shapes))

    def _second(self, block: DofBlock) -> NDArray:
        """Second derivative of a place on the kept shapes, (D, n, n); not zero on rigid links."""
        if block not in self._linked:
            D, n = self._run.model.dimension, self._n
            E, found = axes_cross(np.eye(D)), np.zeros((D, n, n))
            for rotation, arm in block.arms:
                if not rotation.solved:
                    continue
                psi = self._rows(rotation.name) @ self._kept.shapes
                vector = self._places[rotation.name] @ arm
                found += np.einsum("kab,lbc,c,ki,lj->aij", E, E, vector, psi, psi)
            self._linked[block] = symmetric(found)
        return self._linked[block]

    def _nodes_rows(self, one: Placed, shapes: NDArray | None) -> NDArray:
        body = self._run.model.bodies[one.name]
        own = body.reduced
        rows = [self._rows(f"{body.nodes[i].name}.position", shapes) for i in own.position_nodes]
        rows += [self._rows(f"{body.nodes[i].name}.rotation", shapes) for i in own.rotation_nodes]
        return np.vstack(rows + ([self._rows(f"{one.name}.modes", shapes)] if own.modes else []))

    def _add(self, one: Placed) -> None:
        own, body = one.body, self._run.model.bodies[one.name]
        assert own.invariants is not None
        origin = self._origin - one.shift
        inertia, rows = own.invariants.about(origin), self._nodes_rows(one, None)
        linked = np.zeros((len(rows), self._n, self._n))
        D = self._run.model.dimension
        for i, node in enumerate(own.position_nodes):
            linked[D * i:D * i + D] = self._second(body.nodes[node].position)
        first = self.parts[-1].slaved.stop if self.parts else 0
        slaved = slice(first, first + inertia.slaved)
        bound = D * len(own.position_nodes)
        ratio = np.linalg.eigvalsh(own.stiffness[:bound, :bound])[-1] / own.total_mass
        kappa = SLAVED * ratio * np.diag(inertia.Mbar)[len(rows):]
        self.parts.append(Part(one, inertia, rows, slaved, kappa, of_body(
            one, inertia, rows @ self._kept.shapes, linked, origin, self._size)))

    def _loads(self) -> None:
        """Unit loads on xi and on slaved coordinates, and their work of second order."""
        free = self._given.linear.free
        unknowns = np.eye(len(free))
        count = len(unit_loads(self.parts[0].inertia, self._size))
        self._on_slaved = np.zeros((self._slaved, count))
        self._on_unknowns = np.zeros((len(free), count))
        self._work = np.zeros((count, self._n, self._n))
        for part in self.parts:
            loads = unit_loads(part.inertia, self._size)
            n = len(part.rows)
            self._on_unknowns += self._nodes_rows(part.placed, unknowns).T @ loads[:, :n].T
            self._on_slaved[part.slaved] = loads[:, n:].T
            self._work += part.second.work
        for one in self._run.model.rigid_bodies.values():
            self._add_rigid(one, unknowns)
        self._on_xi = free.T @ self._on_unknowns

    def _add_rigid(self, one: Element, unknowns: NDArray) -> None:
        node, D = one.attachments[0].node, self._run.model.dimension
        found = of_rigid(one, lambda name: self._rows(name, unknowns), self._places, self._origin,
                         len(unknowns))
        own = InertiaInvariants(**found, mass=one.number("mass"), Q=np.zeros((0,) * 3),
                                lam=np.zeros(0), E=np.zeros((0, 0)), Ghat=np.zeros((0,) * 3))
        self._on_unknowns += unit_loads(own, self._size).T
        moved, arm = self._second(node.position), np.zeros(D)
        if one.kind.endswith("rigid_body"):
            arm = self._places[f"{node.name}.rotation"] @ one.vector("mc") / one.number("mass")
            psi, E = self._rows(f"{node.name}.rotation") @ self._kept.shapes, axes_cross(np.eye(D))
            moved = moved + symmetric(np.einsum("kab,lbc,c,ki,lj->aij", E, E, arm, psi, psi))
        self._work += of_point(one.number("mass"),
                               self._places[node.name] + arm - self._origin, moved, self._size)

    def _tied(self) -> None:
        """Joints and interfaces: rows of the unknowns, and tangents as they are in the state."""
        run, n = self._run, len(self._given.linear.free)
        self._tangent = self._stiffness_of_unknowns()
        self._multipliers = np.flatnonzero(run.system.is_multiplier[:n])
        self._moving = np.setdiff1d(np.arange(n), self._multipliers)
        held = np.vstack([self._rows(name, np.eye(n)) for name in self._wanted.rows])
        self._held = held
        blocks = [self._run.model.nodes[name].position for name, keep in zip(
            *self._wanted, strict=True) if keep != "rotation"]
        seconds = [self._second(block) for block in blocks]
        self._of_interfaces = np.concatenate(seconds)

    def _stiffness_of_unknowns(self) -> NDArray:
        return derivative(self._run, 0.0, 0.0, 1.0).toarray()

    def geometric(self, displacements: NDArray, on: NDArray | None) -> NDArray:
        """G (k, n, n) of displacements, on the kept coordinates or combinations of them."""
        m, s = self._m, self._slaved
        found = []
        for one in displacements.T:
            found.append(self._one(one[:m], one[m:m + s], one[m + s:]))
        G = symmetric(np.array(found).reshape(-1, self._n, self._n))
        return G if on is None else on.T @ G @ on

    def _one(self, u: NDArray, eta: NDArray, loads: NDArray) -> NDArray:
        found = -np.einsum("c,cij->ij", loads, self._work)
        for part in self.parts:
            moved, second, own = part.rows @ u, part.second, part.inertia
            found += np.einsum("a,aij->ij", part.placed.body.stiffness @ moved, second.turned)
            local = moved - (part.placed.body.rigid_modes_about(
                self._origin - part.placed.shift)[:, self._run.model.dimension:]
                @ (part.placed.frame @ moved))
            inner = np.einsum("e,eab->ab", own.E.T @ local, own.Ghat)
            inner -= np.einsum("s,sab->ab", eta[part.slaved] * part.kappa, own.Q)
            found += second.local.T @ inner @ second.local
        for load in self._run.model.loads:
            found += self._of_element(load, u)
        reactions = self._kept.shapes[:, :len(self._held)].T @ (
            self._K @ u - self._on_xi @ loads)
        found -= np.einsum("a,aij->ij", reactions[:len(self._of_interfaces)], self._of_interfaces)
        return found + self._of_joints(u, loads, reactions)

    def _of_element(self, load: Element, u: NDArray) -> NDArray:
        ends, shapes = load.attachments, self._kept.shapes
        kind, k = load.kind.removeprefix(IN_PLANE), load.number("k")
        if kind == "spring":
            names = [f"{one.node.name}.position" for one in ends]
            places = [self._places[one.node.name] for one in ends]
            d = places[1] - places[0]
            length = np.linalg.norm(d)
            n = d / length
            rows = self._rows(names[1]) - self._rows(names[0])
            across = (rows - np.outer(n, n @ rows)) @ shapes
            second = across.T @ across / length + np.einsum(
                "a,aij->ij", n, self._second(ends[1].dof_block) - self._second(ends[0].dof_block))
            return k * (n @ rows @ u) * second
        if self._r == 1 or len(ends) < 2:
            return np.zeros((self._n, self._n))
        rows = [self._rows(f"{one.node.name}.rotation") for one in ends]
        n, m = load.vector("n"), load.vector("m")
        axis = self._places[f"{ends[0].node.name}.rotation"] @ np.cross(n, m)
        moment = k * (axis @ (rows[1] - rows[0]) @ u)
        return -moment * symmetric(np.einsum(
            "a,kab,ki,bj->ij", axis, axes_cross(np.eye(3)), rows[0] @ shapes, rows[1] @ shapes))

    def _of_joints(self, u: NDArray, loads: NDArray, reactions: NDArray) -> NDArray:
        """Stiffness of the forces of explicit constraints: by the tangent with their multipliers.
        """
        if not self._multipliers.size:
            return np.zeros((self._n, self._n))
        moving, free = self._moving, self._given.linear.free
        forces = (self._on_unknowns @ loads + self._held.T @ reactions
                  - self._tangent @ (free @ u))[moving]
        columns = self._tangent[np.ix_(moving, self._multipliers)]
        values = np.linalg.lstsq(columns, forces, rcond=1e-10)[0]
        state = self._run.state
        before = state.q[self._multipliers].copy()
        state.q[self._multipliers] += values
        change = self._stiffness_of_unknowns() - self._tangent
        state.q[self._multipliers] = before
        change[self._multipliers] = 0.0
        change[:, self._multipliers] = 0.0
        whole = free @ self._kept.shapes
        return whole.T @ change @ whole

    def constants(self, mass: NDArray, stiffness: NDArray, inertia: NDArray) -> Stiffening:
        """Load modes, by xi and slaved coordinates, and resultants.

        Parameters
        ----------
        mass, stiffness : (n, n)
            Reduced.
        inertia : (m, m)
            Mass of xi.
        """
        kept, m, s = self._kept, self._m, self._slaved
        count, held = self._on_xi.shape[1], len(self._held)
        kappa = np.concatenate([part.kappa for part in self.parts])
        loads = np.vstack([self._on_xi, self._on_slaved, np.zeros((count, count))])
        answers = np.vstack([kept.flexibility @ self._on_xi, self._on_slaved / kappa[:, None],
                             np.eye(count)])
        basis = np.vstack([kept.shapes, np.zeros((s + count, self._n))])
        D = self._points.shape[1]
        scale = np.full(held, self._size)
        scale[:len(self._of_interfaces)] = 1.0
        rigid = rigid_motions(self._points, self._wanted.keeps, self._n, self._origin)
        rigid = rigid / [*[1.0] * D, *[self._size] * (rigid.shape[1] - D)]
        whole = np.zeros((m + s, m + s))
        for part in self.parts:
            Z = np.zeros((len(part.inertia.Mbar), m + s))
            n = len(part.rows)
            Z[:n, :m] = part.rows
            Z[n:, m + part.slaved.start:m + part.slaved.stop] = np.eye(part.inertia.slaved)
            whole += Z.T @ part.inertia.Mbar @ Z
        whole[:m, :m] = inertia
        return GeometricStiffness(
            self.geometric, basis, stiffness, mass, scale, rigid, self._largest).stiffening(
                loads, answers, lambda moved: moved[:m + s].T @ whole @ moved[:m + s])

    def _largest(self, displacements: NDArray) -> NDArray:
        """Largest rotation of a node, or displacement over the size, (k,)."""
        u = displacements[:self._m]
        found = np.zeros(u.shape[1])
        total = sum(part.placed.body.total_mass for part in self.parts)
        for part in self.parts:
            D = self._points.shape[1]
            moved = part.rows @ u
            split = D * len(part.placed.body.position_nodes)
            end = len(moved) - part.placed.body.modes
            places = moved[:split].reshape(-1, D, u.shape[1])
            turns = moved[split:end].reshape(-1, self._r, u.shape[1])
            modal = np.sqrt(np.diag(part.inertia.Mbar)[end:len(moved)]
                            / part.placed.body.total_mass)
            for each in (np.linalg.norm(places, axis=1) / self._size,
                         np.linalg.norm(turns, axis=1),
                         np.abs(modal[:, None] * moved[end:]) / self._size):
                found = np.maximum(found, each.max(axis=0, initial=0.0))
        eta = displacements[self._m:self._m + self._slaved]
        for part in self.parts:
            modal = np.sqrt(np.diag(part.inertia.Mbar)[len(part.rows):] / total)
            found = np.maximum(found, (np.abs(modal[:, None] * eta[part.slaved])
                                       / self._size).max(axis=0, initial=0.0))
        return np.where(found > 0, found, 1.0)

    def with_load_modes(self, found: Stiffening) -> tuple[NDArray, list[Placed]]:
        """Motion of the unknowns by kept shapes and load modes, and the bodies with that of both.
        """
        shapes = np.hstack([self._kept.shapes, found.load_modes[:self._m]])
        eta = found.load_modes[self._m:self._m + self._slaved]
        before = np.zeros((self._slaved, self._n))
        slaved = np.hstack([before, eta])
        return self._given.linear.free @ shapes, [
            part.placed._replace(rows=part.rows @ shapes, slaved=slaved[part.slaved])
            for part in self.parts]
