"""Inputs of small motion: amplitudes of loads, of drives and of prescribed motions.

An input u makes the residual of the unknowns change by ``-(f0 u + f1 u' + f2 u'')``. A load has f0
alone. A drive by an equation moves what it drives by the equation's derivative, which is in f0,
too. A prescribed motion moves coordinates that are no unknowns, whose masses, dampers and springs
push the others.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.evaluation import evaluate
from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.layout import RECORD_T, RESIDUAL
from sebody.engine.evaluate import set_loads, to_body_axes
from sebody.model.parts import Element, Motion
from sebody.results.result import Result
from sebody.runs.rotating_frame import Spin, motion
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import weighted
from sebody.small_motion.frequency import by_amplitude

STEPS = 0.1, 0.05, 0.025        # of a drive's amplitude, whose sine enters: for three differences
STILL = 1e-9        # of a motion's size: what rotates it in the axes of a spin is none


class Input(NamedTuple):
    """Effect of a unit of an input."""

    name: str
    pushes: NDArray         # (3, n) f0, f1, f2 on the unknowns, in their own axes
    elements: NDArray       # (forces of all elements,) change of these by u
    motion: NDArray         # (N,) motion of prescribed coordinates by u
    moves: bool             # a drive or prescribed motion, with rates


def found(run: Simulation | Result, spin: Spin, name: str) -> Input:
    """An input by its name.

    Raises
    ------
    InputError
        No load, drive or prescribed motion has this name, or its amplitude cannot vary.
    """
    known = _known(run)
    if not known:
        raise InputError("the model has no load, actuator or drive, so no input: add one, a load "
                         "of amplitude 0 if it shall not act at rest")
    input = known[inputs.choice(name, "input", known)]
    if input.time_function.is_time:
        raise InputError(f"{name!r} is a user force, which has no amplitude: name a load, an "
                         "actuator or a drive")
    none = np.zeros(run.numbering.total)
    if isinstance(input, Motion):
        return _of_motion(run, spin, input)
    if input.multipliers:
        forces, push = _by_drive(run, input)
        return Input(name, np.stack([push, 0 * push, 0 * push]), forces, none, True)
    forces, push = by_amplitude(run, input)
    return Input(name, np.stack([push, 0 * push, 0 * push]), forces, none, False)


def _known(run: Simulation | Result) -> dict[str, Element | Motion]:
    """Possible inputs, by name."""
    model = run.model
    elements = [one for one in (*model.loads, *model.constraints)
                if one.time_function is not None and one.law is None]
    motions = [one for dof_block in model.dof_blocks() for one in dof_block.motions]
    return {one.name: one for one in (*elements, *motions)}


def _by_drive(run: Simulation | Result, drive: Element) -> tuple[NDArray, NDArray]:
    """Derivatives by the amplitude of a drive as of `by_amplitude`, by extrapolated differences."""
    state, at = run.state, 3 * run.numbering.ports[drive]
    kept = state.loads.copy()
    set_loads(run.system, state.frames, state.loads, state.now[RECORD_T])
    middle, table = state.loads[at], []
    for step in STEPS:
        ends = []
        for value in (middle + step, middle - step):
            state.loads[at] = value
            evaluate(run.system, state, RESIDUAL, RESIDUAL, "the state")
            ends.append(np.concatenate([state.g, state.residual]))
        table.append((ends[0] - ends[1]) / (2 * step))
    state.loads[:] = kept
    for power in (4.0, 16.0):       # errors of the second and fourth order
        table = [(power * fine - coarse) / (power - 1.0)
                 for coarse, fine in zip(table[:-1], table[1:], strict=True)]
    forces, residual = np.split(table[0], [state.g.size])
    to_body_axes(run.system, state.frames, residual, False)
    return forces, -residual[:run.numbering.free]


def _of_motion(run: Simulation | Result, spin: Spin, own: Motion) -> Input:
    """A prescribed motion as an input."""
    numbering = run.numbering
    port, moved = numbering.port_names.index(own.name), np.zeros(numbering.total)
    for coordinate, its_port, _, factor in numbering.prescribed:
        if its_port == port:
            moved[coordinate] = factor
    turns = spin.turning(own.place.dof_block)
    if spin.rotates and turns is not None and any(
            np.abs(operator @ moved).max() > STILL * np.abs(moved).max()
            for operator in spin.operators(run, turns.factor)):
        raise InputError(f"motion {own.name!r} rotates in axes that spin: give one along the axis "
                         "of the spin, or a load")
    G = motion(run)
    pushes = [-np.asarray(G.T @ (weighted(run, *weights) @ moved)).ravel()
              for weights in ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))]
    return Input(own.name, np.stack(pushes), np.zeros(run.state.g.size), moved, True)
