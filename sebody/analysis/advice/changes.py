"""Choices of forms and steps, and the models they make: changes by name, for runs and as code."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from sebody.analysis.advice.forms import Form, Part
from sebody.model.model import Model
from sebody.model.variants import Variant, divide, keep_modes, rigid, with_options

FUNCTIONS: dict[str, Callable[..., Variant]] = {
    function.__name__: function for function in (divide, keep_modes, rigid, with_options)}


class Step(NamedTuple):
    """Fixed steps, or steps that keep a local tolerance on a grid."""

    h: float
    local: float | None = None


class Choice(NamedTuple):
    """Forms of all parts, in their order, and the steps."""

    forms: tuple[Form, ...]
    step: Step

    def poorer(self, other: "Choice") -> bool:
        """Whether it has no more of anything than another."""
        return (self.step.local == other.step.local and self.step.h >= other.step.h
                and all(a == b or a.poorer(b)
                        for a, b in zip(self.forms, other.forms, strict=True)))


class Change(NamedTuple):
    """A call of a variant."""

    variant: str
    name: str
    arguments: Mapping[str, object]

    def of(self, model: Model) -> Variant:
        """The changed model.

        Raises
        ------
        InputError
            The variant does not fit the model.
        """
        return FUNCTIONS[self.variant](model, self.name, **self.arguments)

    def code(self) -> str:
        """The call as a line of Python."""
        given = "".join(f", {key}={value!r}" for key, value in self.arguments.items())
        return f"model = {self.variant}(model, {self.name!r}{given}).model"


def changes(part: Part, form: Form) -> list[Change]:
    """What makes a form of a part from the given one."""
    given, found = part.given, []
    if part.beam is not None:
        if form.rigid:
            if given.bodies > 1:
                found.append(Change("divide", part.name, {"bodies": 1, "modes": 0}))
        elif form != given:
            found.append(Change("divide", part.name, {
                "bodies": form.bodies, "elements": part.elements, "modes": form.modes,
                "inertia": form.inertia, "stiffening": form.stiffening, "frame": form.frame}))
    elif not form.rigid:
        if form.modes != given.modes:
            found.append(Change("keep_modes", part.name, {"modes": form.modes}))
        if form[3:] != given[3:]:
            found.append(Change("with_options", part.name, {
                "inertia": form.inertia, "stiffening": form.stiffening, "frame": form.frame}))
    return [*found, Change("rigid", part.name, {})] if form.rigid else found


class Builder:
    """Models of choices; each change is made once.

    Parameters
    ----------
    model : Model
    parts : list of Part
    """

    def __init__(self, model: Model, parts: list[Part]):
        self.model, self.parts = model, parts
        self._made: dict[tuple[Form, ...], tuple[Model, list[str]]] = {}

    def changes(self, choice: Choice) -> list[Change]:
        """All changes of a choice, in their order."""
        pairs = list(zip(self.parts, choice.forms, strict=True))
        # rigid bodies last: beams are divided before their nodes are linked
        return sorted((one for part, form in pairs for one in changes(part, form)),
                      key=lambda one: one.variant == "rigid")

    def build(self, choice: Choice) -> Model:
        """The model of a choice.

        Raises
        ------
        InputError
            A change does not fit the model.
        """
        return self._variant(choice)[0]

    def sentences(self, choice: Choice) -> list[str]:
        """What was changed."""
        return self._variant(choice)[1]

    def _variant(self, choice: Choice) -> tuple[Model, list[str]]:
        if choice.forms not in self._made:
            model, sentences = self.model, []
            for change in self.changes(choice):
                model, sentence = change.of(model)
                sentences.append(sentence)
            self._made[choice.forms] = model, sentences
        return self._made[choice.forms]
