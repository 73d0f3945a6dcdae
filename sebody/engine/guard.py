"""The guard of contacts: steps in which a contact changes its rate by too much are refused.

Generalized-alpha makes energy in contacts that last a few steps: a ball that is five contact times
a step apart from the wall comes back with 1.90 of its speed where 0.75 is right. So the rate of a
contact may change in a step by a part of the speed of its impact at most, in the step that opens it
too. Slow rates, of bodies that rest, are left alone, and so is the step in which a load begins to
move what rested in contact: nothing is struck. From then on its own rate is what is compared.
"""

from sebody.compiler.decorators import compiled
from sebody.contract.layout import AT_DEPTH, AT_IMPACT, AT_RATE
from sebody.engine.selection import either

LARGEST = 0.1           # change of the rate in a step, relative to the speed of the impact
AT_ENDS = 0.015          # the same in steps in which it begins or opens: forces have a corner


@compiled
def contact_too_fast(system, state):
    """Tell if the step that has converged is too long for a contact; in lanes, of which members."""
    kept, old = state.frames, state.frames_old
    fast = 0.0 * state.clock.floor > 1.0
    for k in range(system.guarded.size):
        rate, impact = system.guarded[k] + AT_RATE, system.guarded[k] + AT_IMPACT
        now, before, depth = kept[impact], old[impact], old[system.guarded[k] + AT_DEPTH]
        struck = (before != 0.0) | (depth < 0.0) | (abs(old[rate]) > LARGEST * now)
        within = (now > 0.0) & ((before > 0.0) | (depth >= 0.0))
        allowed = either(within, LARGEST * now, AT_ENDS * max(now, before))
        fast = fast | (struck & (allowed > 0.0) & (abs(kept[rate] - old[rate]) > allowed))
    return fast
