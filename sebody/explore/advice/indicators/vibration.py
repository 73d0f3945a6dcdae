"""Errors of a vibration's period, which add up over a run."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sebody.explore.advice.forms import Part
from sebody.explore.advice.indicators.coordinates import flat
from sebody.explore.advice.indicators.propagated import Force, propagated
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.reduction import ReducedBody

MOST = 2.0      # amplitudes: in antiphase


def detuned(recorded: Recorded, part: Part, change: float, most: float = MOST) -> float:
    """Error if the frequency of a part's vibration changes by a relative amount.

    The vibration is what is left of the recorded deformation u without its mean; its frequency is
    ``rms(u') / rms(u)``. After the time T it is out of phase by ``change * frequency * T``, which
    counts up to `most`.
    """
    found = recorded.deformation(recorded.nodes(part))
    shifts, turns = (one - one.mean(axis=0) for one in found[:2])
    phase = abs(change) * frequency(recorded, shifts) * recorded.duration
    return propagated(recorded, part, shifts, turns, strain_force(recorded, part)) * min(most,
                                                                                         phase)


def strain_force(recorded: Recorded, part: Part) -> Force:
    """Largest change of the elastic forces at the ends of a part, over the recorded run."""
    (nodes, body), = recorded.bodies(part, 1)
    found = recorded.deformation(nodes)
    n = len(body.stiffness) - body.modes
    forces = flat(body, found.shifts, found.turns) @ body.stiffness[:n, :n]
    return Force.of(body, forces - forces[0])


def frequency(recorded: Recorded, shifts: NDArray) -> float:
    """Mean angular frequency of a vibration."""
    shifts = np.nan_to_num(shifts)
    size = float(np.sqrt((shifts**2).mean()))
    return float(np.sqrt((recorded.rate(shifts)**2).mean())) / size if size > 0.0 else 0.0


def first_frequency(body: ReducedBody) -> float:
    """Lowest frequency with the coordinates of one node held, of all nodes."""
    d = body.coordinates.shape[1]
    owner = np.repeat([*body.position_nodes, *body.rotation_nodes],
                      [d] * len(body.position_nodes)
                      + [3 if d == 3 else 1] * len(body.rotation_nodes))
    squares = []
    for node in set(owner):
        free = np.flatnonzero(owner != node)
        K, M = (A[np.ix_(free, free)] for A in (body.stiffness, body.mass))
        squares.append(float(eigh(K, M, eigvals_only=True)[0]))
    return float(np.sqrt(max(min(squares), 1e-300)))
