"""The guard against growing energy, member by member: see `sebody.engine.growth`."""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import bits_of, some, spread, where
from sebody.contract.member_row import RUNNING
from sebody.engine.growth import (
    ATTENTIVE,
    DRIVEN,
    KEPT,
    RAREST,
    ROUNDED,
    SHARE,
    TURNED,
    WORKED,
    take_balance,
    turn_of_frames,
)


@compiled
def grows(system, state, scratch, running):
    """For which members energy seems to grow in the step: they are judged alone."""
    guard, none, more = state.guard, spread(0.0) > 1.0, spread(0.0)
    for k in range(state.works.size):
        more += abs(state.works[k] - state.works_old[k])
    guard.supplied = where(running, guard.supplied + more, guard.supplied)
    guard.wait = where(running, guard.wait - 1.0, guard.wait)
    due = running & (guard.off == 0.0) & (guard.wait <= 0.0)
    return _judge(system, state, scratch, due) if some(due) else none


@compiled
def _judge(system, state, scratch, due):
    """Look at the energies of some members; of the others, and of those that grow, nothing changes.
    """
    guard, frames = state.guard, state.frames
    for k in range(frames.size):
        scratch.frames[k] = frames[k]
    strain, kinetic = guard.most_strain, guard.most_kinetic
    before = strain + kinetic
    scratch.table[RUNNING] = bits_of(due)
    balance = take_balance(system, state)
    most_strain, most_kinetic = guard.most_strain, guard.most_kinetic
    more = most_strain + most_kinetic - before
    driven = (more > DRIVEN * before) & (guard.supplied > DRIVEN * more)
    lowest = where(driven | (before == 0.0), balance, guard.lowest + WORKED * guard.supplied)
    rise = balance - lowest
    turned = turn_of_frames(system, state)
    for k in range(frames.size):        # energies are those of the end of the step: so are frames
        frames[k] = where(due, frames[k], scratch.frames[k])
    allowed = SHARE * most_strain + (KEPT + TURNED * turned) * most_kinetic
    allowed += ROUNDED * state.clock.floor * state.clock.floor
    grown = due & (rise > allowed)
    good = due & ~grown
    stride = where(rise > ATTENTIVE * allowed, spread(1.0),
                   min(2.0 * max(guard.stride, spread(1.0)), spread(RAREST)))
    guard.most_strain = where(good, most_strain, strain)
    guard.most_kinetic = where(good, most_kinetic, kinetic)
    guard.calm = where(good, guard.calm + guard.stride, guard.calm)
    guard.balance = where(good, balance, guard.balance)
    guard.lowest = where(good, min(lowest, balance), guard.lowest)
    guard.supplied = where(good, spread(0.0), guard.supplied)
    guard.stride = where(good, stride, guard.stride)
    guard.wait = where(good, stride, guard.wait)
    return grown
