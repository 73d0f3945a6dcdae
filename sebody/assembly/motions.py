"""Bodies whose motion one kernel computes in one call: what their frames do, and they in these."""

from collections.abc import Iterable

import numpy as np

from sebody.assembly.body_constants import frame_constants
from sebody.assembly.contracts import constants_row, frame_counts, index_row
from sebody.basics.errors import InputError
from sebody.contract.counts import scratch_size
from sebody.contract.names import motion_name
from sebody.kernels.loader import derive_command, load
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, coordinates
from sebody.model.parts import Superelement
from sebody.quantities.reading import Motions


def motion_kernel(body: Superelement) -> str:
    """Name of the kernel of a body's motion."""
    return motion_name(FRAMES[body.frame].kernel, body.reduced.planar)


def motions(model: Mechanism, numbering: Numbering, bodies: Iterable[Superelement]
            ) -> list[Motions]:
    """Some bodies of a model, grouped.

    Raises
    ------
    InputError
        There is no kernel for the motion of a frame; the message gives the command that makes it.
    """
    groups: dict[tuple, list[Superelement]] = {}
    for body in bodies:
        key = motion_kernel(body), len(body.positions), len(body.rotations), len(body.reduced.mass)
        groups.setdefault(key, []).append(body)
    places = {name: k for k, name in enumerate(model.bodies)}
    return [_group(name, group, numbering, places) for (name, *_), group in groups.items()]


def _group(name: str, bodies: list[Superelement], numbering: Numbering, places: dict[str, int]
           ) -> Motions:
    kernel = load(name)
    if kernel is None:
        raise InputError(f"there is no kernel for the motion of bodies with frame "
                         f"{bodies[0].frame!r}: make it with\n    {derive_command(name)}")
    counts = frame_counts(bodies[0])
    rows: dict[tuple, int] = {}         # where the constants of equal bodies begin
    constants, index, end = [], [], 0
    for body in bodies:
        key = body.reduced, tuple(body.alpha), tuple(body.alpha_r)
        if key not in rows:
            rows[key] = end
            constants.append(constants_row(body.name, kernel, counts, frame_constants(body)))
            end += len(constants[-1])
        unknowns = [c for t in (*body.positions, *body.rotations)
                    for c in coordinates(numbering, t)]
        modes = numbering.modes[body.name]
        unknowns += range(modes, modes + body.reduced.modes)
        index.append(index_row(
            body.name, kernel, unknowns, constants=rows[key], frame=places[body.name], port=0,
            positions=len(body.positions),
            nodes=[numbering.rotations.get(t, 0) for t in body.rotations]))
    return Motions(kernel.kernel.address, [body.name for body in bodies], counts,
                   np.array(index, dtype=np.int64), np.concatenate(constants),
                   scratch_size(kernel.WORK_ROWS, 0, counts["n"], counts["N_ROTATIONS"]))
