"""Bodies of a spatial model in the plane: those that differ by a rotation in it are made once.

So they are equal bodies of the planar model, too, which are evaluated eight at a time.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.model.mechanism import Mechanism
from sebody.reduction.body import ReducedBody
from sebody.reduction.plane import PlanarBody, planar_body

_SAME = 1e-13       # of axes that differ by rounding


def flat_bodies(model: Mechanism, axes: NDArray) -> dict[str, PlanarBody]:
    """The planar bodies by name.

    Parameters
    ----------
    axes : (3, 3)
        A rotation: its columns are the x and y axes in the plane, then the normal.

    Raises
    ------
    InputError
        A body that couples motion in the plane with motion out of it.
    """
    made: dict[ReducedBody, list[tuple[NDArray, PlanarBody]]] = {}
    found = {}
    for name, body in model.bodies.items():
        original, rotation = body.reduced.unrotated
        own, known = axes.T @ rotation, made.setdefault(original, [])
        turns = ((flat, _turn(own, other)) for other, flat in known)
        flat, turn = next((one for one in turns if one[1] is not None), (None, None))
        if flat is None or turn is None:
            found[name] = planar_body(body.reduced, axes, f"superelement {name!r}")
            known.append((own, found[name]))
        elif np.abs(turn - np.eye(2)).max() < _SAME:
            found[name] = flat
        else:
            found[name] = flat._replace(body=flat.body.rotated(turn))
    return found


def _turn(one: NDArray, other: NDArray) -> NDArray | None:
    """The rotation in the plane from other axes to some, (2, 2); None if they differ otherwise."""
    turn = one @ other.T
    if np.abs(turn[2] - [0.0, 0.0, 1.0]).max() > _SAME:
        return None
    x, y = turn[:2, 0] / np.linalg.norm(turn[:2, 0])
    return np.array([[x, -y], [y, x]])
