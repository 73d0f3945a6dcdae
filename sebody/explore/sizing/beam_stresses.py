"""The largest stresses in the elements of a beam during a run, and their derivatives by heights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.body_constants import superelement_constants
from sebody.assembly.contracts import constants_row, counts_of
from sebody.contract.layout import Row
from sebody.explore.sizing.held_beams import Held
from sebody.gradients.gradient import Differentiated
from sebody.gradients.slopes import Slopes
from sebody.gradients.sweeps import forward
from sebody.kernels.loader import load
from sebody.model.model import Model
from sebody.model.parts import Superelement
from sebody.reduction.body import ReducedBody
from sebody.results import rotations
from sebody.results.motion import body_motion
from sebody.results.recording import Recording
from sebody.small_motion.moved_states import STEPS, WEIGHTS

RANK = 1e-12        # of the largest: independent changes of the reduced matrices
STEP = 0.1          # of the matrices, by which they are changed: constants and residuals are linear
TURN = 1e-4         # of differences of reduced coordinates, in radians and in lengths of the beam


class StressedBeam:
    """The largest stresses in a run with some heights.

    Parameters
    ----------
    model : Model
        With the beam as it is here; also for `differentiate`.
    held : Held
    part : Superelement
        Of the model.
    one : Differentiated
    constants : ConstantRows
    turn : (D, D)
        From axes of the beam to those of the model.

    Attributes
    ----------
    values, times : (elements,)
        Largest normal stress in each element at any time, and when.
    slopes : (elements, elements) or None
        Their derivatives by the heights, once `differentiate` has found them.
    """

    def __init__(self, model: Model, held: Held, part: Superelement, one: Differentiated,
                 constants: ConstantRows, turn: NDArray):
        self.model, self.held, self.part, self.one = model, held, part, one
        self.constants = constants
        D, n = len(turn), held.stiffness.shape[0]
        self.Q = np.eye(n)      # from axes of the beam to those of the model
        for k in range(2 if held.beam.planar else 4):
            own = slice(D * k, D * (k + 1))
            self.Q[own, own] = turn
        count = held.beam.count
        both = self._coordinates(one.history.states)
        fields = held.fields(*both)
        forces = held.section_forces(fields)
        each = np.einsum("tegf,epf->tegp", forces, held.elements.fibres, optimize=True)
        flat = np.abs(each).transpose(1, 0, 2, 3).reshape(count, -1)
        found, places = flat.argmax(axis=1), np.arange(count)
        self.when, self.end, self.fibre = np.unravel_index(found, (len(fields), *each.shape[2:]))
        self.sign = np.sign(each[self.when, places, self.end, self.fibre])
        self.values, self.times = flat[places, found], one.history.times[self.when]
        self.fields, self.c = fields[self.when], both[1][self.when]
        self.forces = forces[self.when, places, self.end]
        self.slopes: NDArray | None = None

    def differentiate(self) -> None:
        """Find the derivatives of the largest stresses by all heights."""
        held, beam = self.held, self.held.beam
        places = np.arange(beam.count)
        loads = np.zeros((beam.size, beam.count))
        loads[beam.dofs.T, places] = self._rows().T
        displaced = held.inverse(loads)
        found = self._explicit(displaced)
        found[places, places] += self.sign * self._own()
        events, at = np.unique(self.when, return_inverse=True)
        coefficients, motion = self._motion(events)
        none = np.zeros((beam.count, beam.modes))
        by = np.hstack([loads.T @ held.Psi, none, -displaced.T @ (held.M @ held.T)])
        self.slopes = found + np.einsum("ei,eik->ek", by, motion[at]) @ coefficients

    def _rows(self) -> NDArray:
        """Derivatives of the stress of each element by its DOFs, (elements, k)."""
        own, e = self.held.elements, np.arange(len(self.end))
        return self.sign[:, None] * np.einsum("ef,efa->ea", own.fibres[e, self.fibre],
                                              own.forces[e, self.end])

    def _own(self) -> NDArray:
        """Derivatives by the height of the element itself, displacements held."""
        held, e = self.held, np.arange(len(self.end))
        u = self.fields[e[:, None], held.beam.dofs]
        return np.einsum("ef,ef->e", held.by_height.fibres[e, self.fibre], self.forces) + np.einsum(
            "ef,efa,ea->e", held.elements.fibres[e, self.fibre],
            held.by_height.forces[e, self.end], u)

    def _explicit(self, displaced: NDArray) -> NDArray:
        """Derivatives with the motion held, by displacements: of stiffness and of mass.

        Parameters
        ----------
        displaced : (size, stresses)
            Of the clamped beam to what each stress is of its displacements.
        """
        fields, c = self.fields, self.c
        held, dofs = self.held, self.held.beam.dofs
        static = c[:, :len(held.beam.order)] @ held.Psi.T
        found = np.zeros((len(fields), len(dofs)))
        for one, change, of in (
                (-displaced, held.by_height.stiffness, fields),
                (-displaced, held.by_height.mass, c @ held.T.T),
                (held.inverse(held.M @ displaced), held.by_height.stiffness, static)):
            found += ((change.transpose(0, 2, 1) @ one[dofs]) * of.T[dofs]).sum(axis=1).T
        return found

    def _motion(self, events: NDArray) -> tuple[NDArray, NDArray]:
        """Derivatives of the heights' independent changes of the matrices, (k, elements), and of
        reduced coordinates by these in some recorded states, (states, n, k).
        """
        one, coefficients, rows = self.one, *self._directions()
        slopes = Slopes(self.model, one.run, one.history, lambda made, states: np.zeros(0))
        place = one.run.numbering.constants_at[self.part]
        rows *= STEP
        for full in self.constants.full:    # no entry is skipped
            rows[:, full] = len(self.Q) - one.run.system.constants[place + full]
        residuals = slopes.by_constants(place, rows) / STEP
        none = np.zeros((one.linear.free, len(rows)))
        found = np.zeros((3, len(events), *none.shape))
        wanted = {int(one.history.recorded[k]): i for i, k in enumerate(events)}

        def see(first: int, states: NDArray) -> None:
            for event, state in enumerate(states, first):
                if event in wanted:
                    found[:, wanted[event]] = state
        forward(one.course, residuals, none, none, see)
        return coefficients, np.sum([by @ of for by, of in zip(
            self._by_motion(events), found, strict=True)], axis=0)

    def _directions(self) -> tuple[NDArray, NDArray]:
        """Independent changes of stiffness and mass, as rows of constants."""
        held = self.held
        S, M = held.slopes()
        sizes = np.abs(held.stiffness).max(), np.abs(held.mass).max()
        both = np.stack([S / sizes[0], M / sizes[1]], axis=1)
        U, s, V = np.linalg.svd(both.reshape(len(S), -1), full_matrices=False)
        rank = int((s > RANK * s[0]).sum())
        changes = V[:rank].reshape(rank, *both.shape[1:])
        changes *= np.reshape(sizes, (2, 1, 1))
        return (U[:, :rank] * s[:rank]).T, self.constants.of(self.Q @ changes @ self.Q.T)

    def _coordinates(self, rows: NDArray) -> tuple[NDArray, NDArray]:
        """Reduced coordinates in some states, and accelerations in space, in axes of the beam."""
        run, planar = self.one.run, self.held.beam.planar
        recording = Recording(run.model, run.numbering, run.system, run.state, rows, 0.0)
        motion = body_motion(recording, self.part, slice(None))
        parts, c = run.state.recorded_parts, []
        a, R = rows[:, parts["a"]], rows[:, parts["R"]]
        for own, number in self._blocks():
            value = a[:, own]
            if number is not None and not planar:
                value = np.einsum("nij,nj->ni", R[:, 9 * number:9 * number + 9].reshape(-1, 3, 3),
                                  value)
            if number is None or not planar:
                value = np.einsum("nji,nj->ni", motion.rotation, value)
            c.append(value)
        return motion.y @ self.Q, np.hstack([*c, a[:, self._modes()]]) @ self.Q

    def _blocks(self) -> list[tuple[slice, int | None]]:
        """Coordinates of positions, then of rotations with the numbers of their matrices."""
        numbering, found = self.one.run.numbering, []
        for block in (*self.part.positions, *self.part.rotations):
            first = numbering.dof_blocks[block]
            found.append((slice(first, first + block.start.size),
                          numbering.rotations.get(block, 0) if block.rotational else None))
        return found

    def _modes(self) -> slice:
        first = self.one.run.numbering.modes[self.part.name]
        return slice(first, first + self.part.reduced.modes)

    def _by_motion(self, events: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Derivatives of both by motion, rates and second rates of the unknowns in some recorded
        states, (states, 2 n, unknowns) each.
        """
        linear, history = self.one.linear, self.one.history
        states = history.states[events]
        by_q, by_a = (self._differences(states, what) for what in "qa")
        if not linear.followers:
            own = slice(0, linear.free)
            return by_q[..., own], 0.0 * by_q[..., own], by_a[..., own]
        found = []
        for k, (q, a) in zip(events, zip(by_q, by_a, strict=True), strict=True):
            event = history.recorded[k]
            linear.at(history.rows[event], history.ends[event], history.besides[event])
            G, _, W, U = linear.followers.motion(linear.state, dense=True)
            found.append((q @ G + a @ U, a @ W, a @ G))
        q, v, a = (np.array(each) for each in zip(*found, strict=True))
        return q, v, a

    def _differences(self, states: NDArray, what: str) -> NDArray:
        """Derivatives by all coordinates of the beam, or by their accelerations."""
        linear, planar = self.one.linear, self.held.beam.planar
        parts = self.one.run.state.recorded_parts
        places, moved = [], []
        for own, number in [*self._blocks(), (self._modes(), None)]:
            for axis, c in enumerate(range(own.start, own.stop)):
                matrix = number if what == "q" and not planar else None
                size = 1.0 if what == "a" else TURN if number is not None else (
                    TURN * self.held.beam.length)
                for at, weight in zip(STEPS, WEIGHTS, strict=True):
                    rows = states.copy()
                    if matrix is not None:
                        first = parts["R"].start + 9 * matrix
                        R = rows[:, first:first + 9].reshape(-1, 3, 3)
                        rows[:, first:first + 9] = (R @ rotations.matrices(
                            at * size * np.eye(3)[axis])).reshape(-1, 9)
                    else:
                        rows[:, parts[what].start + c] += at * size
                    moved.append(rows)
                    places.append((c, weight / size))
        both = np.hstack(self._coordinates(np.concatenate(moved)))
        found = np.zeros((len(states), both.shape[1], linear.total))
        for (c, weight), one in zip(places, both.reshape(len(moved), len(states), -1), strict=True):
            found[..., c] += weight * one
        return found


class ConstantRows:
    """Rows of constants of a superelement as linear functions of its reduced matrices.

    Those of a body with the same nodes and other matrices have the same function.

    Attributes
    ----------
    full : sequence of int
        Places of the number of rows that are not diagonal, which is no linear function.
    """

    def __init__(self, part: Superelement):
        kernel, n = load(part.kernel), len(part.reduced.stiffness)
        assert kernel is not None       # the part has been simulated
        self.part, self.kernel = part, kernel
        places = Row("constants", self.kernel.CONSTANTS).slices(counts_of(part))
        self.full = [places["full"].start] if "full" in places else []
        i, j = np.triu_indices(n)
        base, found = self._row(0, 0, 0, 0.0), []
        for which, size in enumerate(np.abs(A).max() for A in self._matrices()):
            rows = np.zeros((n, n, len(base)))
            rows[i, j] = [(self._row(which, *place, STEP * size) - base) / (STEP * size)
                          for place in zip(i.tolist(), j.tolist(), strict=True)]
            found.append(rows)
        self.rows = np.array(found)     # (2, n, n, numbers) of entries on and above the diagonal

    def of(self, changes: NDArray) -> NDArray:
        """Changes of the row, (k, numbers), by those of stiffness and mass, (k, 2, n, n)."""
        return np.tensordot(changes, self.rows, axes=3)

    def _matrices(self) -> list[NDArray]:
        return [self.part.reduced.stiffness.copy(), self.part.reduced.mass.copy()]

    def _row(self, which: int, i: int, j: int, change: float) -> NDArray:
        """The row with an entry of a matrix changed, and the one across the diagonal."""
        both = self._matrices()
        both[which][i, j] += change
        both[which][j, i] = both[which][i, j]
        part = replace(self.part, reduced=_unchecked(self.part.reduced, *both))
        return constants_row(part.name, self.kernel, counts_of(part),
                             superelement_constants(part))


def _unchecked(body: ReducedBody, stiffness: NDArray, mass: NDArray) -> ReducedBody:
    """A change of a body that need not be one: constants are linear in its matrices."""
    found = object.__new__(ReducedBody)
    for name, value in vars(body).items():
        object.__setattr__(found, name, value)
    for name in ("rigid_modes", "total_mass", "centre_of_mass"):
        vars(found).pop(name, None)         # kept values that follow from the mass
    object.__setattr__(found, "stiffness", stiffness)
    object.__setattr__(found, "mass", mass)
    return found
