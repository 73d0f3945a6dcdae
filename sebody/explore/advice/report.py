"""Advice from what a search has found."""

from math import ceil
from time import process_time

from sebody.basics.units import parsed_units
from sebody.explore.advice.changes import Choice
from sebody.explore.advice.labels import in_units, limiting
from sebody.explore.advice.limits import doubts
from sebody.explore.advice.outcome import Advice
from sebody.explore.advice.reasons import neighbours, reasons
from sebody.explore.advice.runner import Tried
from sebody.explore.advice.search import Search
from sebody.results.units import unit_of_curves
from sebody.runs.tolerance import Tolerance

SAME = 0.02         # by which times of runs differ by chance


def conclusion(search: Search, found: Tried, given: Tried | None = None,
               interrupted: bool = False) -> Advice:
    """Advice from a choice that was found.

    Parameters
    ----------
    given : Tried, optional
        The model as it was given, with the given step.
    """
    lab, choice = search.lab, found.choice
    made = lab.builder.make(choice)
    seconds = found.seconds if interrupted else search.timed(found)
    remarks = [] if given is None or interrupted else [
        *lab.remarks, *_saved(search, seconds, given), *neighbours(search, choice)]
    warnings = lab.warnings if interrupted else _warnings(search, found)
    return Advice(
        made.model, choice.step.h, made.sentences, float(found.error), lab.tolerance,
        tuple(lab.table), tuple(search.untried),
        None if choice.step.local is None else Tolerance(choice.step.local),
        float(found.predicted), seconds, lab.runs.t_end,
        tuple(change.code() for change in made.changes), tuple(reasons(search, choice)),
        tuple(remarks), interrupted, tuple(doubts(lab)), warnings,
        _kept(search, found), lab.runs.balanced)


def _kept(search: Search, found: Tried) -> str:
    """Quality of what is kept, in the quantity's unit, when it is worst, and what limits it."""
    worst = found.worst
    if not worst.quantity or found.error == float("inf"):
        return ""
    when = "" if worst.row is None else f", worst at t = {worst.row * found.h:.4g}"
    parts = search.lab.estimates.contributions(found.choice)
    largest = max(parts, key=lambda one: one.error).kind if parts else ""
    units = search.lab.model.units
    named = unit_of_curves(worst.quantity, parsed_units(units)) if units else ""
    behind = f" {named}" * bool(named)
    return (f"Keeps {worst.quantity} {worst.kind + ' ' if worst.kind else ''}within "
            f"{found.error * worst.size:.2g}{behind} ({100 * found.error:.2g} % of "
            f"{worst.size:.3g}{behind}){when}; limited by "
            f"{limiting(search.lab.parts, largest)}")


def _warnings(search: Search, found: Tried) -> tuple[str, ...]:
    """Those of the reference, and of the chosen model, which runs once more."""
    lab = search.lab
    own = lab.run(found.choice, watched=True).result.warnings if found.error < float("inf") else ()
    return tuple(dict.fromkeys((*lab.warnings, *own)))


def _saved(search: Search, seconds: float, given: Tried) -> list[str]:
    """Saving of a run against the reference model and the given one, and what that took."""
    lab = search.lab
    detailed: Choice = lab.detailed
    whole = next(one for one in lab.tried if one.choice == detailed).seconds
    told = (f"a run takes {in_units(seconds)}, "
            f"the reference model {in_units(whole)}, {whole / seconds:.3g} times as long")
    others = {"the reference model": whole}
    if given.error < float("inf"):
        others["the given model"] = least = search.timed(given)
        told += (f", the given one with its step {in_units(least)}, {least / seconds:.3g} times, "
                 f"with an error of {given.error:.2g}")
        if given.error > lab.tolerance:
            del others["the given model"]       # it is no alternative
    spent = process_time() - lab.begun
    return [told, f"the search took {in_units(spent)}: {lab.count} runs, as much as "
            f"{lab.spent():.2g} of the reference model, and making their models; "
            + _pays(spent, seconds, others)]


def _pays(spent: float, seconds: float, others: dict[str, float]) -> str:
    """After how many runs a search has paid, by seconds of runs that it replaces."""
    told = [f"{ceil(spent / (other - seconds))} runs instead of those of {name}"
            for name, other in others.items() if other > (1.0 + SAME) * seconds]
    return f"it pays after {', or '.join(told)}" if told else "it pays by what it confirms alone"
