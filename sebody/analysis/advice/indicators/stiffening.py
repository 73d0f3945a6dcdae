"""What stresses and a spin do to the stiffness of bodies that do not know of it."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from sebody.analysis.advice.forms import Form, Part
from sebody.analysis.advice.indicators.carried import carried
from sebody.analysis.advice.indicators.omission import flat
from sebody.analysis.advice.indicators.recorded import Recorded
from sebody.analysis.advice.indicators.vibration import detuned
from sebody.reduction import ReducedBody

SPIN = {"a": 1.0, "b": 1.0, "d": 0.3, "c": 0.0}     # of the square of spin over frequency


def number(recorded: Recorded, part: Part, form: Form) -> float:
    """Relative change of a part's stiffness by stress and spin that a form does not know of.

    By stress the largest eigenvalue of the geometric stiffness against the elastic one; by the
    spin W its square over that of the first frequency with one node held, which options A, B and D
    soften by.
    """
    if form.stiffening:
        return 0.0
    found = 0.0
    for nodes, body in recorded.bodies(part, form.bodies):
        spin = float(np.abs(recorded.spins(nodes)).max())
        found = max(found, _by_stress(recorded, nodes, body)
                    + SPIN[form.inertia] * (spin / _first_frequency(body))**2)
    return found


def stiffening(recorded: Recorded, part: Part, form: Form) -> float:
    """Error from the stiffness that is missing: of the deformation, and of its period."""
    missing = number(recorded, part, form)
    if missing == 0.0:
        return 0.0
    whole = recorded.deformation(recorded.nodes(part))
    return (min(missing, 1.0) * carried(recorded, part, whole.shifts, whole.turns)
            + detuned(recorded, part, min(missing / 2, 1.0)))


def _by_stress(recorded: Recorded, nodes: list, body: ReducedBody) -> float:
    i = body.invariants
    if i is None or not i.resultants:
        return 0.0
    found = recorded.deformation(nodes)
    n = len(body.stiffness) - body.modes
    forces = np.abs(flat(body, found.shifts, found.turns) @ i.E[:n]).max(axis=0)
    elastic = null_space(body.rigid_modes[:n].T)
    K = elastic.T @ body.stiffness[:n, :n] @ elastic
    return sum(force * _ratio(elastic.T @ G[:n, :n] @ elastic, K)
               for force, G in zip(forces, i.Ghat, strict=True))


def _ratio(G: NDArray, K: NDArray) -> float:
    return float(np.abs(eigh(G, K, eigvals_only=True)).max())


def _first_frequency(body: ReducedBody) -> float:
    """Lowest frequency with the coordinates of one node held, of all nodes."""
    n, d = len(body.stiffness) - body.modes, body.coordinates.shape[1]
    owner = np.repeat([*body.position_nodes, *body.rotation_nodes],
                      [d] * len(body.position_nodes)
                      + [3 if d == 3 else 1] * len(body.rotation_nodes))
    lowest = []
    for node in set(owner):
        free = np.flatnonzero(owner[:n] != node)
        K, M = (A[np.ix_(free, free)] for A in (body.stiffness, body.mass))
        lowest.append(float(eigh(K, M, eigvals_only=True)[0]))
    return float(np.sqrt(max(min(lowest), 1e-300)))
