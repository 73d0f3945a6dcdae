"""The guard of contacts, member by member: see `sebody.engine.guard`."""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import spread, where
from sebody.contract.layout import AT_DEPTH, AT_IMPACT, AT_RATE
from sebody.engine.guard import AT_ENDS, LARGEST


@compiled
def contact_too_fast(system, state):
    """For which members the step that has converged is too long for a contact."""
    fast = spread(0.0) > 1.0
    kept, old = state.frames, state.frames_old
    for k in range(system.guarded.size):
        rate, impact = system.guarded[k] + AT_RATE, system.guarded[k] + AT_IMPACT
        now, before, closed = kept[impact], old[impact], old[system.guarded[k] + AT_DEPTH] >= 0.0
        pushed = (before == 0.0) & closed & (abs(old[rate]) <= LARGEST * now)
        within = (now > 0.0) & ((before > 0.0) | closed)
        allowed = where(within, LARGEST * now, AT_ENDS * max(now, before))
        change = abs(kept[rate] - old[rate])
        fast = fast | ((change > allowed) & (allowed > 0.0) & ~pushed)
    return fast
