"""Forms and choices in a few words."""

from collections.abc import Hashable
from itertools import groupby

from sebody.explore.advice.changes import Choice
from sebody.explore.advice.forms import Form, Part


def in_words(part: Part, form: Form) -> str:
    """A form with its inertia."""
    if form.rigid:
        return "rigid"
    stiffening = "" if form.inertia != "floating_field" else (
        ", stiffening" if form.stiffening else ", not stiffening")
    return f"{_size(part, form)}, inertia {form.inertia}{stiffening}"


def limiting(parts: list[Part], kind: Hashable) -> str:
    """The contribution that makes most of an error."""
    if isinstance(kind, tuple) and kind and isinstance(kind[0], int):
        k, what = kind[0], kind[1]
        return f"the {what} of {parts[k].name}" if isinstance(what, str) else (
            f"the form of {parts[k].name}")
    if isinstance(kind, tuple) and kind and isinstance(kind[0], Form):
        return "the forms of its parts together"
    return "the step"


def in_brief(parts: list[Part], choice: Choice) -> str:
    """Forms of all parts, neighbours of one form together, and changes of the whole model.

    Inertia and stiffening are told where they are not those of the form in the reference model.
    """
    pairs = [(part.name, _brief(part, form))
             for part, form in zip(parts, choice.forms, strict=True)]
    told = [f"{', '.join(name for name, _ in group)}: {words}"
            for words, group in groupby(pairs, key=lambda pair: pair[1])]
    whole = {"planar": choice.planar, "joints shared": choice.shared,
             "DOF blocks dropped": choice.dropped}
    return "; ".join([*told, *(name for name, made in whole.items() if made)]) or "all as it is"


def _brief(part: Part, form: Form) -> str:
    if form.rigid:
        return "rigid"
    rich, told = part.detailed, [_size(part, form)]
    if form.inertia != rich.inertia:
        told.append(f"inertia {form.inertia}")
    elif form.stiffening != rich.stiffening:
        told.append("not stiffening")
    return ", ".join(told)


def _size(part: Part, form: Form) -> str:
    bodies = f"{form.bodies} bod{'y' if form.bodies == 1 else 'ies'} with " if part.beam else ""
    each = " each" if form.bodies > 1 else ""
    return f"{bodies}{form.modes} mode{'s' * (form.modes != 1)}{each}"


def in_units(seconds: float) -> str:
    """A time in words."""
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"
