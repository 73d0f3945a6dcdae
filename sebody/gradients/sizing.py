"""Heights of the elements of a beam, for least mass within a stress limit in a run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from sebody import inputs
from sebody.assembly.batches import superelement_constants
from sebody.assembly.contracts import constants_row, counts_of
from sebody.engine.state import Scheme
from sebody.errors import InputError
from sebody.explore.ensembles.changes import whole_body
from sebody.fem.section import AnySection
from sebody.gradients.gradient import Differentiated, fitting
from sebody.gradients.held_beams import Elements, Held, HeldBeam
from sebody.gradients.slopes import Slopes
from sebody.gradients.support import refuse_model
from sebody.gradients.sweeps import forward
from sebody.kernels.loader import load
from sebody.model.model import Model
from sebody.model.parts import Beam, Superelement
from sebody.reduction import ReducedBody
from sebody.results import rotations
from sebody.results.motion import body_motion
from sebody.results.recording import Recording
from sebody.runs.steps import whole_steps
from sebody.small_motion.moved_states import STEPS, WEIGHTS

RANK = 1e-12        # of the largest: independent changes of the reduced matrices
STEP = 0.1          # of the matrices, by which they are changed: residuals are linear
TURN = 1e-4         # of differences of reduced coordinates, in radians and in lengths of the beam
FINE = 1e-5         # of the mass: the search ends where it changes less
LINEAR = "frame_axes", "material"       # inertia with forces that are linear in the matrices


class Stresses(NamedTuple):
    """Of a run, and their derivatives."""

    values: NDArray         # (elements,) largest normal stress of each at any time
    times: NDArray          # (elements,) when
    slopes: NDArray         # (elements, elements) by the heights


class BeamStress:
    """Largest stresses in the elements of a beam as functions of their heights.

    The beam is one superelement in the model. Its clamped vibration modes are those of the heights
    as built; constraint modes are those of the heights at hand.

    Parameters
    ----------
    model : Model
        Is put back after every run.
    h, t_end : float
    beam : str
        Name of a beam of `Model.beam` in one superelement, with inertia 'material'.
    heights : (elements,)
        As built.
    section : function
        Of a height: the section, with fibres.
    bounds : (float, float)
        Least and largest height.
    scheme : Scheme, optional

    Attributes
    ----------
    runs : int
        Runs so far.

    Raises
    ------
    InputError
        Another beam, heights that do not fit, or a model that has no gradient.
    """

    def __init__(self, model: Model, h: float, t_end: float, beam: str, heights: ArrayLike,
                 section: Callable[[float], AnySection], bounds: tuple[float, float],
                 scheme: Scheme | None = None):
        self.model = inputs.instance(model, "model", Model, "give a sebody.Model")
        self.h = inputs.number(h, "h", above=0)
        self.t_end = self.h * whole_steps(inputs.number(t_end, "t_end", above=0), self.h)
        one = _beam(model, beam)
        self.part = one.parts[0]
        low, high = (inputs.number(x, "bounds: one", above=0) for x in bounds)
        self.built = inputs.array(heights, "heights", (one.elements,),
                                  remedy=f"give {one.elements} heights, one for each element")
        if not low < high or (self.built < low).any() or (self.built > high).any():
            raise InputError(f"bounds are {low:g} and {high:g}, and heights are "
                             f"{self.built.min():g} to {self.built.max():g}: give heights between "
                             "two bounds")
        self.bounds = low, high
        refuse_model(model)
        ends = one.nodes[-1].point - one.nodes[0].point
        length = float(np.linalg.norm(ends))
        self.beam = HeldBeam(
            model.planar, length, one.elements, self.part.reduced.modes, Elements(
                section, length / one.elements, low, high, model.planar), self.built)
        self.turn = _turn(one, model.planar)
        self.scheme, self.runs = fitting(scheme), 0
        self._handle = whole_body(model, self.part, beam)
        self._last: tuple[NDArray, _Run] | None = None

    def hold(self, heights: NDArray) -> None:
        """Hold the vibration modes of other heights from here on."""
        self.beam.hold(heights)
        self._last = None

    def mass(self, heights: NDArray) -> tuple[float, NDArray]:
        """Mass of the beam, and its derivatives."""
        each, slopes = self.beam.elements.weights(np.asarray(heights, dtype=float))
        return float(each.sum()), slopes

    def at(self, heights: ArrayLike) -> Stresses:
        """Stresses with some heights, and their derivatives; the last ones are kept.

        Raises
        ------
        SimulationError
            The run fails.
        """
        run = self._run(np.asarray(heights, dtype=float))
        if run.slopes is None:
            with self._built(run.held):
                run.differentiate()
        return Stresses(run.values, run.times, run.slopes)

    def values(self, heights: ArrayLike) -> NDArray:
        """Stresses alone, (elements,)."""
        return self._run(np.asarray(heights, dtype=float)).values

    def _run(self, x: NDArray) -> _Run:
        if self._last is None or not np.array_equal(self._last[0], x):
            held = self.beam.at(x)
            with self._built(held) as part:
                one = Differentiated(self.model, self.h, self.t_end, self.scheme)
                if one.run.start.changed:
                    raise InputError("velocities at the start do not fit the joints, so they would "
                                     "depend on the heights: give velocities that fit")
                self.runs += 1
                self._last = x.copy(), _Run(self, held, part, one)
        return self._last[1]

    @contextmanager
    def _built(self, held: Held) -> Iterator[Superelement]:
        """The model with other heights, as long as the context lasts."""
        try:
            self._handle.set(held.body(self.turn, self.part.reduced.units))
            part = self.model.bodies[self.part.name]
            part.alpha, part.alpha_r = self.part.alpha, self.part.alpha_r   # the frame is held
            yield part
        finally:
            self._handle.reset()


class _Run:
    """A run with some heights."""

    def __init__(self, of: BeamStress, held: Held, part: Superelement, one: Differentiated):
        self.of, self.held, self.part, self.one = of, held, part, one
        D, n = len(of.turn), held.stiffness.shape[0]
        self.Q = np.eye(n)      # from axes of the beam to those of the model
        for k in range(2 if of.beam.planar else 4):
            own = slice(D * k, D * (k + 1))
            self.Q[own, own] = of.turn
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
            found += np.einsum("eas,eab,seb->se", one[dofs], change, of[:, dofs], optimize=True)
        return found

    def _motion(self, events: NDArray) -> tuple[NDArray, NDArray]:
        """Derivatives of the heights' independent changes of the matrices, (k, elements), and of
        reduced coordinates by these in some recorded states, (states, n, k).
        """
        one, coefficients, rows = self.one, *self._directions()
        slopes = Slopes(self.of.model, one.run, one.history, lambda made, states: np.zeros(0))
        place = one.run.numbering.constants_at[self.part]
        residuals = slopes.by_constants(place, STEP * rows) / STEP
        none = np.zeros((one.linear.free, len(rows)))
        found = np.zeros((3, len(events), *none.shape))
        wanted = {int(one.history.recorded[k]): i for i, k in enumerate(events)}

        def see(event: int, xi: NDArray, v: NDArray, a: NDArray) -> None:
            if event in wanted:
                found[:, wanted[event]] = xi, v, a
        forward(one.course, residuals, none, none, see)
        return coefficients, sum(by @ of for by, of in zip(self._by_motion(events), found,
                                                           strict=True))

    def _directions(self) -> tuple[NDArray, NDArray]:
        """Independent changes of stiffness and mass, as rows of constants."""
        held = self.held
        S, M = held.slopes()
        sizes = np.abs(held.stiffness).max(), np.abs(held.mass).max()
        both = np.stack([S / sizes[0], M / sizes[1]], axis=1)
        U, s, V = np.linalg.svd(both.reshape(len(S), -1), full_matrices=False)
        rank = int((s > RANK * s[0]).sum())
        changes = V[:rank].reshape(rank, *both.shape[1:])
        base = self._row(0.0 * held.stiffness, 0.0 * held.mass)
        rows = [(self._row(STEP * sizes[0] * dS, STEP * sizes[1] * dM) - base) / STEP
                for dS, dM in changes]
        return (U[:, :rank] * s[:rank]).T, np.array(rows)

    def _row(self, dS: NDArray, dM: NDArray) -> NDArray:
        """The row of constants with changed matrices, in axes of the beam."""
        body = self.part.reduced
        changed = _unchecked(body, body.stiffness + self.Q @ dS @ self.Q.T,
                             body.mass + self.Q @ dM @ self.Q.T)
        part = replace(self.part, reduced=changed)
        return constants_row(part.name, load(part.kernel), counts_of(part),
                             superelement_constants(part))

    def _coordinates(self, rows: NDArray) -> tuple[NDArray, NDArray]:
        """Reduced coordinates in some states, and accelerations in space, in axes of the beam."""
        run, planar = self.one.run, self.of.beam.planar
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
        return tuple(np.array(each) for each in zip(*found, strict=True))

    def _differences(self, states: NDArray, what: str) -> NDArray:
        """Derivatives by all coordinates of the beam, or by their accelerations."""
        linear, planar = self.one.linear, self.of.beam.planar
        parts = self.one.run.state.recorded_parts
        found = np.zeros((len(states), 2 * len(self.held.stiffness), linear.total))
        blocks = [*self._blocks(), (self._modes(), None)]
        for own, number in blocks:
            for axis, c in enumerate(range(own.start, own.stop)):
                turned = what == "q" and number is not None and not planar
                size = 1.0 if what == "a" else TURN if number is not None else (
                    TURN * self.of.beam.length)
                for at, weight in zip(STEPS, WEIGHTS, strict=True):
                    rows = states.copy()
                    if turned:
                        first = parts["R"].start + 9 * number
                        R = rows[:, first:first + 9].reshape(-1, 3, 3)
                        rows[:, first:first + 9] = (R @ rotations.matrices(
                            at * size * np.eye(3)[axis])).reshape(-1, 9)
                    else:
                        rows[:, parts[what].start + c] += at * size
                    found[..., c] += weight / size * np.hstack(self._coordinates(rows))
        return found


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


def _beam(model: Model, name: str) -> Beam:
    found = [one for one in model.beams if one.name == name]
    if not found:
        known = ", ".join(repr(one.name) for one in model.beams) or "no beams"
        raise InputError(f"sizing: there is no beam {name!r}; the model has {known}: give a beam "
                         "that was built by model.beam")
    one = found[0]
    if len(one.parts) > 1 or one.options["damping"]:
        raise InputError(f"sizing: beam {name!r} has {len(one.parts)} superelements and damping "
                         f"{one.options['damping']!r}: build it with bodies=1 and without damping")
    if one.parts[0].inertia not in LINEAR:
        raise InputError(f"sizing: beam {name!r} has inertia {one.parts[0].inertia!r}: build it "
                         "with inertia='material', whose forces are linear in the reduced matrices")
    return one


def _turn(one: Beam, planar: bool) -> NDArray:
    """From axes of a beam to those of its model."""
    from sebody.fem.beam import section_axes

    line = np.zeros(3)
    ends = one.nodes[-1].point - one.nodes[0].point
    line[:len(ends)] = ends
    up = one.options["up"]
    return section_axes(line, None if up is None else inputs.vector(up, "up", 3))[
        :len(ends), :len(ends)].T


@dataclass(frozen=True, eq=False)
class Sizing:
    """Heights of least mass.

    Attributes
    ----------
    heights, stresses, times : (elements,)
        Heights, and the largest stress in each element with its time.
    mass, mass_before : float
    iterations, runs : int
    message : str
        How the optimization ended.
    seconds : float
    history : tuple of float
        Mass after each iteration.
    limit : float
        Of the stresses.
    """

    heights: NDArray
    stresses: NDArray
    times: NDArray
    mass: float
    mass_before: float
    iterations: int
    runs: int
    message: str
    seconds: float
    history: tuple[float, ...]
    limit: float

    def save_picture(self, path: str | Path) -> Path:
        """Heights and stresses along the beam; PNG.

        Raises
        ------
        InputError
            A picture that cannot be made.
        """
        from sebody.gradients.picture import draw_sizing

        return draw_sizing(self, path)

    def __repr__(self) -> str:
        return (f"<Sizing: mass {self.mass:.6g} instead of {self.mass_before:.6g}, largest stress "
                f"{self.stresses.max():.6g}, {self.iterations} iterations>")


def size_heights(model: Model, h: float, t_end: float, beam: str, heights: ArrayLike,
                 section: Callable[[float], AnySection], limit: float,
                 bounds: tuple[float, float], iterations: int = 50,
                 scheme: Scheme | None = None) -> Sizing:
    """Heights of a beam's elements, of least mass with stresses within a limit in a run.

    `scipy.optimize.minimize` with its method SLSQP and exact derivatives of the largest stress in
    every element at any time: each is one condition. Vibration modes are those of the heights at
    hand, and are held in the derivatives.

    Parameters
    ----------
    model, h, t_end, beam, heights, section, bounds, scheme
        As of `BeamStress`.
    limit : float
        Largest normal stress.
    iterations : int
        At most.

    Raises
    ------
    InputError
        As of `BeamStress`, or a limit that is not positive.
    SimulationError
        A run fails.

    Examples
    --------
    >>> found = size_heights(model, 1e-4, 0.2, "rod", np.full(200, 0.02),
    ...                      lambda x: rectangle(x, 0.01, 2.1e11, 0.3, 7850.0), limit=150e6,
    ...                      bounds=(0.004, 0.03))
    """
    began = time.perf_counter()
    limit = inputs.number(limit, "limit", above=0)
    iterations = inputs.integer(iterations, "iterations", least=1)
    stress = BeamStress(model, h, t_end, beam, heights, section, bounds, scheme)
    unit, before = float(stress.built.mean()), stress.mass(stress.built)[0]
    masses: list[float] = []
    last: list[NDArray] = []

    def mass(x: NDArray) -> tuple[float, NDArray]:
        value, slope = stress.mass(unit * x)
        return value / before, slope * unit / before

    def at(x: NDArray) -> NDArray:
        """The heights, whose modes are held from here on."""
        if not last or not np.array_equal(last[-1], x):
            stress.hold(unit * x)
            last[:] = [x.copy()]
        return unit * x

    found = minimize(
        mass, stress.built / unit, jac=True, method="SLSQP",
        bounds=[tuple(bound / unit for bound in stress.bounds)] * len(stress.built),
        constraints={"type": "ineq", "fun": lambda x: 1.0 - stress.values(at(x)) / limit,
                     "jac": lambda x: -stress.at(at(x)).slopes * unit / limit},
        callback=lambda x: masses.append(stress.mass(unit * x)[0]),
        options={"maxiter": iterations, "ftol": FINE})
    x = np.clip(found.x, *(bound / unit for bound in stress.bounds))
    stresses = stress.at(at(x))
    return Sizing(unit * x, stresses.values, stresses.times, stress.mass(unit * x)[0], before,
                  int(found.nit), stress.runs, str(found.message), time.perf_counter() - began,
                  tuple(masses), limit)
