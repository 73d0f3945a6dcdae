"""The arrays of a state before its first step: where a model begins, and scratch memory."""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.build import work_size
from sebody.assembly.numbering import Numbering, coordinates
from sebody.engine.state import (
    AUX_STEP,
    CLOCKS,
    CONTRACTION,
    CONTROLS,
    CURRENT_STEP,
    RENEWED,
    STEP,
    WANTED,
    State,
)
from sebody.engine.system import System
from sebody.kernels.layout import COEFFICIENTS, ENERGIES, FIELD, LANES, whole_vectors
from sebody.model.model import Model
from sebody.results.recording import recorded_parts

SLOW_CONTRACTION = 0.95     # what Newton's iteration is taken to contract by before it was seen


def allocate(model: Model, system: System, numbering: Numbering, h: float, dense: bool) -> State:
    """The state of a model at t = 0, without accelerations and multipliers.

    Parameters
    ----------
    h : float
        Step of the output grid [time].
    dense : bool
        Whether the loop keeps an inverse of the iteration matrix.
    """
    n, total, items = numbering.free, numbering.total, len(numbering.histories)
    zeros = np.zeros
    parts = recorded_parts(numbering)
    now = _start(model, numbering, parts)
    q, R, v = (now[parts[name]] for name in ("q", "R", "v"))
    clock, control = zeros(CLOCKS), np.zeros(CONTROLS, dtype=np.int64)
    clock[STEP] = clock[CURRENT_STEP] = clock[AUX_STEP] = h
    clock[CONTRACTION] = SLOW_CONTRACTION
    control[WANTED] = RENEWED
    coefficients = zeros(COEFFICIENTS.size({}))
    coefficients[FIELD:FIELD + model.dimension] = model.gravity_field
    return State(
        now, *[now[parts[name]] for name in ("works", "q", "R", "v", "a", "frames", "frames_old")],
        aux=zeros(total), q_start=q.copy(), q_old=q.copy(), R_old=R.copy(),
        v_old=v.copy(), a_old=zeros(total), aux_old=zeros(total), dq=zeros(total), T=R.copy(),
        loads=zeros(3 * items), loads_old=zeros(3 * items), powers=zeros(items),
        powers_old=zeros(items), coefficients=coefficients,
        g=zeros(int(system.at_g[-1])), J=zeros(int(system.at_J[-1])),
        turned=zeros(int(system.width.max()) ** 2), residual=zeros(total), forces=zeros(total),
        correction=zeros(whole_vectors(total) + LANES), solution=zeros(system.slot_unknowns.size),
        last_correction=zeros(total), last_change=zeros(total),
        moved=np.ones(len(system.summands), dtype=bool), gaps=zeros(total), shift=zeros(total),
        strictness=zeros(total), expansion=zeros(_expansion_size(system)),
        matrix=zeros(system.rows.size + 1), scale=np.ones(total + LANES), weight=zeros(total),
        inverse=zeros((n, whole_vectors(n)) if dense else (1, 1)),
        column=zeros(LANES * system.slot_unknowns.size), work=zeros(work_size(model)),
        energy=zeros(ENERGIES.size({"items": items})), clock=clock, control=control)


def _start(model: Model, numbering: Numbering, parts: dict[str, slice]) -> NDArray:
    """The first row of what is recorded: initial places, unturned rotations and frames."""
    now = np.zeros(parts["frames_old"].stop)
    q, v = now[parts["q"]], now[parts["v"]]
    for node in (*model.nodes.values(), *model.grounds):
        for triplet in (node.position, node.rotation):
            if triplet is not None and id(triplet) in numbering.triplets:
                at = coordinates(numbering, triplet)
                q[at] = triplet.start
                v[at] = triplet.rate if triplet.solved else 0.0
    for body in model.bodies.values():
        first = numbering.modes[body.name]
        v[first:first + body.body.modes] = body.mode_rates
    for name in ("R", "frames", "frames_old"):
        now[parts[name]].reshape(-1, 3, 3)[:] = np.eye(3)
    return now


def _expansion_size(system: System) -> int:
    """Scratch of links: a rotation, and the largest matrix of an element before and after."""
    return 9 + int(max((w * wide + wide * wide for _, w, wide, *_ in system.links.elements),
                       default=0))
