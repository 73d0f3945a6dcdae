"""The guard against growing energy, member by member: see `sebody.engine.growth`."""

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import bits_of, some, where
from sebody.contract.member_row import RUNNING
from sebody.engine import growth
from sebody.engine.growth import count_supplied, let_pass, look_at_energies
from sebody.engine.vectors import copy


@in_lanes_of(growth.grows)
def grows(system, state, members, converged):
    """For which members energy seems to grow in the step: they are judged alone.

    Of them, and of the members that are not looked at, nothing changes but the count of works.
    """
    guard, frames, scratch = state.guard, state.frames, members[0]
    count_supplied(state, converged)
    due = converged & (guard.off == 0.0) & (guard.wait <= 0.0)
    if not some(due):
        return due
    copy(frames, scratch.frames)
    strain, kinetic = guard.most_strain, guard.most_kinetic
    scratch.table[RUNNING] = bits_of(due)
    balance, lowest, allowed = look_at_energies(system, state)
    for k in range(frames.size):        # energies are those of the end of the step: so are frames
        frames[k] = where(due, frames[k], scratch.frames[k])
    grown = due & (balance - lowest > allowed)
    passing = due & ~grown
    guard.most_strain = where(passing, guard.most_strain, strain)
    guard.most_kinetic = where(passing, guard.most_kinetic, kinetic)
    let_pass(state, passing, balance, lowest, allowed)
    return grown
