"""Bodies whose coupling with motions of their base is unknown: what they cannot be asked for."""

from sebody.basics.errors import InputError
from sebody.model.gravity_fields import has_gravity
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock

_REMEDY = "give grounded_body coupling= and rigid_mass="


def check_grounded(model: Mechanism) -> None:
    """Check that such bodies have a base at rest and no weight.

    Raises
    ------
    InputError
        A base that can move, or gravity; the message names the body.
    """
    for name, body in model.bodies.items():
        if not body.reduced.rests:
            continue
        what = (f"superelement {name!r} is held to the ground without inertial coupling with its "
                "base")
        base = body.nodes[body.reduced.base]
        if not all(_still(block) for block in (base.position, base.rotation)):
            raise InputError(f"{what}, so node {base.name!r}, its base, must be fixed: use "
                             f"model.foundation, or {_REMEDY}")
        if has_gravity(model):
            raise InputError(f"{what}, so its weight is unknown: {_REMEDY}, or leave gravity out "
                             "and give weights as loads")


def _still(dof_block: DofBlock) -> bool:
    """Tell whether nothing moves a DOF block, nor what it is rigidly linked to."""
    return all(one.fixed and not one.motions for one in dof_block.parents())
