"""The guard of contacts: steps in which a contact changes its rate by too much are refused.

Generalized-alpha makes energy in contacts that last a few steps: a ball that is five contact times
a step apart from the wall comes back with 1.90 of its speed where 0.75 is right. So the rate of a
contact may change in a step by a part of the speed of its impact at most, in the step that opens it
too. Slow rates, of bodies that rest, are left alone.
"""

from sebody.compiler.decorators import compiled
from sebody.contract.layout import AT_IMPACT, AT_RATE

LARGEST = 0.1           # change of the rate in a step, relative to the speed of the impact
AT_ENDS = 0.015          # the same in steps in which it begins or opens: forces have a corner


@compiled
def contact_too_fast(system, state):
    """Whether the step that has converged is too long for a contact."""
    for k in range(system.guarded.size):
        rate, impact = system.guarded[k] + AT_RATE, system.guarded[k] + AT_IMPACT
        now, before = state.frames[impact], state.frames_old[impact]
        allowed = LARGEST * now if now > 0.0 and before > 0.0 else AT_ENDS * max(now, before)
        if abs(state.frames[rate] - state.frames_old[rate]) > allowed > 0.0:
            return True
    return False
