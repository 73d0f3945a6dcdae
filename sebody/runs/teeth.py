"""Effect of the teeth of gears on small motion: whether there are some, and how they soften shafts.

The default stiffness of teeth is one that steps follow, not one of steel. A vibration of the model
with stiff teeth passes moments mu through them, with ``(K - w^2 M) x = -R^T mu`` and the rows R of
the meshes; their compliance adds to the others', which to first order lowers its frequency to

    w / sqrt(1 + sum mu^2 / (k w^2))        (x of unit mass)
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, eigh, null_space

from sebody.engine.evaluate import to_body_axes
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.kernels.loader import element_kernel
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import Element
from sebody.results.contact_states import without_play
from sebody.runs.directions import of_mesh
from sebody.runs.tangents import tangent
from sebody.runs.tuning import ElementConstants

ROUNDED = 1e-12         # depth of teeth that is rounding of angles [rad]
MOST = 400              # unknowns: eigenvalues of more take seconds
SOFT = 0.01             # share of a frequency by which teeth lower it without a word
LOWEST = 3              # vibrations that are looked at
STILL = 1e-9            # square of a frequency, of the highest one, of a motion without stiffness


class Gears(NamedTuple):
    """A model with gears in a state of a run."""

    model: Mechanism
    numbering: Numbering
    system: System
    state: State


def teeth_remarks(run: Gears, M: NDArray | None = None, K: NDArray | None = None
                  ) -> dict[str, str]:
    """Warnings by key of gears in a state, with masses and stiffness of all unknowns."""
    gears = [load for load in run.model.loads if load.kind.endswith("gear_play")]
    remarks = {f"loose {one.name}": text for one in gears if (text := _loose(run, one))}
    tuned = [one for one in gears if one.tuned and one.number("exponent") == 1.0]
    if not tuned or run.numbering.free > MOST:
        return remarks
    if M is None or K is None:
        M, K = (tangent(run.system, run.state, *weights).toarray()
                for weights in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    names = ", ".join(repr(one.name) for one in tuned)
    omega, lowered = _softened(run, tuned, M, K)
    if lowered > SOFT:
        remarks["soft teeth"] = (
            f"the stiffness of the teeth of {names} was not given and is what steps of "
            f"{run.state.clock.step:.3g} follow: it lowers the frequency {omega:.4g} rad a unit of "
            f"time of the model with stiff teeth by {100 * lowered:.2g} %; give stiffness=, or "
            "shorter steps")
    return remarks


def _loose(run: Gears, gear: Element) -> str:
    """Remark on teeth that carry no load and have no stiffness without."""
    memory = dict(zip(element_kernel(gear.kind).MEMORY,
                      run.state.frames[run.numbering.memories[gear]], strict=True))
    if gear.number("exponent") == 1.0 or not without_play(gear) or memory["depth"] > ROUNDED:
        return ""
    return (f"the teeth of {gear.name!r} carry no load, and with exponent "
            f"{gear.number('exponent'):g} they have no stiffness without one: small motion is that "
            "of two separate shafts; load the gear, or give exponent=1")


def _softened(run: Gears, gears: list[Element], M: NDArray, K: NDArray
              ) -> tuple[float, float]:
    """The lowest frequency that teeth of finite stiffness lower most, and by which share of it."""
    n = len(K)
    multipliers = np.flatnonzero(run.system.is_multiplier[:n])
    moving = np.setdiff1d(np.arange(n), multipliers)
    rows, stiffness = [], []
    for gear in gears:
        row = of_mesh(gear, run.numbering, run.state)
        to_body_axes(run.system, run.state.frames, row, False)
        rows.append(row[:n][moving])
        stiffness.append(ElementConstants(gear, run.system, run.numbering)["stiffness"])
    G, R = K[np.ix_(multipliers, moving)], np.array(rows)
    free = null_space(np.vstack([G, R]))
    M, K = (A[np.ix_(moving, moving)] for A in (M, (K + K.T) / 2))
    try:
        squares, shapes = eigh(free.T @ K @ free, free.T @ M @ free)
    except LinAlgError:         # motions without mass
        return 0.0, 0.0
    worst = 0.0, 0.0
    elastic = np.flatnonzero(squares > STILL * squares.max(initial=0.0))[:LOWEST]
    for square, shape in zip(squares[elastic], (free @ shapes[:, elastic]).T, strict=True):
        through = np.linalg.lstsq(np.vstack([G, R]).T, square * M @ shape - K @ shape,
                                  rcond=None)[0][len(G):]
        share = float(np.sum(through**2 / np.array(stiffness)) / square)
        worst = max(worst, (float(np.sqrt(square)), 1.0 - 1.0 / np.sqrt(1.0 + share)),
                    key=lambda one: one[1])
    return worst
