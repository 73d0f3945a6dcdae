"""Parts that let go and lock, as a model notes them."""

from collections.abc import Mapping
from typing import Any

from sebody.basics.errors import InputError
from sebody.model.acting import switch_of
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Joint


def note(model: Mechanism, name: str, given: Mapping[str, Any]) -> None:
    """Note when a part of a model acts.

    Raises
    ------
    InputError
        See `switch_of`; another element has this name.
    """
    if not given:
        return
    made = model.element(name)     # refuses a name that two have
    parts = made.constraints if isinstance(made, Joint) else (made,)
    places = [at for one in parts if isinstance(one, Element) for at in one.attachments]
    turns = bool(places) and all(place.kind == "rotation" for place in places)
    model.switches[name] = switch_of(given, repr(name), turns)


def refuse_switches(model: Mechanism) -> None:
    """Refuse a model with parts that let go or lock, for what does not follow these.

    Raises
    ------
    InputError
        The model has some.
    """
    if model.switches and not model.is_phase:
        name, switch = next(iter(model.switches.items()))
        raise InputError(
            f"{name!r} acts {switch.words()}, which only simulate(model, h, t_end) and "
            "PhasedSimulation(model, h) follow: build a model without this for anything else, with "
            "the parts that act")
