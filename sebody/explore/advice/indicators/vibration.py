"""Errors of a vibration's period, which add up over a run."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sebody.explore.advice.forms import Part
from sebody.explore.advice.indicators.coordinates import flat
from sebody.explore.advice.indicators.propagated import Force, propagated
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.reduction.body import ReducedBody

MOST = 2.0      # amplitudes: in antiphase


class Vibration(NamedTuple):
    """Vibrations in a model, as errors of the quantities that it would make.

    Parameters
    ----------
    slope : float
        By being out of phase, for a small relative change of the frequency.
    most : float
        In antiphase.
    energies : dict of str to float
        Mean strain energies of the parts, by their names.
    """

    slope: float
    most: float
    energies: dict[str, float]


def detuned(recorded: Recorded, part: Part, change: float) -> float:
    """Error if a part's mass or stiffness changes its own frequency by a relative amount.

    The parts vibrate together: the frequency of all changes by as much as the part has of the
    strain energy. After the time t this vibration is out of phase by ``change * frequency * t``,
    which counts up to antiphase.
    """
    whole = _vibration(recorded)
    total = sum(whole.energies.values())
    share = whole.energies[part.name] / total if total > 0.0 else 1.0
    return min(abs(change) * share * whole.slope, whole.most)


def _vibration(recorded: Recorded) -> Vibration:
    """That of all parts of a recorded motion."""
    if recorded.vibration is None:
        parts = [_of_part(recorded, part) for part in recorded.parts]
        recorded.vibration = Vibration(
            max(one.slope for one in parts), max(one.most for one in parts),
            {name: energy for one in parts for name, energy in one.energies.items()})
    return recorded.vibration


def _of_part(recorded: Recorded, part: Part) -> Vibration:
    """Vibrations in a part: what is left of the recorded deformation without its mean."""
    deformation = recorded.deformation(recorded.nodes(part))
    shifts, turns = (one - one.mean(axis=0) for one in deformation[:2])
    size = np.sqrt(sum((np.nan_to_num(one)**2).sum(axis=(1, 2)) for one in (shifts, turns)))
    (nodes, body), = recorded.bodies(part, 1)
    ends = recorded.deformation(nodes)
    u = flat(body, ends.shifts, ends.turns)
    u = u - u.mean(axis=0)
    n = u.shape[1]
    energy = {part.name: float(np.einsum("ni,ij,nj->n", u, body.stiffness[:n, :n], u).mean())}
    if not size.any():
        return Vibration(0.0, 0.0, energy)
    phase = frequency(recorded, shifts) * _age(size, recorded.interval)
    force = strain_force(recorded, part)
    slope = propagated(recorded, part, shifts * phase[:, None, None], turns * phase[:, None, None],
                    force.times(float((phase * size).max() / size.max())))
    return Vibration(slope, MOST * propagated(recorded, part, shifts, turns, force), energy)


def _age(size: NDArray, interval: float) -> NDArray:
    """Time since a vibration was excited, by its sizes: of one that decays its own life at most."""
    squares = size**2
    return np.cumsum(squares) * interval / np.maximum(np.maximum.accumulate(squares), 1e-300)


def strain_force(recorded: Recorded, part: Part) -> Force:
    """Largest change of the elastic forces at the ends of a part, over the recorded run."""
    (nodes, body), = recorded.bodies(part, 1)
    deformation = recorded.deformation(nodes)
    n = len(body.stiffness) - body.modes
    forces = flat(body, deformation.shifts, deformation.turns) @ body.stiffness[:n, :n]
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
