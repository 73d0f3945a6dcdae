"""What corrections tell about the iteration matrix: the kept inverse is updated, or steps are mixed.

A correction s and the change y of the residual that it makes are a secant of the equations: an
inverse B of the present matrix has ``B y = s``, which the kept one misses. Corrections of the same
step and matrix are compared, in the axes they are solved for in.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.kernels.abi import pointer_to
from sebody.kernels.dense import add_outer, rows_times

QUICK = 0.05            # a contraction rate below this needs no acceleration by mixing
ENDING = 0.1            # rate times norm relative to the target below which no update pays
LEAST_TURN = 0.1        # of an update: smallest ``p^T B y`` relative to ``p^T s``


@compiled(forceinline=True)
def update_inverse(system, state, n, norm, target):
    """Update the inverse of a small matrix where that pays; returns the norm of the correction.

    A correction from which the iteration ends by far needs no better matrix.
    """
    last = state.last_correction
    if state.control.secant == 1 and norm * norm > ENDING * target * state.clock.last_norm:
        norm *= _update(system, state, n)
    state.control.secant = 1
    for i in range(n):
        last[i] = state.correction[i]
    return norm


@compiled
def _update(system, state, n):
    """Broyden's update, and the correction by the new inverse; returns what multiplied it.

    ``B + (s - B y) p^T B / (p^T B y)`` maps y to s and changes B the least for ``p = W^2 s``, with
    the weights W of norms (Broyden 1965, Math. Comp. 19). With the residual r after s, corrections
    are ``s = -B (r - y)`` and ``c = B r``. So ``s - B y = -c``, and the new inverse corrects by
    ``c (p^T s) / (p^T B y)``. The multipliers of a regularized matrix are too uncertain for p.
    """
    correction, last, p = state.correction, state.last_correction, state.last_change
    uncertain = float(state.control.regularized)
    along = size = 0.0
    for i in range(n):
        w = state.weight[i]
        p[i] = w * w * last[i] * (1.0 - uncertain * system.is_multiplier[i])
        along += p[i] * correction[i]
        size += p[i] * last[i]
    turn = size - along
    if not turn > LEAST_TURN * size:
        return 1.0
    _add_update(state, n, 1.0 / turn)
    for i in range(n):
        correction[i] *= size / turn
    return size / turn


@compiled(forceinline=True)
def _add_update(state, n, factor):
    """Add ``factor c (p^T B)`` to the inverse B."""
    p, row, inverse = (pointer_to(state.last_change), pointer_to(state.pulled),
                       pointer_to(state.inverse))
    rows_times(inverse, p, row, n, n, state.inverse.shape[1])
    for j in range(n):
        row[j] *= factor
    add_outer(inverse, pointer_to(state.correction), row, n, n)


@compiled
def accelerate(system, state, n, norm):
    """Anderson mixing with the last correction; returns the norm of the mixed correction.

    With matrices of the predicted state the error of a taut chain that rotates decays slowly in
    one direction, which mixing with one correction removes. The multipliers of a regularized
    matrix are too uncertain to be asked.
    """
    correction, last, change = state.correction, state.last_correction, state.last_change
    along = square = mix = 0.0
    regularized = state.control.regularized == 1
    if state.control.secant == 1 and norm > QUICK * state.clock.last_norm:
        for i in range(n):
            if regularized and system.is_multiplier[i] > 0.0:
                continue
            w = state.weight[i]
            difference = (correction[i] - last[i]) * w
            along += difference * correction[i] * w
            square += difference * difference
        if square > 0.0 and abs(along) < square:
            mix = along / square
            norm = np.sqrt(max(norm * norm - along * mix, 0.0))
    state.control.secant = 1
    for i in range(n):
        d = correction[i]
        change[i] = correction[i] = d - mix * (change[i] + d - last[i])
        last[i] = d
    return norm
