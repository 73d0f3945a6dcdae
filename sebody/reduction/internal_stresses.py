"""Kinds of internal modes by their stresses: some stretch, some have none, some only loads stress.

Of internal modes, shapes of unit strain energy, the geometric stiffness on the lowest vibrations of
the free body is known, and how far each takes part in these. A bow whose ends are interfaces is
stretched by its own bending modes, in all of which the tension is the same: one turn of the modes
has it, the others have none.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.reduction.clamped import canonical_turn

# Modes stretch if their part in a low vibration, which moves the body by a tenth of its size or
# turns it by 0.1 rad, changes the stiffness of low vibrations by more than this part of it.
_STRETCHING = 0.75
_CLEAR = 0.003  # of the largest geometric stiffness of one strain energy: less is none


def divide(G: NDArray, amplitudes: NDArray, shapes: NDArray) -> tuple[NDArray, NDArray]:
    """Turns (m, a) and (m, b) of internal modes: those that stretch, and they with those of none.

    If none stretches, both are empty: what only loads stress, and moments inside, are then left to
    the load modes.

    Parameters
    ----------
    G : (c + m, l, l)
        Geometric stiffness of unit strain energies on l vibrations of unit stiffness: of c boundary
        motions, then of the internal modes.
    amplitudes : (m, l)
        Of the internal modes in each vibration, as large as it may be.
    shapes : (n_dofs, m)
        Internal modes of unit strain energy.
    """
    count = shapes.shape[1]
    if count == 0:
        return np.zeros((0, 0)), np.zeros((0, 0))
    flat = G.reshape(len(G), -1)
    internal = flat[-count:]
    squares, turn = np.linalg.eigh(internal @ internal.T)
    sizes = np.sqrt(squares.clip(0.0))
    stressed = sizes > _CLEAR * np.linalg.norm(flat, 2)
    turn[:, stressed] @= canonical_turn(sizes[stressed], shapes @ turn[:, stressed])
    stretching = sizes * np.linalg.norm(turn.T @ amplitudes, axis=1) > _STRETCHING
    if not stretching.any():
        return np.zeros((count, 0)), np.zeros((count, 0))
    return turn[:, stretching], turn[:, stretching | ~stressed]
