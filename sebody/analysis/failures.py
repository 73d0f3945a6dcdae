"""Why a run stopped, and what to do about it."""

from sebody.analysis import user_faults
from sebody.analysis.redundancy import contradiction
from sebody.assembly.numbering import Numbering
from sebody.engine.state import (
    ADAPTIVE,
    CHOSEN,
    FINEST,
    GAP,
    NO_START,
    REASON,
    REASONS,
    STEP,
    TIME,
    State,
)
from sebody.engine.system import System
from sebody.model.model import Model

KEPT = "results up to there are kept"


def explained(model: Model, system: System, state: State, numbering: Numbering) -> str:
    """The message of a run whose last step failed."""
    time, reason = float(state.clock[TIME]), int(state.control[REASON])
    stopped = f"stopped at t = {time:.6g}"
    if fault := user_faults.fault(model, time):
        return f"{stopped}: {fault}; {KEPT}"
    if reason == GAP:
        return f"{stopped}: {contradiction(system, state, numbering)}; {KEPT}"
    if reason == NO_START:
        return (f"{stopped}, where loads jump: {REASONS[reason]}; {KEPT}. Check the loads and the "
                "joints there")
    variable = state.control[ADAPTIVE] == 1
    shortest = state.clock[CHOSEN] if variable else state.clock[STEP] / FINEST
    remedy = "a larger tolerance" if variable else "a smaller step"
    return (f"{stopped}: {REASONS[reason]}, even with the step cut to {shortest:.3g}; {KEPT}. Use "
            f"{remedy}, check the loads, or split the body into more superelements")
