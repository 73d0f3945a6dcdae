"""Contacts of points inside bodies where another body takes the place of theirs."""

from dataclasses import replace

from sebody.basics.errors import InputError
from sebody.contract.names import body_contact_kind
from sebody.model.body_points import start_place, surface_touched
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import attach
from sebody.model.parts import Element, Node, Superelement, positions, rotations


def on_body(one: Element, body: Superelement, planar: bool) -> Element:
    """The contact on another superelement, reduced from the same FE model.

    Raises
    ------
    InputError
        The FE nodes of the new body are unknown or others.
    """
    assert one.point is not None
    before, after = one.point.body.reduced.recovery, body.reduced.recovery
    place = one.point.place
    if before is None or after is None or before.coordinates.shape != after.coordinates.shape:
        raise InputError(f"{one.name!r} touches an FE node of {body.name!r}, and the body in its "
                         "place has none or others")
    return replace(one, kind=body_contact_kind(FRAMES[body.frame].kernel, planar),
                   attachments=body.attachments + one.attachments[-2:],
                   point=one.point._replace(body=body, place=place))


def on_rigid_body(model: Mechanism, one: Element, carrier: Node) -> Element:
    """The contact on a node that is attached to the node of a rigid body."""
    assert one.point is not None
    node = attach(model, f"{one.name} point", start_place(one.point), carrier)
    b = one.attachments[-1].node
    surface, constants = surface_touched(one)
    return replace(one, kind=model.kind_of(f"point_on_{surface}"), point=None,
                   attachments=positions(node, b) + rotations(b), constants=constants)
