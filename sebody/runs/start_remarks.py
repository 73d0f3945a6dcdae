"""Remarks of a run on its start: initial velocities it does not have, bodies that fall."""

from numpy.typing import NDArray

from sebody.engine.state import State
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import Element, Superelement
from sebody.model.ties import untied
from sebody.runs.initial_velocities import changed, strained

MOST = 6        # bodies that a message lists


def start_remarks(model: Mechanism, numbering: Numbering, state: State) -> dict[str, str]:
    """Warnings by key of a model in the state that a run starts from."""
    remarks = {"changed": changed(model, numbering, state),
               "strained": strained(model, numbering, state), "falling": _falling(model)}
    return {key: message for key, message in remarks.items() if message}


def _falling(model: Mechanism) -> str:
    """Remark on bodies that start from rest where they are not connected to the ground."""
    if not model.gravity_field.any():
        return ""
    names = [name for group in untied(model) for name in group
             if not any(rate.any() for rate in _rates(model, group))]
    if not names:
        return ""
    more = len(names) - MOST
    listed = ", ".join(map(repr, names[:MOST])) + (f" and {more} more" if more > 0 else "")
    one = len(names) == 1
    return (f"{'body' if one else 'bodies'} {listed} {'is' if one else 'are'} not connected to the "
            f"ground and {'falls' if one else 'fall'} under gravity: join "
            f"{'it' if one else 'them'} to another body or fix a node, unless "
            f"{'it is' if one else 'they are'} meant to fall")


def _rates(model: Mechanism, names: list[str]) -> list[NDArray]:
    """Initial velocities that bodies were given."""
    bodies: dict[str, Superelement | Element] = {**model.bodies, **model.rigid_bodies}
    return [getattr(place.node, place.kind).rate for name in names
            for place in bodies[name].attachments]
