"""What the richest model itself may be off by: linear theory in each body, and its last modes."""

from functools import lru_cache
from typing import NamedTuple

from sebody.analysis.advice.estimates import UNSURE
from sebody.analysis.advice.forms import Part
from sebody.analysis.advice.indicators.linearity import bent, local_rotations
from sebody.analysis.advice.indicators.omission import omission
from sebody.analysis.advice.indicators.recorded import Recorded
from sebody.analysis.advice.laboratory import Laboratory, Tried
from sebody.analysis.advice.search import Search

FALL = 0.1      # of an error by omitted modes, with each doubling of their number, at least


class Limit(NamedTuple):
    """An error that no form of a part takes away."""

    error: float
    sentence: str
    remedy: str


@lru_cache(maxsize=1)
def limits(lab: Laboratory) -> list[Limit]:
    """Of all parts, the largest first."""
    recorded = lab.estimates.recorded
    found = [one for part in lab.parts for one in (_linear(recorded, part), _modal(recorded, part))]
    return sorted(found, key=lambda one: -one.error)


def _linear(recorded: Recorded, part: Part) -> Limit:
    turn = max(local_rotations(recorded, part, part.richest.bodies))
    return Limit(bent(recorded, part, part.richest.bodies),
                 f"linear theory: {part.name} turns by {turn:.2g} rad within a body",
                 "divide it")


def _modal(recorded: Recorded, part: Part) -> Limit:
    """By how errors fall when half of the modes are left out, and all but a quarter."""
    most = part.richest.modes
    half, quarter = (omission(recorded, part, part.richest._replace(modes=most // k))
                     for k in (2, 4))
    fall = max(half / quarter, FALL) if most >= 4 and quarter > half > 0.0 else FALL
    return Limit(fall * half, f"modes: {part.name} has {most}", "reduce it with more modes")


def doubts(search: Search) -> list[str]:
    """What the richest model may be off by, where that is more than the tolerance."""
    return [f"the richest model may itself be off by {one.error:.1g}, from {one.sentence}; "
            f"{one.remedy}" for one in limits(search.lab)[:1]
            if one.error > search.tolerance]


def refusal(search: Search, found: Tried) -> str:
    """Why a tolerance is not reached, empty if it is."""
    lab = search.lab
    largest = next(iter(limits(lab)), None)
    if largest and largest.error > UNSURE * search.tolerance:
        return (f"the tolerance {search.tolerance:g} is not reached by the richest model, whose "
                f"error is limited by {largest.sentence}, which makes an error of about "
                f"{largest.error:.1g}: {largest.remedy}, or give a larger tolerance")
    if found.error <= search.tolerance:
        return ""
    return (f"no model that was tried is within {search.tolerance:g}: the best has an error of "
            f"{found.error:.2g} with the step {found.choice.step}, which limits it; give a smaller "
            "h, a larger tolerance or a larger budget")
