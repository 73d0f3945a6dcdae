"""Guard against energy that grows although nothing supplies it: such steps are halved.

Long steps can feed vibrations that they do not resolve. The balance ``kinetic + strain + potential
- work`` of a step shows it, since works are summed as the scheme does it (`engine.work`). Numerical
damping only lowers the balance. It may rise above its lowest value so far by

    SHARE * largest strain energy + (KEPT + TURNED * turn^2) * largest kinetic energy
    + WORKED * work done + ROUNDED * rounding,

where turn is the largest rotation of a body's frame in the step: the trapezoidal rule keeps the
energy of a rotating rigid body to the square of it. All three are the same in every frame of
reference but for the energy of a translation. A step that exceeds this is rejected and halved, and
steps stay halved until they have kept to it for a while.

Energies cost as much as forces, so they are looked at in every step only where the balance rises,
elsewhere ever more rarely.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import ENERGY, KINETIC, POTENTIAL, STRAIN
from sebody.engine.evaluate import run_kernels
from sebody.engine.step_control import AIM
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
ENOUGH = 64.0           # shortest steps with a rise, after which the run goes on without a guard

# State.guard: indices
(OFF,                   # 1 without bodies that deform, and where shorter steps are of no use
 WAIT,                  # steps to the next look
 STRIDE,                # steps between looks
 BALANCE,               # at the last look
 LOWEST,                # lowest so far, plus what works allow
 MOST_STRAIN,           # largest strain energy so far
 MOST_KINETIC,          # largest kinetic energy so far
 HALVED,                # how often steps are halved at present
 CALM,                  # steps since then without a rise
 PATIENT,               # steps before longer ones are tried
 REJECTIONS,            # steps that were rejected
 FIRST,                 # time of the first of them
 LAST,                  # and of the last
 MOST_HALVED,           # largest number of halvings so far
 SUPPLIED,              # work of all ports since the last look, each counted as positive
 IN_VAIN,               # shortest steps in which it rose all the same
 ) = range(16)
GUARDS = IN_VAIN + 1


@compiled
def grows(system, state):
    """Whether a converged step is to be rejected, because energy grows in it."""
    guard = state.guard
    if guard[OFF] == 1.0:
        return False
    for k in range(state.works.size):
        guard[SUPPLIED] += abs(state.works[k] - state.works_old[k])
    guard[WAIT] -= 1.0
    cut = state.control.level > guard[HALVED]      # Newton's iteration has not converged
    return (cut or guard[WAIT] <= 0.0) and _judge(system, state)


@compiled
def _judge(system, state):
    """Look at the energies; whether the step is to be rejected."""
    guard = state.guard
    before = guard[MOST_STRAIN] + guard[MOST_KINETIC]
    balance = _take_balance(system, state)
    more = guard[MOST_STRAIN] + guard[MOST_KINETIC] - before
    driven = more > DRIVEN * before and guard[SUPPLIED] > DRIVEN * more
    guard[LOWEST] = balance if driven or before == 0.0 else guard[LOWEST] + WORKED * guard[SUPPLIED]
    guard[SUPPLIED] = 0.0
    rise = balance - guard[LOWEST]
    turned = _turned(system, state)
    allowed = SHARE * guard[MOST_STRAIN] + (KEPT + TURNED * turned) * guard[MOST_KINETIC]
    allowed += ROUNDED * state.clock.floor * state.clock.floor
    if rise > allowed:
        return _reject(state, balance)
    guard[CALM] += guard[STRIDE]
    if guard[HALVED] > 0.0 and guard[CALM] > guard[PATIENT]:
        guard[HALVED] -= 1.0
        guard[CALM] = 0.0
    guard[BALANCE], guard[LOWEST] = balance, min(guard[LOWEST], balance)
    near = rise > ATTENTIVE * allowed or guard[HALVED] > 0.0
    guard[STRIDE] = 1.0 if near else min(2.0 * max(guard[STRIDE], 1.0), RAREST)
    guard[WAIT] = guard[STRIDE]
    return False


@compiled
def _take_balance(system, state):
    """Energies of the state less all works so far; remembers the largest energies."""
    guard, energy = state.guard, state.energy
    energy[KINETIC] = energy[STRAIN] = energy[POTENTIAL] = 0.0
    run_kernels(ENERGY, 0, system.address.size, system, state)
    guard[MOST_STRAIN] = max(guard[MOST_STRAIN], energy[STRAIN])
    guard[MOST_KINETIC] = max(guard[MOST_KINETIC], energy[KINETIC])
    balance = energy[KINETIC] + energy[STRAIN] + energy[POTENTIAL]
    for k in range(state.works.size):
        balance -= state.works[k]
    return balance


@compiled
def _turned(system, state):
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
def _reject(state, balance):
    """Ask for a shorter step; give up where the shortest ones do not help either."""
    guard, control = state.guard, state.control
    halved = max(guard[HALVED], float(control.level)) + 1.0
    # what has risen in steps that nobody looked at, or in spite of the shortest ones, stays
    last = guard[BALANCE]
    guard[LOWEST] = guard[BALANCE] = last if guard[STRIDE] == 1.0 else balance
    guard[STRIDE] = guard[WAIT] = 1.0
    if halved > DEEPEST:
        guard[LOWEST] = guard[BALANCE] = balance
        guard[IN_VAIN] += 1.0
        if guard[IN_VAIN] > ENOUGH:
            guard[OFF], guard[HALVED] = 1.0, 0.0
        return False
    if guard[REJECTIONS] == 0.0:
        guard[FIRST] = state.clock.end
    guard[LAST] = state.clock.end
    guard[REJECTIONS] += 1.0
    guard[PATIENT] = min(2.0 * guard[PATIENT], LONGEST_PATIENCE)
    guard[HALVED], guard[CALM] = halved, 0.0
    guard[MOST_HALVED] = max(guard[MOST_HALVED], halved)
    if control.adaptive == 1:
        state.clock.largest_error = AIM        # as after an error: longer ones not soon
    return True


def new_guard(bodies: int) -> np.ndarray:
    """The guard of a run that has not begun."""
    guard = np.zeros(GUARDS)
    guard[OFF], guard[PATIENT] = float(bodies == 0), 0.5 * PATIENCE
    return guard
