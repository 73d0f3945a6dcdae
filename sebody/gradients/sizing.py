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
        refuse_model(model)
        ends = one.nodes[-1].point - one.nodes[0].point
        length = float(np.linalg.norm(ends))
        self.beam = HeldBeam(model.planar, length, one.elements, self.part.reduced.modes, Elements(
            section, length / one.elements, low, high, model.planar), self.built)
        self.turn = _turn(one, model.planar)
        self.scheme, self.runs = fitting(scheme), 0
        self._handle = whole_body(model, self.part, beam)
        self._last: tuple[NDArray, Stresses] | None = None

    def mass(self, heights: NDArray) -> tuple[float, NDArray]:
        """Mass of the beam, and its derivatives."""
        each, slopes = self.beam.elements.weights(np.asarray(heights, dtype=float))
        return float(each.sum()), slopes

    def at(self, heights: ArrayLike) -> Stresses:
        """Stresses with some heights; the last ones are kept.

        Raises
        ------
        SimulationError
            The run fails.
        """
        x = np.asarray(heights, dtype=float)
        if self._last is None or not np.array_equal(self._last[0], x):
            self._last = x.copy(), self._found(self.beam.at(x))
        return self._last[1]

    def _found(self, held: Held) -> Stresses:
        with self._built(held) as part:
            one = Differentiated(self.model, self.h, self.t_end, self.scheme)
            if one.run.start.changed:
                raise InputError("velocities at the start do not fit the joints, so they would "
                                 "depend on the heights: give velocities that fit")
            self.runs += 1
            return _Run(self, held, part, one).stresses()

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
        self.Q = np.eye(n)
        angles = 0 if of.beam.planar else 2
        for k in range(2 + angles):
            own = slice(D * k, D * (k + 1))
            self.Q[own, own] = of.turn

    def stresses(self) -> Stresses:
        """Largest ones, and their derivatives by all heights."""
        held, y = self.held, self._y(self.one.history.states)
        forces = held.section_forces(y)
        each = np.einsum("tegf,epf->tegp", forces, held.elements.fibres, optimize=True)
        count = held.beam.count
        flat = np.abs(each).transpose(1, 0, 2, 3).reshape(count, -1)
        found = flat.argmax(axis=1)
        when, end, fibre = np.unravel_index(found, (len(y), *each.shape[2:]))
        places = np.arange(count)
        sign = np.sign(each[when, places, end, fibre])
        rows = self._rows(end, fibre, sign)
        slopes = self._explicit(y[when], end, fibre, sign, rows, forces[when, places, end])
        coefficients, motion = self._motion(np.unique(when))
        at = np.searchsorted(np.unique(when), when)
        by_y = np.einsum("ea,eai->ei", rows, held.T[held.beam.dofs])
        slopes += np.einsum("ei,eik->ek", by_y, motion[at]) @ coefficients
        return Stresses(flat[places, found], self.one.history.times[when], slopes)

    def _rows(self, end: NDArray, fibre: NDArray, sign: NDArray) -> NDArray:
        """Derivatives of the stress of each element by its DOFs, (elements, k)."""
        e = np.arange(len(end))
        own = self.held.elements
        return sign[:, None] * np.einsum("ef,efa->ea", own.fibres[e, fibre], own.forces[e, end])

    def _explicit(self, y: NDArray, end: NDArray, fibre: NDArray, sign: NDArray, rows: NDArray,
                  forces: NDArray) -> NDArray:
        """Derivatives with the reduced coordinates (elements, n) held: of sections and of Psi."""
        held, beam, e = self.held, self.held.beam, np.arange(len(end))
        u = np.einsum("eai,ei->ea", held.T[beam.dofs], y)
        own = np.einsum("ef,ef->e", held.by_height.fibres[e, fibre], forces) + np.einsum(
            "ef,efa,ea->e", held.elements.fibres[e, fibre], held.by_height.forces[e, end], u)
        loads = np.zeros((beam.size, beam.count))
        loads[beam.dofs.T, e] = rows.T
        answers = held.inverse(loads)[beam.dofs]            # (elements, k, stresses)
        b = len(beam.order)
        moved = np.einsum("eab,ebi,si->eas", held.by_height.stiffness, held.Psi[beam.dofs],
                          y[:, :b], optimize=True)
        return np.diag(sign * own) - np.einsum("eas,eas->se", answers, moved)

    def _motion(self, events: NDArray) -> tuple[NDArray, NDArray]:
        """Derivatives of the heights' independent changes of the matrices, (k, elements), and of
        reduced coordinates by these in some recorded states, (states, n, k).
        """
        one, coefficients, rows = self.one, *self._directions()
        slopes = Slopes(self.of.model, one.run, one.history, lambda made, states: np.zeros(0))
        place = one.run.numbering.constants_at[self.part]
        residuals = slopes.by_constants(place, STEP * rows) / STEP
        none = np.zeros((one.linear.free, len(rows)))
        found = np.zeros((len(events), *none.shape))
        wanted = {int(one.history.recorded[k]): i for i, k in enumerate(events)}

        def see(event: int, xi: NDArray, v: NDArray, a: NDArray) -> None:
            if event in wanted:
                found[wanted[event]] = xi
        forward(one.course, residuals, none, none, see)
        return coefficients, np.einsum("sic,sck->sik", self._by_motion(events), found)

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

    def _y(self, rows: NDArray) -> NDArray:
        """Reduced coordinates in some states, in axes of the beam."""
        run = self.one.run
        recording = Recording(run.model, run.numbering, run.system, run.state, rows, 0.0)
        return body_motion(recording, self.part, slice(None)).y @ self.Q

    def _by_motion(self, events: NDArray) -> NDArray:
        """Derivatives of reduced coordinates by the unknowns, (states, n, unknowns)."""
        linear, history, run = self.one.linear, self.one.history, self.one.run
        parts = run.state.recorded_parts
        own = self._coordinates()
        found = np.zeros((len(events), self.held.stiffness.shape[0], linear.total))
        states = history.states[events]
        for c, turn in own.items():
            size = TURN if turn is not None else TURN * self.of.beam.length
            for at, weight in zip(STEPS, WEIGHTS, strict=True):
                rows = states.copy()
                if turn is None or self.of.beam.planar:
                    rows[:, parts["q"].start + c] += at * size
                if turn is not None and not self.of.beam.planar:
                    number, axis = turn
                    first = parts["R"].start + 9 * number
                    R = rows[:, first:first + 9].reshape(-1, 3, 3)
                    rows[:, first:first + 9] = (R @ rotations.matrices(
                        at * size * np.eye(3)[axis])).reshape(-1, 9)
                found[..., c] += weight / size * self._y(rows)
        if not linear.followers:
            return found[..., :linear.free]
        G = []
        for k in events:
            event = history.recorded[k]
            linear.at(history.rows[event], history.ends[event], history.besides[event])
            G.append(linear.followers.motion(linear.state, dense=True).G)
        return np.einsum("sic,scn->sin", found, np.array(G))

    def _coordinates(self) -> dict[int, tuple[int, int] | None]:
        """Those of the beam; of rotations the number of the matrix and the axis."""
        numbering, part = self.one.run.numbering, self.part
        found: dict[int, tuple[int, int] | None] = {}
        for block in part.positions:
            first = numbering.dof_blocks[block]
            found |= dict.fromkeys(range(first, first + block.start.size))
        for block in part.rotations:
            first = numbering.dof_blocks[block]
            found |= {first + k: (numbering.rotations.get(block, 0), k)
                      for k in range(block.start.size)}
        first = numbering.modes[part.name]
        return found | dict.fromkeys(range(first, first + part.reduced.modes))


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
    every element at any time: each is one condition.

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
    unit, before = stress.built.mean(), stress.mass(stress.built)[0]
    masses: list[float] = []

    def mass(x: NDArray) -> tuple[float, NDArray]:
        value, slope = stress.mass(unit * x)
        return value / before, slope * unit / before

    found = minimize(
        mass, stress.built / unit, jac=True, method="SLSQP",
        bounds=[(bounds[0] / unit, bounds[1] / unit)] * len(stress.built),
        constraints={"type": "ineq", "fun": lambda x: 1.0 - stress.at(unit * x).values / limit,
                     "jac": lambda x: -stress.at(unit * x).slopes * unit / limit},
        callback=lambda x: masses.append(stress.mass(unit * x)[0]),
        options={"maxiter": iterations, "ftol": 1e-6})
    x = unit * found.x
    last = stress.at(x)
    return Sizing(x, last.values, last.times, stress.mass(x)[0], before, int(found.nit),
                  stress.runs, str(found.message), time.perf_counter() - began, tuple(masses), limit)
