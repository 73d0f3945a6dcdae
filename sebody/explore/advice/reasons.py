"""Reasons for a choice, axis by axis, in sentences with the numbers behind them."""

import numpy as np

from sebody.explore.advice.changes import Choice
from sebody.explore.advice.forms import Form, Part
from sebody.explore.advice.indicators.linearity import local_rotations
from sebody.explore.advice.indicators.vibration import first_frequency, frequency
from sebody.explore.advice.labels import in_words
from sebody.explore.advice.outcome import Reason
from sebody.explore.advice.runner import Laboratory
from sebody.explore.advice.search import Search

TURN = 2.0 * np.pi
# what is chosen of the whole model, and why
WHOLE = {"planar": ("planar", "it is symmetric about the plane"),
         "shared": ("joints of shared positions and rotations", "they replace equations"),
         "dropped": ("omitted positions and rotations", "only one body has them")}


def reasons(search: Search, choice: Choice) -> list[Reason]:
    """Reasons of the model, of every part and of the step."""
    lab, sentences = search.lab, []
    for name, (chosen, why) in WHOLE.items():
        if getattr(choice, name):
            sentences.append(Reason("model", chosen, why, 0.0, search.exact.get(name)))
    for k, (part, form) in enumerate(zip(lab.parts, choice.forms, strict=True)):
        sentences += _of_part(lab, k, part, form, search.untried)
    return [*sentences, _of_step(search, choice)]


def _of_part(lab: Laboratory, k: int, part: Part, form: Form, untried: list[str]) -> list[Reason]:
    """A line for the form, and one for each of its axes that were simplified."""
    if form == part.detailed:
        why = ("nothing less was enough" if lab.estimates.measured(k) else
               "nothing less was tried" if part.name in untried else
               "nothing less is predicted to be enough")
        return [Reason(part.name, in_words(part, form), why)]
    predicted, confirmed = lab.estimates.raw(k, form), lab.estimates.confirmed(k, form)
    total = sum(predicted.values())
    if form.rigid:
        return [Reason(part.name, "rigid", _slowness(lab, part, Form.first(part)), total,
                       confirmed)]
    head = Reason(part.name, in_words(part, form), "", total, confirmed)
    return [head, *(Reason(f"  {axis}", *_why(lab, part, form, axis), error)
                    for axis, error in predicted.items())]


def _why(lab: Laboratory, part: Part, form: Form, axis: str) -> tuple[str, str]:
    """Choice on an axis, and the number behind it."""
    recorded = lab.estimates.recorded
    if axis == "modes":
        return f"{form.modes}", _slowness(lab, part, form)
    if axis == "division":
        local = max(local_rotations(recorded, part, form.bodies))
        return f"{form.bodies}", f"its nodes rotate by {local:.2g} rad relative to it"
    (nodes, body), *_ = recorded.bodies(part, form.bodies)
    if axis == "inertia":
        spin = float(np.linalg.norm(recorded.spins(nodes), axis=1).max())
        return form.inertia, f"spin {spin / first_frequency(body):.2g} of its first frequency"
    return "none", "its stresses change its stiffness little"


def _slowness(lab: Laboratory, part: Part, form: Form) -> str:
    """First frequency that a form leaves out, against that of the part's motion."""
    recorded = lab.estimates.recorded
    (nodes, body), *_ = recorded.bodies(part, form.bodies)
    left = slice(len(body.stiffness) - body.modes + form.modes, None)
    squares = np.diag(body.stiffness)[left] / np.diag(body.mass)[left]
    if form == Form.first(part):
        omitted, what = first_frequency(body), "first mode"
    elif len(squares):
        omitted, what = float(np.sqrt(squares.min())), "first omitted mode"
    else:
        return "all there are"
    moving = recorded.motion_frequency
    return (f"{what}: {_short(omitted / moving)} times the motion's frequency" if moving > 0 else
            f"{what}: frequency {omitted / TURN:.2g}")


def _of_step(search: Search, choice: Choice) -> Reason:
    """The step against the vibrations there are, with its error by halving it."""
    lab, step = search.lab, choice.step
    recorded = lab.estimates.recorded
    halved = search.halved(choice)
    if step.local is not None:
        return Reason("step", str(step), "the motion is smooth except for short times",
                      confirmed=halved)
    vibrations = [frequency(recorded, recorded.deformation(recorded.nodes(part)).shifts)
                  for part, form in zip(lab.parts, choice.forms, strict=True) if not form.rigid]
    fastest = max(vibrations, default=0.0)
    steps = f"{_short(TURN / fastest / step.h)} steps a period of the vibration" if fastest else ""
    return Reason("step", f"{step.h:g}, {_times(step.h / lab.given_step.h)} given", steps,
                  confirmed=halved)


def _short(number: float) -> str:
    """Two digits of a number."""
    return f"{float(f'{number:.2g}'):g}"


def _times(ratio: float) -> str:
    if ratio == 1.0:
        return "as"
    return f"{ratio:g} times that" if ratio > 1 else f"1/{1 / ratio:g} of that"


def neighbours(search: Search, choice: Choice) -> list[str]:
    """Choices at a tolerance ten times tighter or looser."""
    sentences = []
    for factor in (0.1, 10.0):
        tolerance = factor * search.tolerance
        other = search.next(tolerance, sure=True)
        if other is None:
            what = "no model that was looked at"
        elif other == choice:
            what = "the same"
        else:
            what = _differences(search.lab, choice, other)
        sentences.append(f"at a tolerance of {tolerance:g} predicted: {what}")
    return sentences


def _differences(lab: Laboratory, choice: Choice, other: Choice) -> str:
    parts = [f"{part.name} {in_words(part, form)}" for part, before, form in zip(
        lab.parts, choice.forms, other.forms, strict=True) if form != before]
    step = [f"step {other.step}"] if other.step != choice.step else []
    return "; ".join([*parts, *step]) or "the same"
