"""Motion of a body's floating frame and of its reduced coordinates in recorded states.

The kernel of the frame computes it from the recorded positions, rotations, velocities and
accelerations of the body's nodes: the frame as the run knew it, and the exact rates of that. Frames
that average the increments of a step go on from that of the step before.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.motions import motions
from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.counts import Counts
from sebody.contract.layout import MOTION, OK, RECORD, RESIDUAL
from sebody.kernels.abi import Arguments, at, call_kernel, pointer_to
from sebody.model.numbering import record_counts
from sebody.model.parts import Superelement
from sebody.quantities.reading import Motions
from sebody.results.recording import Recording

READ = "q", "R", "v", "a", "frames", "frames_old"      # of a recorded state


class BodyMotion(NamedTuple):
    """Frame and reduced coordinates of a body in n states; D is 3, in a plane 2.

    Velocities and accelerations are those in space, by components along the axes of the frame.
    """

    origin: NDArray             # (n, D) in global axes
    rotation: NDArray           # (n, D, D) from axes of the frame to global ones
    velocity: NDArray           # (n, D) of the origin
    acceleration: NDArray       # (n, D) of the origin
    spin: NDArray               # (n, 3), in a plane (n, 1)
    spin_rate: NDArray          # (n, 3), in a plane (n, 1)
    y: NDArray                  # (n, N) reduced coordinates, relative to the frame
    y_rate: NDArray             # (n, N)
    y_second: NDArray           # (n, N)


def body_motion(recording: Recording, body: Superelement, rows: slice | NDArray) -> BodyMotion:
    """Motion of a superelement in some of the recorded states.

    Raises
    ------
    InputError
        A recorded state in which the frame is not defined.
    """
    group, = motions(recording.model, recording.numbering, [body])
    found, status = evaluated(group, recording.rows[rows], record_counts(recording.numbering))
    if status != OK:
        raise InputError(f"the frame of body {body.name!r} is not defined in a recorded state")
    parts = MOTION.slices(group.counts)
    values = {name: found[:, 0, parts[name]] for name in parts}
    D = group.counts["D"]
    rotation = values["rotation"].reshape(-1, 3, 3)[:, :D, :D]
    return BodyMotion(**values | {"rotation": rotation})


def evaluated(group: Motions, rows: NDArray, counts: Counts) -> tuple[NDArray, int]:
    """Motion of some bodies in recorded states, and the status of the last one.

    Parameters
    ----------
    rows : (n, numbers of `layout.RECORD`)
    counts : dict
        Those of the record.

    Returns
    -------
    motions : (n, bodies, numbers of `layout.MOTION`)
        Zeros from the first state on that has a status.
    status : int
        OK, or why a frame is not defined.
    """
    values = np.zeros((len(rows), len(group.bodies), group.size))
    slices = RECORD.slices(counts)
    places = np.array([slices[name].start for name in READ])
    status = _evaluate(group.address, len(group.index[0]), group.counts["n"], group.index,
                       group.constants, np.ascontiguousarray(rows), places,
                       np.zeros(counts["stored"]), np.zeros(group.scratch), values)
    return values, status


@compiled
def _evaluate(address, stride, width, index, constants, rows, places, frames, work, out):
    """One call for each state; `frames` is where the kernel leaves those it has found."""
    size = out.shape[1] * out.shape[2]
    for k in range(rows.shape[0]):
        row = at(pointer_to(rows), k * rows.shape[1])
        for i in range(frames.size):
            frames[i] = row[places[4] + i]
        status = call_kernel(
            address, RESIDUAL, index.shape[0], stride, width,
            Arguments(index=pointer_to(index), constants=constants, q=at(row, places[0]),
                      R=at(row, places[1]), v=at(row, places[2]), a=at(row, places[3]),
                      references=at(row, places[5]), frames=frames, T=work, loads=work,
                      coefficients=work, forces=at(pointer_to(out), k * size), matrices=work,
                      work=work, energies=work))
        if status != OK:
            return status
    return OK
