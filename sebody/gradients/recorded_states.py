"""Recorded states of a run, in which its model is evaluated again."""

from sebody.compiler.decorators import compiled
from sebody.engine.evaluate import set_gravity, set_loads_beside
from sebody.engine.links import place_dependent


@compiled
def put_state(system, state, row, end, beside):
    """Put a recorded row, with the loads at its time and dependent positions."""
    for i in range(state.now.size):
        state.now[i] = row[i]
    set_loads_beside(system, state.frames, state.loads, end, beside)
    set_gravity(system, state)
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
