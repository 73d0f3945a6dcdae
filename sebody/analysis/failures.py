"""Why a run stopped, and what to do about it."""

from typing import TYPE_CHECKING

from sebody.analysis import user_faults
from sebody.analysis.redundancy import contradiction
from sebody.engine.state import CHOSEN, FINEST, GAP, NO_START, REASON, REASONS

if TYPE_CHECKING:
    from sebody.analysis.simulation import Simulation

KEPT = "results up to there are kept"


def explained(run: "Simulation") -> str:
    """The message of a run whose last step failed."""
    stopped, reason = f"stopped at t = {run.time:.6g}", int(run.state.control[REASON])
    if fault := user_faults.fault(run.model, run.time):
        return f"{stopped}: {fault}; {KEPT}"
    if reason == GAP:
        return f"{stopped}: {contradiction(run.system, run.state, run.numbering)}; {KEPT}"
    if reason == NO_START:
        return (f"{stopped}, where loads jump: {REASONS[reason]}; {KEPT}. Check the loads and the "
                "joints there")
    shortest = run.state.clock[CHOSEN] if run.tolerance else run.h / FINEST
    remedy = "a larger tolerance" if run.tolerance else "a smaller step"
    return (f"{stopped}: {REASONS[reason]}, even with the step cut to {shortest:.3g}; {KEPT}. Use "
            f"{remedy}, check the loads, or split the body into more superelements")
