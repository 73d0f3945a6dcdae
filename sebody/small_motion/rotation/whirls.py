"""Orbits about an axis: forward and backward whirls, and the ellipses that they make.

With directions e1 and e2 across the axis, right-handed about it in the sense of the spin, harmonic
motion ``u = Re(U exp(i w t))`` is in the plane of complex numbers

    e1 . u + i e2 . u = F exp(i w t) + B exp(-i w t),
    F = (e1 . U + i e2 . U) / 2,    B* = (e1 . U - i e2 . U) / 2

an ellipse of half axes ``|F| + |B|`` and ``|F| - |B|``, run through forward where ``|F| > |B|``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.model.extent import extent
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.model.shafts import shaft_axes
from sebody.runs.rotating_frame import Spin
from sebody.runs.turning_parts import ON_LINE, Line, unit
from sebody.small_motion.linearization import Modes

FORWARD, BACKWARD, MIXED, PLANE = "forward", "backward", "mixed", "none"
SEEN = 1e-2         # of the largest motion of a mode: that of a node, and of whirls, that counts
ROUND = 1e-3        # minor over major axis of what is in a plane


class Ellipses(NamedTuple):
    """Harmonic motions of a point across an axis; see the equations of this module.

    Attributes
    ----------
    major : (m,)
        Half of the longer axis.
    minor : (m,)
        Half of the shorter one, negative of backward whirls.
    inclination : (m,)
        Angle of the longer axis from the first direction across [rad].
    phase : (m,)
        Angle by which its end is reached after ``t = 0`` [rad].
    """

    major: NDArray
    minor: NDArray
    inclination: NDArray
    phase: NDArray

    @classmethod
    def of(cls, motion: NDArray, across: NDArray) -> Ellipses:
        """Those of complex amplitudes (m, 3), in a plane (m, 2)."""
        forward, backward = parts(motion, across)
        F, B = np.angle(forward), np.angle(backward)
        return cls(np.abs(forward) + np.abs(backward), np.abs(forward) - np.abs(backward),
                   (F + B) / 2, np.mod((B - F) / 2, np.pi))

    @property
    def whirl(self) -> NDArray:
        """Names of the senses, (m,)."""
        return np.array([_name(*one) for one in zip(self.major, self.minor, strict=True)])


def parts(motion: NDArray, across: NDArray) -> tuple[NDArray, NDArray]:
    """F and B of complex amplitudes (..., 3), in a plane (..., 2)."""
    first, second = np.moveaxis(motion @ across, -1, 0)
    return (first + 1j * second) / 2, np.conj(first - 1j * second) / 2


def directions_across(spin: Spin) -> NDArray:
    """Two directions across the axis as columns, right-handed in the sense of the spin."""
    if spin.planar:
        return np.array([[1.0, 0.0], [0.0, np.sign(unit(spin)[0])]])
    axis = unit(spin)
    across = shaft_axes(axis * np.sign(axis[np.argmax(np.abs(axis))]))[:, :2]
    return across * (1.0, np.sign(axis[np.argmax(np.abs(axis))]))


def on_axis(model: Model, spin: Spin) -> dict[str, float]:
    """Nodes of turning parts that are on their lines, and the multiples of the spin there."""
    near, direction = ON_LINE * model.size(), unit(spin)
    return {name: spin.parts[node.position].factor for name, node in model.nodes.items()
            if spin.parts is not None and node.position in spin.parts
            and Line(spin.parts[node.position].point, direction).away(node.point) <= near}


def whirls(model: Model, modes: Modes, spin: Spin) -> NDArray:
    """Names of the whirls of modes, (m,): forward, backward, mixed, or none.

    Of nodes on the axis of what turns, by displacements and, in space, tilts times the size of the
    model. Mixed are those where some nodes run forward and others backward; none those along a line
    or about the axis.
    """
    nodes = on_axis(model, spin)
    if not nodes:
        return np.full(len(modes.values), PLANE)
    across, size = directions_across(spin), extent(model) or 1.0
    rows, whole = [], []
    for name, factor in nodes.items():
        for part in _moved(model.nodes[name], model.planar):
            motion = modes.shape(f"{name}.{part}").T * (size if part == "rotation" else 1.0)
            F, B = parts(motion, across * (1.0, np.sign(factor)))
            rows.append((np.abs(F) + np.abs(B), np.abs(F) - np.abs(B)))
            whole.append(np.linalg.norm(motion, axis=1))
    major, minor = (np.array(one).T for one in zip(*rows, strict=True))     # (m, motions)
    largest = np.max(whole, axis=0)
    return np.array([_of_mode(*one) for one in zip(major, minor, largest, strict=True)])


def _moved(node: Node, planar: bool) -> list[str]:
    return ["position"] + ["rotation"] * (node.rotation is not None and not planar)


def _of_mode(major: NDArray, minor: NDArray, largest: float) -> str:
    """The name for a mode by the orbits of its nodes."""
    if not major.max() > SEEN * largest:
        return PLANE
    names = {_name(*one) for one in zip(major, minor, strict=True)
             if one[0] > SEEN * major.max()} - {PLANE}
    return MIXED if len(names) > 1 else names.pop() if names else PLANE


def _name(major: float, minor: float) -> str:
    return PLANE if abs(minor) <= ROUND * major else FORWARD if minor > 0.0 else BACKWARD
