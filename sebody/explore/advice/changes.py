"""Choices of forms and steps, and the models they make: changes by name, for runs and as code."""

from collections.abc import Callable, Collection, Mapping
from typing import NamedTuple

from sebody.basics.errors import InputError
from sebody.explore.advice.forms import Form, Part
from sebody.model.model import Model
from sebody.model.variants import (
    Variant,
    can_be_dropped,
    can_be_shared,
    divide,
    drop_triplet,
    keep_modes,
    planar,
    rigid,
    shared,
    with_options,
)

FUNCTIONS: dict[str, Callable[..., Variant]] = {
    function.__name__: function
    for function in (divide, keep_modes, with_options, rigid, drop_triplet, shared, planar)}


class Step(NamedTuple):
    """Fixed steps, or variable ones with a local tolerance, recorded on a grid."""

    h: float
    local: float | None = None

    def finer(self) -> "Step":
        """Half the step: of variable ones an eighth of the local tolerance."""
        return Step(self.h / 2) if self.local is None else Step(self.h, self.local / 8)

    def __str__(self) -> str:
        if self.local is None:
            return f"{self.h:g}"
        return f"variable steps, local tolerance {self.local:.2g}"


class Choice(NamedTuple):
    """Forms of all parts, in their order, the steps, and changes of the whole model."""

    forms: tuple[Form, ...]
    step: Step
    planar: bool = False
    shared: bool = False
    dropped: bool = False

    def poorer(self, other: "Choice") -> bool:
        """Tell whether it has no more of anything than another."""
        mine, others = self.step, other.step
        coarser = (mine.h >= others.h if mine.local is None is others.local else
                   mine.local is not None and others.local is not None
                   and mine.local >= others.local)
        return coarser and all(a == b or a.poorer(b)
                               for a, b in zip(self.forms, other.forms, strict=True))


class Change(NamedTuple):
    """A call of a variant."""

    variant: str
    name: str | None            # of the part; None of the model
    arguments: Mapping[str, object]

    def of(self, model: Model) -> Variant:
        """The changed model.

        Raises
        ------
        InputError
            The variant does not fit the model.
        """
        names = () if self.name is None else (self.name,)
        return FUNCTIONS[self.variant](model, *names, **self.arguments)

    def code(self) -> str:
        """The call as a line of Python."""
        names = "" if self.name is None else f", {self.name!r}"
        given = "".join(f", {key}={value!r}" for key, value in self.arguments.items())
        return f"model = {self.variant}(model{names}{given}).model"


def changes(part: Part, form: Form) -> list[Change]:
    """Changes that make a form of a part from the given one."""
    given, words = part.given, []
    if part.beam is not None:
        if form.rigid:
            if given.bodies > 1:
                words.append(Change("divide", part.name, {"bodies": 1, "modes": 0}))
        elif form != given:
            options = {name: getattr(form, name) for name in ("modes", "inertia", "stiffening",
                                                              "frame")
                       if getattr(form, name) != getattr(given, name)}
            words.append(Change("divide", part.name, {
                "bodies": form.bodies, "elements": part.elements, **options}))
    elif not form.rigid:
        if form.modes != given.modes:
            words.append(Change("keep_modes", part.name, {"modes": form.modes}))
        if form[3:] != given[3:]:
            words.append(Change("with_options", part.name, {
                "inertia": form.inertia, "stiffening": form.stiffening, "frame": form.frame}))
    return [*words, Change("rigid", part.name, {})] if form.rigid else words


class Made(NamedTuple):
    """The model of a choice, and how it was made."""

    model: Model
    changes: tuple[Change, ...]
    sentences: tuple[str, ...]


class Builder:
    """Models of choices; each is made once.

    Parameters
    ----------
    model : Model
    parts : list of Part
    kept : set of str
        Names of nodes whose DOF blocks are not dropped.
    """

    def __init__(self, model: Model, parts: list[Part], kept: Collection[str] = ()):
        self.model, self.parts, self.kept = model, parts, kept
        self._made: dict[tuple, Made | InputError] = {}
        self._steps: dict[tuple[str, ...], Made] = {}

    def make(self, choice: Choice) -> Made:
        """The model of a choice.

        Raises
        ------
        InputError
            A change does not fit the model.
        """
        key = choice._replace(step=None)
        if key not in self._made:
            try:
                self._made[key] = self._of(choice)
            except InputError as reason:
                self._made[key] = reason
        made = self._made[key]
        if isinstance(made, InputError):
            raise made
        return made

    def build(self, choice: Choice) -> Model:
        """Its model alone, see `make`."""
        return self.make(choice).model

    def _of(self, choice: Choice) -> Made:
        pairs = zip(self.parts, choice.forms, strict=True)
        # rigid bodies last: beams are divided before their nodes are linked
        made = sorted((one for part, form in pairs for one in changes(part, form)),
                      key=lambda one: one.variant == "rigid")
        simplified = Made(self.model, (), ())
        for change in made:
            simplified = self._further(simplified, change)
        if choice.dropped:
            for body, node, what in can_be_dropped(simplified.model):
                if node not in self.kept:
                    simplified = self._further(simplified, Change("drop_triplet", body,
                                                                  {"node": node, "what": what}))
        if choice.shared:
            for name in can_be_shared(simplified.model):
                simplified = self._further(simplified, Change("shared", name, {}))
        if choice.planar:
            simplified = self._further(simplified, Change("planar", None, {}))
        return simplified

    def _further(self, made: Made, change: Change) -> Made:
        """A model with one more change, which others may have in common."""
        key = (*(one.code() for one in made.changes), change.code())
        if key not in self._steps:
            model, sentence = change.of(made.model)
            self._steps[key] = Made(model, (*made.changes, change), (*made.sentences, sentence))
        return self._steps[key]
