"""Friction and contacts that keep an equilibrium from being found."""

import numpy as np

from sebody.basics.errors import InputError
from sebody.results.contact_states import states
from sebody.runs.kkt_solver import Scaled
from sebody.runs.rotating_frame import Spin
from sebody.runs.settling import linear, move, solution
from sebody.runs.simulation import Standstill

CORRECTIONS = 20            # of Newton's iteration that are looked at; the first half may settle
RUN = "run the model with damping until it rests"


def in_turns(run: Standstill, spin: Spin) -> str:
    """Changes between sticking and sliding in Newton's iteration, or nothing, in words.

    From the state of the run, which is put back.
    """
    state, seen = run.state, []
    now = state.now.copy()
    state.frames_old[:] = state.frames
    for _ in range(CORRECTIONS):
        try:
            tangent, residual = linear(run, spin, None)
            correction = solution(run, Scaled(tangent), residual)
        except InputError:          # too far
            break
        seen.append(states(run.model, run.numbering, state.frames))
        if not np.isfinite(correction).all():
            break
        move(run, -correction)
    state.now[:] = now
    late = seen[len(seen) // 2:]
    turns = {name: found for name in (seen[0] if seen else ())
             if len(found := sorted({one[name] for one in late})) > 1}
    if not turns:
        return ""
    said = ", ".join(f"{name!r} {' and '.join(found)} in turns" for name, found in turns.items())
    return f"{said}: where such a model rests depends on its motion before: {RUN}"


def remedy(run: Standstill) -> str:
    """A remedy where friction or contacts hold a structure, or nothing."""
    now = states(run.model, run.numbering, run.state.frames)
    open_ones = [name for name, one in now.items() if one == "open"]
    rubbing = [name for name, one in now.items() if one in ("sticks", "slides")]
    if open_ones:
        return f"; contact {open_ones[0]!r} is open: begin where contacts press, or {RUN}"
    if rubbing:
        return (f"; friction {rubbing[0]!r} {now[rubbing[0]]}, and what it holds depends on the "
                f"motion before: {RUN}")
    return ""
