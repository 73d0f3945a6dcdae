"""Samples of controllers, for members in lanes: see `sebody.engine.control`.

All members sample at the same times. Sensors are read and controllers called member by member, by
the functions of single runs and with a member's own arrays; accelerations are then solved for in
lanes, for the members of which an input changed.
"""

from numba import typeof, types

from sebody.compiler.choice import way
from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import number_of, some, spread, with_number
from sebody.contract.counts import MEMBERS
from sebody.engine.calls import call_sample
from sebody.engine.control_data import NEXT
from sebody.engine.lanes.apart import GAVE_UP, RUNS, of_member
from sebody.engine.lanes.restart import restart
from sebody.engine.state import ASKED, DONE, SAMPLED


def address(groups: tuple) -> int:
    """Address of `sample` for system, state, scratch memory and arrays of members; compiled."""
    return way().address(sample, types.int64, (*map(typeof, groups), types.boolean))


@compiled
def sample(system, state, scratch, apart, dense):
    """Sample what is due at the time reached for the members that run in lanes."""
    control = state.control
    changed = spread(0.0)
    for member in range(MEMBERS):
        if number_of(control.reason, member) == RUNS:
            code = _sample_member(system, state, apart, member)
            if code < 0:
                control.reason = with_number(control.reason, member, GAVE_UP)
            else:
                changed = with_number(changed, member, float(code))
    changing = changed > 0.0
    if some(changing):
        restart(system, state, scratch, apart, changing, dense)
    return 0


@compiled
def _sample_member(system, state, apart, member):
    """Sample one member; 1 where an input changed, 0 where none did, -1 after a fault."""
    own_system, own = of_member(apart, member)
    numbers, lanes, first = apart.numbers, apart.lanes, apart.now[0]
    for k in range(first, first + own.now.size):
        numbers[member, k] = lanes[k, member]
    own.clock.time, own.clock.step = state.clock.time, state.clock.step
    own.control.restart, own.control.meets, own.control.inside = ASKED, SAMPLED, 0
    if call_sample(system.routines[2], own_system, own) != DONE:
        return -1
    for k in range(own.frames.size):        # inputs, signals and states of controllers
        state.frames[k] = with_number(state.frames[k], member, own.frames[k])
    state.memory[NEXT] = own.memory[NEXT]       # the same time for all
    return 1 if own.control.restart != 0 else 0
