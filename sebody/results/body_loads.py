"""Amplitudes of the loads on a superelement itself, from the forces of their elements."""

import numpy as np
from numpy.typing import NDArray

from sebody.model.parts import Superelement
from sebody.results.motion import BodyMotion
from sebody.results.recording import Recording


def load_amplitudes(recording: Recording, body: Superelement, motion: BodyMotion) -> NDArray:
    """Amplitudes in all recorded states, (n, loads), in the order of the body's loads.

    A load ``P = Phi^T p`` gives the residual ``-a R_0 P_i`` at positions and ``-a P_k`` at modes:
    projected on P this is the amplitude a, also of a result that has lost its functions. Columns of
    a series have amplitudes of least squares.
    """
    names = list(body.reduced.loads)
    amplitudes = np.zeros((len(recording.rows), len(names)))
    for element in recording.model.loads:
        if element.body is not body:
            continue
        P = np.asarray(element.constants["P"])
        series = element.series is not None
        first = recording.numbering.forces_at[element]
        forces = recording.forces.elements[:, first:first + len(P)]
        count, D = len(body.positions), motion.origin.shape[1]
        local = forces[:, :count * D].reshape(-1, count, D) @ motion.rotation
        modes = len(P) - body.reduced.modes
        whole = np.hstack([local.reshape(-1, count * D), forces[:, modes:]])
        vectors = np.transpose(element.constants["columns"]) if series else P[None]
        known = np.hstack([vectors[:, :count * D], vectors[:, modes:]])
        own = -whole @ np.linalg.pinv(known)
        for vector, amplitude in zip(vectors, own.T, strict=True):
            k = next((k for k, name in enumerate(names)
                      if np.array_equal(body.reduced.loads[name], vector)), None)
            if k is not None:       # others are on coordinates alone
                amplitudes[:, k] += amplitude
    return amplitudes
