"""Exact derivatives of quantities by the states of a run: their tapes, followed backwards.

Bars of a quantity are given to the numbers that its tape reads. Those of forces of elements go to
the motion by the elements' products with weights, see `products`; those of energies and powers by
`energy_rows` and `power_rows`; those of rotation matrices to rotations by ``dR = R skew(theta)``;
those of dependent positions to what they follow from.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK, POWERS, PREPARE, TRANSPOSED
from sebody.contract.read_numbers import (
    ENERGY,
    FORCE,
    LOAD,
    MOTION,
    NOW,
    OF_A,
    OF_FORCE,
    OF_Q,
    OF_R,
    OF_TOTAL,
    OF_V,
    TOTAL,
)
from sebody.gradients.element_products import ROWS, run_element
from sebody.gradients.energy_rows import EnergyRows, energy_rows, set_energy_rows
from sebody.gradients.history import History
from sebody.gradients.laws import remembering
from sebody.gradients.linear import Linear
from sebody.gradients.link_products import place_weights, pull_back_bars
from sebody.gradients.motion_rows import add_motion_rows, motion_rows, set_motion_rows
from sebody.gradients.power_rows import power_rows, set_power_rows
from sebody.gradients.products import Products, prepare, turn
from sebody.gradients.recorded_states import put_state
from sebody.kernels.tapes import play_back
from sebody.model.parts import Superelement
from sebody.quantities.algebra import dot, times
from sebody.quantities.expressions import Number
from sebody.quantities.reading import evaluate_loaded
from sebody.quantities.symbols import NoTape
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.results.tapes import States
from sebody.runs.simulation import Simulation

MOVED = 1e-3            # change of kept numbers that shows which quantities depend on them
ROUNDING = 1e-12
DIFFERENTIATED = {NOW, FORCE, TOTAL, LOAD, ENERGY, MOTION}


class Rows(NamedTuple):
    """Derivatives of the components of a quantity, (components, n) each."""

    motion: NDArray
    rates: NDArray
    seconds: NDArray


class Smooth(States):
    """Symbols that are all differentiated.

    The damping of a body has a kernel of its power alone; it follows from the rates in its frame.
    """

    def power(self, port: int) -> Number:
        body = next((one for one, own in self.numbering.ports.items() if own == port), None)
        if not isinstance(body, Superelement):
            return super().power(port)
        rates = self.motion(body.name)["y_rate"]
        assert body.reduced.damping is not None
        return -dot(rates, times(body.reduced.damping.tolist(), rates))


class Followed:
    """A quantity with a tape, and its derivatives.

    Parameters
    ----------
    run : Simulation
    quantity : str
    linear : Linear
        Of the run.
    history : History

    Raises
    ------
    NoTape
        A quantity that has no tape, or reads what has no products.
    """

    def __init__(self, run: Simulation, quantity: str, linear: Linear, history: History):
        self.run, self.quantity = run, quantity
        self.linear, self.history = linear, history
        states = Smooth(run.model, run.numbering, run.system, run.state, history.rows[0])
        states.put(quantity)
        kinds = states.kinds
        if not kinds <= DIFFERENTIATED:
            raise NoTape("residuals")
        self.kinematic = not kinds & {FORCE, TOTAL, ENERGY}
        products = Products.none() if self.kinematic else Products.of(run)
        if products is None:
            raise NoTape("forces of elements without products")
        read = [place for kind, place in states.tape.inputs if kind == ENERGY]
        energies, powers = ([p for p in read if (p >= POWERS) == of] for of in (False, True))
        self.reading = states.reading()
        self.bars = np.zeros((len(self.reading.outputs), self.reading.numbers.size))
        self.parts = (products, energy_rows(run, energies) if energies else EnergyRows.none(),
                      power_rows(run, powers),
                      motion_rows(run, self.reading, states.moving, states.resting))
        self.places = states.depends()
        steady = not states.tape.steps and not linear.followers and np.isin(
            self.places[:, 0], (OF_Q, OF_V, OF_A)).all()
        self._same: Rows | None = None      # where it is that of all states
        self._same = self.at(0, 0) if steady else None

    def at(self, k: int, event: int) -> Rows:
        """Derivatives in a recorded state."""
        return Rows(*(part[0] for part in self.over([event])))

    def over(self, events: Sequence[int]) -> Rows:
        """The same in some states, (states, components, n) each."""
        linear, history, count = self.linear, self.history, len(self.reading.outputs)
        if self._same is not None:
            return Rows(*(np.broadcast_to(part, (len(events), *part.shape))
                          for part in self._same))
        for event in events if remembering(self.run) else ():
            linear.put(history.rows[event], history.ends[event], history.besides[event])
            refuse_kept(self.run, self.quantity)
        rows = np.zeros((len(events), 3, count, linear.total))
        _follow_over(linear.system, linear.state, history.rows, history.ends, history.besides,
                     np.array(events, dtype=np.int64), self.reading, self.places, self.bars,
                     *self.parts, rows)
        if not np.isfinite(rows).all():
            k = int(np.argmin(np.isfinite(rows).all(axis=(1, 2, 3))))
            raise InputError(f"quantity {self.quantity!r} has no derivative at t = "
                             f"{history.rows[events[k]][0]:.6g}: it is not smooth there, as a "
                             "length is not where it is zero: give its components, or another time")
        return Rows(*rows[..., :linear.free].transpose(1, 0, 2, 3))


def refuse_kept(run: Simulation, quantity: str) -> None:
    """Refuse quantities that depend on what laws keep, such as the force of friction.

    In the state that is held: elsewhere nothing may touch.

    Raises
    ------
    InputError
        The message names the quantity.
    """
    places = [place for law in remembering(run) for place in run.numbering.memories[law]]
    if not places:
        return
    state = run.state
    rows = np.repeat(state.now[None], 2, axis=0)
    for name in ("frames", "frames_old"):
        kept = rows[1, state.recorded_parts[name]]
        kept[places] = (1.0 + MOVED) * kept[places] + MOVED
    now, moved = np.asarray(look_up(Recording(
        run.model, run.numbering, run.system, state, rows, 0.0), quantity), dtype=float)
    if not np.allclose(now, moved, ROUNDING, ROUNDING * np.abs(now).max(initial=0.0)):
        raise InputError(f"quantity {quantity!r} depends on what friction or contacts "
                         "keep from step to step, and has no derivative by a state: give the "
                         "motion that they act on, or the force of a joint")


@compiled
def _set_bars(state, reading, places, c, bars, out):
    """Set the bars of one output; those of motions are added to rows (3, c, total)."""
    bars[:] = 0.0
    bars[reading.outputs[c]] = 1.0
    play_back(reading.steps, reading.factors, reading.weights, reading.numbers, bars)
    for i in range(places.shape[0]):
        bar, kind, place = bars[reading.inputs[i, 0]], places[i, 0], places[i, 1]
        if kind <= OF_A:
            out[kind, c, place] += bar
        elif kind == OF_R and bar != 0.0:
            first, row, column = 9 * (places[i, 2] // 9), places[i, 2] % 9 // 3, places[i, 2] % 3
            # of R skew(theta): column j + 1 of R times theta of j + 2, less the other way round
            one, other = (column + 1) % 3, (column + 2) % 3
            out[0, c, place + other] += bar * state.R[first + 3 * row + one]
            out[0, c, place + one] -= bar * state.R[first + 3 * row + other]


@compiled
def _follow_over(system, state, history, ends, besides, events, reading, places, bars, products,
                 energies, powers, motions, out):
    """Add derivatives of all outputs in some states to rows (states, 3, c, total).

    Rows of states in which something cannot be evaluated are no numbers.
    """
    for e in range(events.size):
        put_state(system, state, history[events[e]], ends[events[e]], besides[events[e]])
        status = evaluate_loaded(system, state, reading)
        if status == OK and products.address.size > 0:
            status = _follow_forces(system, state, reading, places, bars, products, out[e])
        else:
            _follow_motion(system, state, reading, places, bars, out[e])
        if status == OK and energies.wanted.size > 0:
            status = set_energy_rows(system, state, products, energies)
        if status == OK and powers.places.size > 0:
            status = set_power_rows(system, state, products, powers)
        _add_energies(system, state, reading, bars, energies, powers, out[e])
        if status == OK and reading.bodies.shape[0] > 0:
            status = _follow_bodies(system, state, reading, bars, motions, out[e])
        if status != OK:
            out[e] = np.nan


@compiled
def _follow_motion(system, state, reading, places, bars, out):
    """Add the derivatives by the recorded motion to rows (3, c, total)."""
    w = np.zeros(out.shape[2])
    for c in range(out.shape[1]):
        _set_bars(state, reading, places, c, bars[c], out)
        if system.links.dependent.shape[0] > 0:
            pull_back_bars(system, state, w, out[:, c])


@compiled
def _follow_forces(system, state, reading, places, bars, products, out):
    """The same, and by forces of elements; a status."""
    status, whole = OK, reading.needs[TOTAL] == 1
    if whole:
        status = prepare(system, state, products)
    if not whole:
        for k in range(reading.batches.shape[0]):
            if status == OK:
                status = _run(PREPARE, system, state, products, reading.batches, k)
    if status != OK:
        return status
    w = np.zeros(out.shape[2])
    for c in range(out.shape[1]):
        _set_bars(state, reading, places, c, bars[c], out)
        for i in range(w.size):
            w[i] = 0.0
        for i in range(places.shape[0]):
            if places[i, 0] == OF_TOTAL:
                w[places[i, 1]] += bars[c, reading.inputs[i, 0]]
        if whole and system.links.dependent.shape[0] > 0:
            place_weights(system, state, w)
        _weigh(system, state, reading, places, products, bars[c], w, whole)
        if whole:
            for b in range(system.address.size):
                for k in range(system.count[b]):
                    _give(system, state, products, b, k, out, c)
        else:
            for k in range(reading.batches.shape[0]):
                _give(system, state, products, reading.batches[k, 0], reading.batches[k, 1], out, c)
        if system.links.dependent.shape[0] > 0:
            pull_back_bars(system, state, w, out[:, c])
    return OK


@compiled
def _add_energies(system, state, reading, bars, energies, powers, out):
    """Add what outputs depend on by energies and powers, in the state in which they were set."""
    for i in range(reading.inputs.shape[0]):
        at, kind, place = reading.inputs[i, 0], reading.inputs[i, 1], reading.inputs[i, 2]
        if kind == ENERGY and place < POWERS:
            _add_rows(system, state, bars[:, at], energies.rows[:, place], out)
        for p in range(powers.places.size):
            if kind == ENERGY and place == powers.places[p]:
                _add_rows(system, state, bars[:, at], powers.rows[:, p], out)


@compiled
def _follow_bodies(system, state, reading, bars, motions, out):
    """Add what outputs depend on by motions of bodies; a status."""
    status = set_motion_rows(system, state, reading, motions)
    w = np.zeros(out.shape[2])
    found = np.zeros((3, 1, out.shape[2]))
    for c in range(out.shape[1]):
        found[:] = 0.0
        add_motion_rows(reading, motions, bars[c], found, 0)
        if system.links.dependent.shape[0] > 0:
            pull_back_bars(system, state, w, found[:, 0])
        out[:, c] += found[:, 0]
    return status


@compiled
def _add_rows(system, state, bars, rows, out):
    """Add the derivatives of a number by motion and rates, times its bars in all outputs."""
    w, found = np.zeros(out.shape[2]), np.zeros((3, out.shape[2]))
    found[:2] = rows
    if system.links.dependent.shape[0] > 0:
        pull_back_bars(system, state, w, found)
    for c in range(out.shape[1]):
        out[:, c] += bars[c] * found


@compiled
def _weigh(system, state, reading, places, products, bars, w, whole):
    """Set the weights of the forces of elements: those of sums, and their own."""
    vectors = products.vectors
    for k in range(reading.batches.shape[0]):
        _clear(system, products, reading.batches[k, 0], reading.batches[k, 1])
    if whole:
        for b in range(system.address.size):
            for k in range(system.count[b]):
                first = system.at_g[b] + k * system.width[b]
                for i in range(system.width[b]):
                    vectors[ROWS * first + i] = w[system.g_unknown[first + i]]
    for i in range(places.shape[0]):
        if places[i, 0] == OF_FORCE:
            g = places[i, 1]
            b = np.searchsorted(system.at_g, g, side="right") - 1
            width = system.width[b]
            first = system.at_g[b] + (g - system.at_g[b]) // width * width
            vectors[ROWS * first + g - first] += bars[reading.inputs[i, 0]]


@compiled
def _clear(system, products, b, k):
    first = ROWS * (system.at_g[b] + k * system.width[b])
    for i in range(system.width[b]):
        products.vectors[first + i] = 0.0


@compiled
def _run(task, system, state, products, batches, k):
    b, element = batches[k, 0], batches[k, 1]
    return run_element(task, b, element, _work_of(system, products, b, element), system, state,
                       products)


@compiled
def _work_of(system, products, b, k):
    """Place of the working memory of element k of a batch."""
    before = 0
    for i in range(b):
        before += system.count[i]
    return products.at_work[before + k]


@compiled
def _give(system, state, products, b, k, out, c):
    """Give the weights of an element to the motion, its rates and second rates."""
    width, vectors = system.width[b], products.vectors
    first = system.at_g[b] + k * width
    at_index = system.at_index[b] + k * system.stride[b]
    weighted = False
    for i in range(width):
        weighted = weighted or vectors[ROWS * first + i] != 0.0
    if not weighted:
        return
    if products.turned[b]:
        turn(system, state, vectors, ROWS * first, at_index, False)
    run_element(TRANSPOSED, b, k, _work_of(system, products, b, k), system, state, products)
    for r in range(3):
        row = ROWS * first + (r + 1) * width
        if products.turned[b]:
            turn(system, state, vectors, row, at_index, True)
        for i in range(width):
            out[r, c, system.g_unknown[first + i]] += vectors[row + i]
