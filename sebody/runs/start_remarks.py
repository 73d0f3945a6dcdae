"""Remarks of a run on its start: initial velocities it does not have, bodies that fall."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sebody.engine.state import State
from sebody.model.gravity_fields import has_gravity
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import SLIDES, TURNS, Element, Superelement
from sebody.model.ties import untied
from sebody.runs.initial_velocities import changed, strained

MOST = 6        # bodies that a message lists
# what a joint of each kind leaves free first
MOVES = dict.fromkeys((*TURNS, "spherical", "universal"), "rotation") | dict.fromkeys(
    SLIDES, "position")
KICK = 1e-6     # of a state: noise of places that are zero as built is smaller


def start_remarks(model: Mechanism, numbering: Numbering, state: State) -> dict[str, str]:
    """Warnings by key of a model in the state that a run starts from."""
    remarks = {"changed": changed(model, numbering, state),
               "strained": strained(model, numbering, state), "falling": _falling(model),
               "locked": _locked(model)}
    return {key: message for key, message in remarks.items() if message}


def kicks(model: Mechanism, read: Callable[[str], float | NDArray]) -> dict[str, str]:
    """Warnings by key of continuous laws whose rates begin as if their inputs had just jumped.

    Parameters
    ----------
    read : callable
        Gives a sensor or quantity by name in the state that a run starts from.
    """
    found = {}
    for name, one in model.controllers.items():
        if one.at_rest is None:
            continue
        y = np.array([float(np.squeeze(read(own))) for own in one.inputs])
        states = one.at_rest(y)
        if np.abs(states - one.states).max() > KICK:
            shown = ", ".join(f"{x + 0.0:.6g}" for x in states)
            found[f"kick of {name}"] = (
                f"controller {name!r} begins as if its input {one.inputs[0]!r} had just jumped "
                f"from zero to {y[0]:.6g}, so its first outputs are large: give states=({shown}), "
                "with which its rate begins at zero")
    return found


def _locked(model: Mechanism) -> str:
    """Remark on joints that cannot move because both of their nodes are fixed."""
    names = [joint.name for joint in model.joints
             if (kind := MOVES.get(joint.kind)) and joint.time_function is None
             and all((own := getattr(node, kind)) is not None and own.fixed and not own.motions
                     for node in (joint.node, joint.to))]
    if not names:
        return ""
    one = len(names) == 1
    return (f"{'joint' if one else 'joints'} {', '.join(map(repr, names))} cannot move: "
            f"{'its' if one else 'their'} nodes are fixed; a joint to the ground holds its node by "
            "itself, so leave out fix(), or join another node")


def _falling(model: Mechanism) -> str:
    """Remark on bodies that start from rest where they are not connected to the ground."""
    if not has_gravity(model):
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
