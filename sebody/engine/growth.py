"""Guard against energy that grows although nothing supplies it: such steps are halved.

Long steps can feed vibrations that they do not resolve. The balance ``kinetic + strain + potential
- work`` of a step shows it, since works are summed as the scheme does it (`engine.work`). Numerical
damping only lowers the balance. It may rise above its lowest value so far by

    SHARE * largest strain energy + (KEPT + TURNED * turn^2) * largest kinetic energy
    + WORKED * work done + ROUNDED * rounding,

where turn is the largest rotation of a body's frame in the step: the trapezoidal rule keeps the
energy of a rotating rigid body to the square of it. All three are the same in every frame of
reference but for the energy of a translation. A step that exceeds this is rejected and halved, and
steps stay halved until they have kept to it for a while. A step that multiplies the energy has
ended at another root of its equations: it is halved as where Newton's iteration does not converge,
and does not count as energy that the model gains.

Energies cost as much as forces, so they are looked at in every step only where the balance rises,
elsewhere ever more rarely.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import ENERGY, KINETIC, POTENTIAL, STRAIN
from sebody.engine.evaluate import run_kernels
from sebody.engine.scalars import record
from sebody.engine.selection import either
from sebody.engine.step_control import forget_errors
from sebody.kernels.abi import pointer_to

SHARE = 0.02            # of the largest strain energy
KEPT = 2e-3             # of the largest kinetic energy: bodies hardly strained
TURNED = 0.25           # of the same times the square of the rotation in a step
WORKED = 0.01           # of the work in the step, for the error of contacts that last few steps
ROUNDED = 100.0         # of what rounding of positions leaves of energies
DRIVEN = 0.1            # part by which energies rise, and part of this rise that is supplied:
                        # the first steps of what loads set in motion are not judged
ATTENTIVE = 0.125       # share of the allowed rise from which on every step is looked at
RAREST = 64.0           # steps between two looks, at most
DEEPEST = 6.0           # times that steps are halved, at most
PATIENCE = 64.0         # steps before longer ones are tried; doubled by every rejection
LONGEST_PATIENCE = 4096.0
ELSEWHERE = 10.0        # times all energy so far, which a step gains at a root of another motion
ENOUGH = 64.0           # shortest steps with a rise, after which the run goes on without a guard

# fields of State.guard
GUARD = np.dtype([(name, np.float64) for name in (
    "off",                   # 1 without bodies that deform, and where shorter steps are of no use
    "wait",                  # steps to the next look
    "stride",                # steps between looks
    "balance",               # at the last look
    "lowest",                # lowest so far, plus what works allow
    "most_strain",           # largest strain energy so far
    "most_kinetic",          # largest kinetic energy so far
    "halved",                # how often steps are halved at present
    "calm",                  # steps since then without a rise
    "patient",               # steps before longer ones are tried
    "rejections",            # steps that were rejected
    "first",                 # time of the first of them
    "last",                  # and of the last
    "most_halved",           # largest number of halvings so far
    "supplied",              # work of all ports since the last look, each counted as positive
    "in_vain",               # shortest steps in which it rose all the same
)])


@compiled
def grows(system, state, members, converged):
    """Tell if a converged step is to be rejected, because energy grows in it.

    `members` as in `sebody.engine.iteration`.
    """
    guard = state.guard
    if guard.off == 1.0 or not converged:
        return False
    count_supplied(state, True)
    cut = state.control.level > guard.halved      # Newton's iteration has not converged
    return (cut or guard.wait <= 0.0) and judge(system, state)


@compiled
def count_supplied(state, running):
    """Count a step, and the works in it; in lanes, of the members that are running."""
    guard = state.guard
    for k in range(state.works.size):
        more = guard.supplied + abs(state.works[k] - state.works_old[k])
        guard.supplied = either(running, more, guard.supplied)
    guard.wait = either(running, guard.wait - 1.0, guard.wait)


@compiled
def judge(system, state):
    """Look at the energies; whether the step is to be rejected."""
    guard = state.guard
    strain, kinetic = guard.most_strain, guard.most_kinetic
    balance, lowest, allowed = look_at_energies(system, state)
    rise, before = balance - lowest, strain + kinetic
    if rise > allowed:
        guard.supplied = 0.0
        elsewhere = before > 0.0 and rise > ELSEWHERE * before
        if elsewhere:
            guard.most_strain, guard.most_kinetic = strain, kinetic
        return _reject(state, balance, elsewhere)
    let_pass(state, True, balance, lowest, allowed)
    return False


@compiled
def look_at_energies(system, state):
    """Balance of the energies, from what it may rise, and by how much; keeps the largest energies.
    """
    guard = state.guard
    before = guard.most_strain + guard.most_kinetic
    balance = _take_balance(system, state)
    more = guard.most_strain + guard.most_kinetic - before
    driven = (more > DRIVEN * before) & (guard.supplied > DRIVEN * more)
    lowest = either(driven | (before == 0.0), balance, guard.lowest + WORKED * guard.supplied)
    turned = _turn_of_frames(system, state)
    allowed = SHARE * guard.most_strain + (KEPT + TURNED * turned) * guard.most_kinetic
    return balance, lowest, allowed + ROUNDED * state.clock.floor * state.clock.floor


@compiled
def let_pass(state, passing, balance, lowest, allowed):
    """Accept a step that was looked at; choose the next one to look at. In lanes, of some members.
    """
    guard = state.guard
    guard.calm = either(passing, guard.calm + guard.stride, guard.calm)
    longer = passing & (guard.halved > 0.0) & (guard.calm > guard.patient)
    guard.halved = either(longer, guard.halved - 1.0, guard.halved)
    guard.calm = either(longer, 0.0, guard.calm)
    guard.balance = either(passing, balance, guard.balance)
    guard.lowest = either(passing, min(lowest, balance), guard.lowest)
    guard.supplied = either(passing, 0.0, guard.supplied)
    near = (balance - lowest > ATTENTIVE * allowed) | (guard.halved > 0.0)
    stride = either(near, 1.0, min(2.0 * max(guard.stride, 1.0), RAREST))
    guard.stride = either(passing, stride, guard.stride)
    guard.wait = either(passing, stride, guard.wait)


@compiled
def _take_balance(system, state):
    """Energies of the state less all works so far; remembers the largest energies."""
    guard, energy = state.guard, state.energy
    energy[KINETIC] = energy[STRAIN] = energy[POTENTIAL] = 0.0
    run_kernels(ENERGY, 0, system.address.size, system, state)
    guard.most_strain = max(guard.most_strain, energy[STRAIN])
    guard.most_kinetic = max(guard.most_kinetic, energy[KINETIC])
    balance = energy[KINETIC] + energy[STRAIN] + energy[POTENTIAL]
    for k in range(state.works.size):
        balance -= state.works[k]
    return balance


@compiled
def _turn_of_frames(system, state):
    """Square of the largest rotation of a body's frame in the step."""
    now, old = pointer_to(state.frames), pointer_to(state.frames_old)
    most, first = 0.0, 0
    for b in range(system.first_joint[0]):
        for _ in range(system.count[b]):
            square = 0.0
            for k in range(first, first + 9):
                square += (now[k] - old[k]) * (now[k] - old[k])
            most = max(most, 0.5 * square)
            first += 9
    return most


@compiled
def _reject(state, balance, elsewhere):
    """Ask for a shorter step; give up where the shortest ones do not help either."""
    guard, control = state.guard, state.control
    halved = max(guard.halved, float(control.level)) + 1.0
    # what has risen in steps that nobody looked at, or in spite of the shortest ones, stays
    last = guard.balance
    guard.lowest = guard.balance = last if guard.stride == 1.0 else balance
    guard.stride = guard.wait = 1.0
    if halved > DEEPEST:
        guard.lowest = guard.balance = balance
        guard.in_vain += 1.0
        if guard.in_vain > ENOUGH:
            guard.off, guard.halved = 1.0, 0.0
        return False
    guard.patient = min(2.0 * guard.patient, LONGEST_PATIENCE)
    guard.halved, guard.calm = halved, 0.0
    if not elsewhere:
        if guard.rejections == 0.0:
            guard.first = state.clock.end
        guard.last = state.clock.end
        guard.rejections += 1.0
        guard.most_halved = max(guard.most_halved, halved)
    if control.adaptive == 1:
        forget_errors(state.clock)
    return True


def new_guard(bodies: int) -> np.record:
    """The guard of a run that has not begun."""
    guard = record(GUARD)
    guard.off, guard.patient = float(bodies == 0), 0.5 * PATIENCE
    return guard
