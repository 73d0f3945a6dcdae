"""The guard of contacts, member by member: see `sebody.engine.guard`."""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import spread, where
from sebody.contract.layout import AT_IMPACT, AT_RATE
from sebody.engine.guard import AT_ENDS, LARGEST


@compiled
def contact_too_fast(system, state):
    """For which members the step that has converged is too long for a contact."""
    fast = spread(0.0) > 1.0
    for k in range(system.guarded.size):
        rate, impact = system.guarded[k] + AT_RATE, system.guarded[k] + AT_IMPACT
        now, before = state.frames[impact], state.frames_old[impact]
        allowed = where((now > 0.0) & (before > 0.0), LARGEST * now,
                        AT_ENDS * max(now, before))
        change = abs(state.frames[rate] - state.frames_old[rate])
        fast = fast | ((change > allowed) & (allowed > 0.0))
    return fast
