"""Fixed and shared triplets: joints without equations."""

from sebody.errors import InputError
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Triplet


def hold(triplet: Triplet) -> None:
    """Fix a triplet, which must not be a dependent position."""
    if triplet.root is not None:
        raise InputError(f"{triplet.name} hangs on another node by a rigid link: fix or move "
                         f"{triplet.root.name} and its rotation instead")
    triplet.fixed = True


def share(model: Mechanism, gone: Triplet, kept: Triplet, kind: str) -> None:
    """Replace one triplet by another at every node, joint and load."""
    if gone.fixed or gone.root is not None:
        gone, kept = kept, gone
    if gone.fixed or gone.root is not None:
        raise InputError(f"{gone.name} and {kept.name} cannot be one: each of them is fixed or "
                         "hangs on another node; use explicit=True")
    if gone.given and not kept.given:
        kept.rate, kept.given = gone.rate, True
    for node in (*model.nodes.values(), *model.grounds):
        if getattr(node, kind) is gone:
            setattr(node, kind, kept)
    for element in (*model.constraints, *model.loads, *model.rigid_bodies.values()):
        element.triplets = tuple(kept if t is gone else t for t in element.triplets)
    for triplet in model.triplets():
        if triplet.root is gone:
            triplet.root = kept
        triplet.arms = tuple((kept if r is gone else r, arm) for r, arm in triplet.arms)
