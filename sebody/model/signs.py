"""The sign of ways, which version 0.2.0 has changed."""

from weakref import WeakSet

from sebody.basics.warned import warn
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Joint

_told: WeakSet[Mechanism] = WeakSet()


def warn_of_sign(model: Mechanism, what: str, joint: Joint) -> None:
    """Say once a model that limits and drives of a way have the sign of the displacement.

    Before version 0.2.0 they were of `to` against `node` where the axis is fixed in `node`: of
    prismatic and cylindrical joints and drives. A slider had the sign that all have now.
    """
    if joint.own_axes.carrier is not joint.node or model in _told:
        return
    _told.add(model)
    said = (f"{what}: since version 0.2.0 positive is where {joint.node.name!r} has moved along "
            f"the axis from {joint.to.name!r}, the sign of the joint's displacement; before, "
            "limits and drives of ways in prismatic and cylindrical joints and of drive_slide had "
            "the other sign")
    warn(said, FutureWarning)
