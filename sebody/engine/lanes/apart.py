"""Arrays of a member's own: numbers are taken to them from its lane, and given back.

That is done for a matrix and for a sample, which functions of single runs make, and for the steps
after a rejected one. Steps are rejected where Newton's iteration fails, at impacts and where energy
grows; where loads jump, members go alone, too. Then the loop for numbers makes the steps of the
grid that the others make in lanes, until it is back at the length of theirs. So a member makes the
steps it would make alone.
"""

import numpy as np
from numba import types
from numba.extending import intrinsic

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import number_of, with_number
from sebody.contract.counts import MEMBERS
from sebody.engine.calls import call_advance
from sebody.engine.growth import judge
from sebody.engine.prediction import ROWS
from sebody.engine.state import ANEW, DONE, EVALUATED, GROWS, NO_REASON
from sebody.engine.step import back, cut_step
from sebody.engine.step_control import NEAR
from sebody.engine.work import take_back_work

# of `control.reason` in lanes: what a member does. It runs in lanes; has given up, and is run alone
# from its start; is alone; or it leaves for a reason of a single run, or because its loads jump
RUNS, GAVE_UP, APART, JUMPS = float(NO_REASON), -2.0, -1.0, ANEW + 1.0
_ANY = 2**62        # steps in one call


@intrinsic
def group_at(typingctx, group, address):
    """The group at an address, of the type of another one."""
    def codegen(context, builder, sig, args):
        return builder.inttoptr(args[1], context.get_value_type(sig.return_type))
    return group(group, types.int64), codegen


@compiled
def of_member(apart, member):
    """System and state of a member alone."""
    return (group_at(apart.system, apart.addresses[member, 0]),
            group_at(apart.state, apart.addresses[member, 1]))


@compiled
def take(apart, places, member):
    """Copy some numbers of a member from its lane to its own arrays."""
    for k in places:
        apart.numbers[member, k] = apart.lanes[k, member]


@compiled
def give(apart, places, member):
    """Copy some numbers of a member to its lane."""
    for k in places:
        apart.lanes[k, member] = apart.numbers[member, k]


@compiled
def jump_is_ahead(system, state):
    """Tell if loads jump in the next step."""
    clock, control, corners = state.clock, state.control, system.corners
    near = NEAR * clock.current_step
    while control.corner < corners.size and (system.jumps[control.corner] == 0 or (
            corners[control.corner] <= clock.time + near)):
        control.corner += 1
    return (control.corner < corners.size
            and corners[control.corner] < clock.time + clock.current_step + near)


@compiled
def take_apart(state, apart):
    """Copy the members that leave to arrays of their own, at the begin of their step.

    One whose energy is found not to grow after all stays.
    """
    control = state.control
    for member in range(MEMBERS):
        reason = number_of(control.reason, member)
        if reason <= RUNS:
            continue
        system, own = of_member(apart, member)
        _copy_to(state, apart, member)
        own.control.refreshed = 0
        own.control.pivoted = np.int64(number_of(apart.exchanged[0], member))
        if reason == GROWS:
            if not judge(system, own):
                _give_floats(apart.guard_words, apart.guard[member], apart.guard_in_lanes, member)
                control.reason = with_number(control.reason, member, RUNS)
                continue
        if reason != JUMPS:
            take_back_work(own)
            back(own)
            if reason != ANEW:
                cut_step(own)
        control.reason = with_number(control.reason, member, APART)


@compiled
def run_apart(state, apart, scheme, dense):
    """Run the members that are alone to the time of the others; those that can come back."""
    control = state.control
    for member in range(MEMBERS):
        if number_of(control.reason, member) != APART:
            continue
        system, own = of_member(apart, member)
        code = call_advance(apart.routines[0], system, own, apart.record, scheme, control.grid,
                            _ANY, dense)
        if code != DONE:
            control.reason = with_number(control.reason, member, GAVE_UP)
        elif own.control.regularized != control.regularized:
            control.reason = with_number(control.reason, member, GAVE_UP)
        elif own.control.level == 0 and own.control.inside == 0 and own.guard.halved == 0.0:
            _come_back(state, apart, own, member)
            control.reason = with_number(control.reason, member, RUNS)


@compiled
def show(state, apart, places):
    """Put numbers that are recorded of members that are alone into their lanes."""
    control, first = state.control, apart.now[0]
    for member in range(MEMBERS):
        if number_of(control.reason, member) == APART:
            own = of_member(apart, member)[1]
            for k in places:
                apart.lanes[first + k, member] = own.now[k]
            control.iterations = with_number(control.iterations, member,
                                             float(own.control.iterations))


@compiled
def _copy_to(state, apart, member):
    """Copy a member's numbers from its lane."""
    take(apart, apart.places, member)
    for k in range(apart.control_words.shape[0]):
        place, own = apart.control_words[k, 0], apart.control_words[k, 1]
        apart.control[member, k] = (np.int64(apart.control_in_lanes[place + member]) if own == 1
                                    else apart.whole_in_lanes[place])
    _take_floats(apart.clock_words, apart.clock[member], apart.clock_in_lanes, member)
    _take_floats(apart.guard_words, apart.guard[member], apart.guard_in_lanes, member)
    _turn_ring(state, apart, of_member(apart, member)[1], member, True)


@compiled
def _come_back(state, apart, own, member):
    """Copy a member's numbers to its lane; its next step is as long as those of the others."""
    clock = state.clock
    offset = clock.current_step / own.clock.aux_step
    if offset != 1.0:
        for i in range(own.aux.size):       # changes in the last step stay: predictions read them
            more = (offset - 1.0) * (own.aux[i] - own.a[i])
            own.aux[i] += more
            own.aux_old[i] += more
    if own.clock.factor_step != clock.current_step:
        own.control.wanted = EVALUATED
    give(apart, apart.places, member)
    apart.exchanged[0] = with_number(apart.exchanged[0], member, float(own.control.pivoted))
    for k in range(apart.control_words.shape[0]):
        if apart.control_words[k, 1] == 1:
            apart.control_in_lanes[apart.control_words[k, 0] + member] = apart.control[member, k]
    _give_floats(apart.clock_words, apart.clock[member], apart.clock_in_lanes, member)
    _give_floats(apart.guard_words, apart.guard[member], apart.guard_in_lanes, member)
    _turn_ring(state, apart, own, member, False)


@compiled
def _take_floats(words, own, in_lanes, member):
    """Scalars of a member from a record in lanes."""
    for k in range(words.shape[0]):
        own[k] = in_lanes[words[k, 0] + words[k, 1] * member]


@compiled
def _give_floats(words, own, in_lanes, member):
    """Put a member's scalars into a record in lanes, where it has its own."""
    for k in range(words.shape[0]):
        if words[k, 1] == 1:
            in_lanes[words[k, 0] + member] = own[k]


@compiled
def _turn_ring(state, apart, own, member, taken):
    """Copy the last changes and their products, by rows: in lanes they are counted by the grid."""
    first, size, fit = apart.changes[0], own.q.size, apart.changes[1]
    grid, steps = state.control.grid, own.control.steps
    for row in range(ROWS):
        there, here = (grid + row) % ROWS, (steps + row) % ROWS
        for i in range(size):
            _copy(apart, member, first + size * here + i, first + size * there + i, taken)
        for other in range(ROWS):
            _copy(apart, member, fit + ROWS * here + (steps + other) % ROWS,
                  fit + ROWS * there + (grid + other) % ROWS, taken)


@compiled(forceinline=True)
def _copy(apart, member, here, there, taken):
    """Copy a number from a lane, or back."""
    if taken:
        apart.numbers[member, here] = apart.lanes[there, member]
    else:
        apart.lanes[there, member] = apart.numbers[member, here]
