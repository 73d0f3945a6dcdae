"""Numbers of contacts, stops, gears and friction that are varied: the checks of their builders."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.basics import inputs
from sebody.model.contacts import checked_limits, refuse_deep
from sebody.model.frictions import checked_friction
from sebody.model.gears import checked_ratio
from sebody.model.impacts import checked_law
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Attachment, DofBlock, Element


def refuse_numbers(model: Mechanism, one: Element) -> None:
    """Refuse numbers of an element, where the model is placed now, that its builder refuses.

    Raises
    ------
    InputError
        As `stop`, `contact`, `gear` and `friction`.
    """
    what = repr(one.name)
    c: dict[str, Any] = {name: value if np.ndim(value) else float(value)
                         for name, value in one.constants.items()}
    if "exponent" in c:
        checked_law(what, c["stiffness"], c["exponent"])
    if "static" in c:
        checked_friction(what, c["coefficient"], c["static"], c.get("bristle") or None, None,
                         c["speed"])
    if "radius" in c and "preload" in c:
        inputs.number(c["radius"], f"{what}: radius", above=0)
    if "preload" in c:
        inputs.number(c["preload"], f"{what}: preload", least=0)
    if "ratio" in c:
        checked_ratio(what, c["ratio"])
        checked_limits(what, c["lower"], c["upper"], 0.0, play=True)
    elif "lower" in c:
        checked_limits(what, c["lower"], c["upper"], _measured(one, c))
    elif "exponent" in c and one.point is None:
        kind = one.kind.rpartition("_on_")[2]
        refuse_deep(model, what, kind, c["radius"], _gap(one, c, kind))


def _measured(one: Element, c: Mapping) -> float:
    """Angle, way or distance that a stop limits, at the start."""
    kind = one.kind.removeprefix("planar_")
    if kind == "way_stop":
        return float(one.dof_blocks[0].start[0])
    if kind == "turn_stop":
        turns = [_turn(place) for place in one.dof_blocks]
        if "d" not in c:
            return float(one.dof_blocks[0].start[0] - one.dof_blocks[1].start[0])
        d, n, m = turns[0] @ c["d"], turns[1] @ c["n"], turns[1] @ c["m"]
        return float(np.arctan2(m @ d, n @ d))
    a, b = (_place(place) for place in one.attachments[:2])
    if kind == "distance_stop":
        return float(np.linalg.norm(b - a))
    return float((_turn(one.dof_blocks[2]) @ c["e"]) @ (b - a) - c["start"])


def _gap(one: Element, c: Mapping, kind: str) -> float:
    """Distance of a node from a surface at the start."""
    s, turn = _place(one.attachments[0]) - _place(one.attachments[1]), _turn(one.dof_blocks[-1])
    if kind == "plane":
        return float((turn @ c["n"]) @ s - c["level"])
    if kind == "cylinder":
        e = turn @ c["e"]
        s = s - e * (e @ s)
    return float(c["side"] * (np.linalg.norm(s) - c["size"]))


def _place(where: Attachment) -> NDArray:
    """Position at the start: of a rigid link its end."""
    block = where.dof_block
    if block.root is None:
        return block.start
    return block.root.start + sum(_turn(rotation) @ arm for rotation, arm in block.arms)


def _turn(rotation: DofBlock) -> NDArray:
    """Matrix of the rotation at the start, (3, 3) or planar (2, 2)."""
    if rotation.start.size == 3:
        return Rotation.from_rotvec(rotation.start).as_matrix()
    cosine, sine = np.cos(rotation.start[0]), np.sin(rotation.start[0])
    return np.array([[cosine, -sine], [sine, cosine]])
