"""Possible errors of the reference model itself: linear theory in each body, its last modes."""

from dataclasses import replace
from functools import lru_cache

from sebody.basics.errors import InputError, SimulationError
from sebody.explore.advice.estimates import UNSURE
from sebody.explore.advice.forms import Part
from sebody.explore.advice.indicators.linearity import bent, local_rotations
from sebody.explore.advice.indicators.omission import omission
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.outcome import TRUSTED, Doubt
from sebody.explore.advice.runner import Laboratory, Tried
from sebody.explore.advice.search import Search
from sebody.model.variants import divide

MEASURED = 0.1          # of the tolerance: larger estimates of beams are replaced by a run
LEFT = 4.0 / 3.0        # of what a division into twice as many bodies changes: of second order
FALL = 0.1      # of an error by omitted modes, with each doubling of their number, at least


@lru_cache(maxsize=1)
def limits(lab: Laboratory) -> list[Doubt]:
    """Limits of theory of all parts, the largest first; of beams measured in case of doubt."""
    recorded = lab.estimates.recorded
    listed, doubtful = [], []
    for part in lab.parts:
        own = [_linear(recorded, part), _modal(recorded, part)]
        if part.beam and max(one.error for one in own) > MEASURED * lab.tolerance:
            doubtful.append(part)
        else:
            listed += own
    if doubtful:
        listed.append(_divided(lab, doubtful))
    return sorted(listed, key=lambda one: -one.error)


def include(lab: Laboratory) -> None:
    """Add to the error of the reference what its division is measured to leave, if it is small.

    More than that is a doubt: no model is confirmed.
    """
    for one in limits(lab):
        if one.measured and one.error <= TRUSTED * lab.tolerance:
            lab.add_error(one.error)


def _divided(lab: Laboratory, parts: list[Part]) -> Doubt:
    """Change by twice as many bodies in some beams, with the same step: by runs."""
    whole, names = lab.builder.build(lab.detailed), ", ".join(part.name for part in parts)
    for part in parts:
        form = part.detailed
        whole = divide(whole, part.name, 2 * form.bodies, 2 * part.elements).model
    step = lab.trial
    sentence = f"{names} divided into twice as many bodies as in the reference model gave it"
    try:
        run = lab.beside(whole, step, f"with {names} in twice as many bodies")
    except (InputError, SimulationError) as reason:
        return Doubt(1.0, f"{names} divided further does not run: {reason}", "give a smaller h")
    apart = lab.apart(run, step.h)
    lab.table[-1] = replace(lab.table[-1], error=apart)
    return Doubt(LEFT * apart, sentence, "build it of several beams", True)


def _linear(recorded: Recorded, part: Part) -> Doubt:
    turn = max(local_rotations(recorded, part, part.detailed.bodies))
    return Doubt(bent(recorded, part, part.detailed.bodies),
                 f"linear theory: {part.name} rotates by {turn:.2g} rad within a body",
                 "divide it")


def _modal(recorded: Recorded, part: Part) -> Doubt:
    """By how errors fall when half of the modes are left out, and all but a quarter."""
    most = part.detailed.modes
    half, quarter = (omission(recorded, part, part.detailed._replace(modes=most // k))
                     for k in (2, 4))
    fall = max(half / quarter, FALL) if most >= 4 and quarter > half > 0.0 else FALL
    return Doubt(fall * half, f"modes: {part.name} has {most}", "reduce it with more modes")


def doubts(lab: Laboratory) -> list[Doubt]:
    """Possible errors of the reference model, by theory and by its guards, the largest first."""
    listed = [*limits(lab), *lab.doubts]
    return sorted((one for one in listed if one.error > 0.0), key=lambda one: -one.error)


def refusal(search: Search, found: Tried) -> str:
    """The reason why a tolerance is not reached, empty if it is."""
    lab = search.lab
    largest = next(iter(limits(lab)), None)
    if largest and largest.error > UNSURE * search.tolerance:
        return (f"the tolerance {search.tolerance:g} is not reached by the reference model, whose "
                f"error is limited by {largest.sentence}, which makes an error of about "
                f"{largest.error:.1g}: {largest.remedy}, or give a larger tolerance")
    if found.error <= search.tolerance:
        return ""
    return (f"no model that was tried is within {search.tolerance:g}: the best has an error of "
            f"{found.error:.2g} with the step {found.choice.step}, which limits it; give a smaller "
            "h, a larger tolerance or a larger budget")
