"""One result of the phases of a run, in the numbering of the model with all of its parts.

What does not act in a phase has no multiplier, force and power in it: zeros stand for them.
"""

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.allocation import allocate
from sebody.contract.layout import ENERGIES, POWERS, RECORD_T
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, record_counts
from sebody.results.postprocessing import Forces
from sebody.results.recording import Event
from sebody.results.result import Result
from sebody.runs.taken_over import (
    Side,
    named,
    numbered,
    take_multipliers,
    take_states,
)

SAME = 1e-6         # of an output interval: nearer times are one


def merged(model: Mechanism, system: System, numbering: Numbering, parts: list[Result],
           events: Iterable[Event], h: float) -> Result:
    """The result of a run, of those of its phases.

    Parameters
    ----------
    system, numbering
        Of the model with all of its parts.
    h : float
        Output interval [time].
    """
    state = allocate(model, system, numbering, h, not system.slot_unknowns.size)
    kept = list(_kept(parts, h))
    rows, values, done = [], [], np.zeros(len(numbering.port_names))
    for part, own in zip(parts, kept, strict=True):
        new = Side(model, numbering, np.tile(state.now, (len(own), 1)))
        old = Side(part.model, part.numbering, part.unique_rows[own])
        new.row[:, :RECORD_T + 2] = old.row[:, :RECORD_T + 2]
        take_states(new, old)
        take_multipliers(new, old)
        at, before = _ports(part, numbering)
        new.part("works")[:] = done
        new.part("works")[:, at] += old.part("works")[:, before]
        done[at] += part.arrays_of_loop[1].works[before]    # in the state reached
        rows.append(new.row)
        values.append(_values(part, own, numbering, model, int(system.at_g[-1])))
    whole = Result(model, numbering, None, None, np.concatenate(rows),
                   sum(part.seconds for part in parts), parts[-1].failure, parts[0].start)
    whole.warnings = tuple(dict.fromkeys(text for part in parts for text in part.warnings))
    whole.events = tuple(events)
    energies, powers, residuals, elements, sums = map(np.concatenate, zip(*values, strict=True))
    # cached properties, evaluated with the arrays of each phase
    vars(whole).update(counters=np.sum([part.counters for part in parts], axis=0),
                       energies=energies, powers=powers, constraint_residuals=residuals,
                       forces=Forces(elements, sums))
    return whole


def _kept(parts: list[Result], h: float) -> Iterator[NDArray]:
    """Rows of each phase that are in the result: those on the grid, each once.

    A time at which something lets go or locks is that after it.
    """
    for part, after in zip(parts, [*parts[1:], None], strict=True):
        t = part.rows[:, RECORD_T]
        keep = np.abs(t / h - np.round(t / h)) < SAME
        if after is not None:
            keep &= t < after.rows[0, RECORD_T] - SAME * h
        yield np.flatnonzero(keep)


def _values(part: Result, own: NDArray, numbering: Numbering, model: Mechanism, forces: int
            ) -> tuple[NDArray, ...]:
    """Energies, powers, residuals of constraints and forces of a phase in the whole numbering."""
    counts = record_counts(numbering)
    at, before = _ports(part, numbering)
    energies = np.zeros((len(own), ENERGIES.size(counts)))
    energies[:, :POWERS] = part.energies[own, :POWERS]
    energies[:, POWERS + at] = part.energies[own][:, POWERS + before]
    powers = np.zeros((len(own), counts["ports"]))
    powers[:, at] = part.powers[own][:, before]
    elements = np.zeros((len(own), forces))
    others = _force_places(part.model, part.numbering, part.forces.elements.shape[1])
    for key, (first, size) in _force_places(model, numbering, forces).items():
        if key in others:
            elements[:, first:first + size] = part.forces.elements[
                own, others[key][0]:others[key][0] + size]
    sums = np.zeros((len(own), numbering.total))
    for block, first in numbering.dof_blocks.items():
        if block in part.numbering.dof_blocks:
            k, size = part.numbering.dof_blocks[block], block.start.size
            sums[:, first:first + size] = part.forces.sums[own, k:k + size]
    return energies, powers, part.constraint_residuals[own], elements, sums


def _ports(part: Result, numbering: Numbering) -> NDArray:
    """Power ports of the whole numbering that a phase has, and its own for them, (2, n)."""
    ports = dict(numbered(part.numbering.port_names))
    pairs = [(k, ports[key]) for key, k in numbered(numbering.port_names) if key in ports]
    return np.array(pairs, dtype=int).reshape(-1, 2).T


def _force_places(model: Mechanism, numbering: Numbering, total: int
                  ) -> dict[tuple[str, str, int], tuple[int, int]]:
    """The start of the forces of each body and element, and the number of forces."""
    at = numbering.forces_at
    firsts = sorted(at.values())
    sizes = dict(zip(firsts, np.diff([*firsts, total]).tolist(), strict=True))
    kinds = {"body": model.bodies.values(), "rigid": model.rigid_bodies.values(),
             "constraint": model.constraints, "load": model.loads}
    return {(kind, *key): (at[one], sizes[at[one]]) for kind, elements in kinds.items()
            for key, one in named(elements) if one in at}
