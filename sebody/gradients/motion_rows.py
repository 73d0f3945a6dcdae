"""Derivatives of the motion of bodies, on which quantities of FE nodes depend, by a state.

A kernel computes place, rotation, spin and local coordinates of a body's frame, with their rates.
Here it is called along each coordinate of the body and its rates: of rates these are polynomials
of second degree, of second rates linear functions, so that differences of two calls are exact; of
positions and rotations four calls leave an error of ``SMALL^4``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.layout import AT_POSITIONS, AT_ROTATIONS, HEADER, OK
from sebody.contract.read_numbers import MOTION
from sebody.engine.arrays import Arrays
from sebody.kernels.abi import at, pointer_to
from sebody.quantities.reading import BODY, Reading, move_body
from sebody.runs.simulation import Simulation
from sebody.small_motion.moved_states import STEPS, WEIGHTS

SMALL = 1e-3        # of the characteristic length, or in radians
AHEAD, BACK = np.array(STEPS), np.array(WEIGHTS)


@dataclass(frozen=True, eq=False)
class MotionRows(Arrays):
    """Derivatives of the motions of bodies.

    ==========  ====================================================================================
    rated       (1,) how many of motion, rates and second rates are looked at
    steps       (coordinates,) of differences
    by          (3, numbers of all motions, widest) written: by the coordinates of each body
    motion      (numbers of all motions,) of the state
    ==========  ====================================================================================
    """

    rated: NDArray
    steps: NDArray
    by: NDArray
    motion: NDArray


def motion_rows(run: Simulation, reading: Reading, read: list[int], still: list[slice]
                ) -> MotionRows:
    """Room for derivatives of the motions that a tape reads.

    Parameters
    ----------
    read : list of int
        Numbers of motions that are read.
    still : list of slice
        Numbers that do not depend on rates.
    """
    widest = int(reading.bodies[:, 2].max(initial=0))
    steps = np.full(run.numbering.total, SMALL * run.model.size())
    for block, first in run.numbering.dof_blocks.items():
        if block.rotational:
            steps[first:first + block.start.size] = SMALL
    at_rest = all(any(own.start <= k < own.stop for own in still) for k in read)
    return MotionRows(np.array([1 if at_rest else 3]), steps,
                      np.zeros((3, reading.moved.size, widest)), np.zeros(reading.moved.size))


@compiled
def set_motion_rows(system, state, reading, motions):
    """Set the derivatives in a state, which stays as it is; a status."""
    status = OK
    for i in range(reading.moved.size):
        motions.motion[i] = reading.moved[i]
    for b in range(reading.bodies.shape[0]):
        first, end = _numbers(reading, b)
        index = at(pointer_to(reading.index), reading.bodies[b, 3])
        unknowns = HEADER + index[AT_ROTATIONS]
        for part in range(motions.rated[0]):
            array = state.q if part == 0 else state.v if part == 1 else state.a
            largest = 0.0
            for i in range(reading.bodies[b, 2]):
                largest = max(largest, abs(array[index[unknowns + i]]))
            for i in range(reading.bodies[b, 2]):
                x, turned = index[unknowns + i], i - system.dimension[0] * index[AT_POSITIONS]
                step = motions.steps[x] if part == 0 else largest if largest > 0.0 else 1.0
                for m in range(first, end):
                    motions.by[part, m, i] = 0.0
                rotates = part == 0 and system.dimension[0] == 3 and (
                    0 <= turned < 3 * index[AT_ROTATIONS])
                for k in range(4 if part == 0 else 2):
                    weight = BACK[k] if part == 0 else 0.5 * AHEAD[k]
                    if rotates:
                        R = at(pointer_to(state.R), 9 * index[HEADER + turned // 3])
                        status = max(status, _along_turn(b, state, reading, R, turned % 3,
                                                         AHEAD[k] * step))
                    else:
                        before = array[x]
                        array[x] = before + AHEAD[k] * step
                        status = max(status, move_body(b, state, reading))
                        array[x] = before
                    for m in range(first, end):
                        motions.by[part, m, i] += weight / step * reading.moved[m]
    for i in range(reading.moved.size):
        reading.moved[i] = motions.motion[i]
    return status


@compiled
def _along_turn(b, state, reading, R, axis, angle):
    """Motion of a body with a rotation that is turned by a small angle about its own axis."""
    one, other, kept = (axis + 1) % 3, (axis + 2) % 3, np.empty(9)
    for i in range(9):
        kept[i] = R[i]
    c, s = np.cos(angle), np.sin(angle)
    for i in range(0, 9, 3):
        R[i + one] = c * kept[i + one] + s * kept[i + other]
        R[i + other] = c * kept[i + other] - s * kept[i + one]
    status = move_body(b, state, reading)
    for i in range(9):
        R[i] = kept[i]
    return status


@compiled
def _numbers(reading, b):
    """First number of the motion of a body, and the end."""
    last = b + 1 == reading.bodies.shape[0]
    return reading.bodies[b, BODY - 1], (reading.moved.size if last else
                                         reading.bodies[b + 1, BODY - 1])


@compiled
def add_motion_rows(reading, motions, bars, out, c):
    """Add the derivatives of an output, by its bars of motions, to rows (3, c, coordinates)."""
    for i in range(reading.inputs.shape[0]):
        bar = bars[reading.inputs[i, 0]]
        if reading.inputs[i, 1] != MOTION or bar == 0.0:
            continue
        m = reading.inputs[i, 2]
        for b in range(reading.bodies.shape[0]):
            first, end = _numbers(reading, b)
            if m < first or m >= end:
                continue
            index = at(pointer_to(reading.index), reading.bodies[b, 3])
            for part in range(motions.rated[0]):
                for j in range(reading.bodies[b, 2]):
                    out[part, c, index[HEADER + index[AT_ROTATIONS] + j]] += (
                        bar * motions.by[part, m, j])
