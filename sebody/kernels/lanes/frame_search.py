"""Searches for frames in lanes: they go on until every lane has its frame."""

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import every, some, spread, where
from sebody.kernels import frame_search
from sebody.kernels.lanes.rotations import NONE
from sebody.kernels.rotations import relative_log, relative_rotations, rotated


@in_lanes_of(frame_search.converged_mean)
def converged_mean(count, nodes, alpha, R, frame, psi):
    """See `frame_search.converged_mean`; 0 always, no number where there is no frame."""
    if count == 2:
        _mean_of_two(nodes, alpha, R, frame, psi)
        return 0
    left = spread(0.0) == 0.0
    for _ in range(30):
        relative_rotations(count, nodes, R, frame, psi)
        x = y = z = spread(0.0)
        for j in range(count):
            x += alpha[j] * psi[3 * j]
            y += alpha[j] * psi[3 * j + 1]
            z += alpha[j] * psi[3 * j + 2]
        left = left & ~(x * x + y * y + z * z < 1e-30)
        if not some(left):
            return 0
        x, y, z = frame_search.mean_step(count, alpha, psi, x, y, z)
        _rotate_some(left, frame, x, y, z)
        left = left & ~(x * x + y * y + z * z < 1e-16)
    relative_rotations(count, nodes, R, frame, psi)
    for k in range(3 * count):
        psi[k] = where(left, spread(NONE), psi[k])
    return 0


@compiled
def _rotate_some(chosen, frame, x, y, z):
    a, b, c, d, e, f, g, h, i = rotated(frame, 0, x, y, z)
    frame[0], frame[1], frame[2] = (where(chosen, a, frame[0]), where(chosen, b, frame[1]),
                                    where(chosen, c, frame[2]))
    frame[3], frame[4], frame[5] = (where(chosen, d, frame[3]), where(chosen, e, frame[4]),
                                    where(chosen, f, frame[5]))
    frame[6], frame[7], frame[8] = (where(chosen, g, frame[6]), where(chosen, h, frame[7]),
                                    where(chosen, i, frame[8]))


@compiled
def _mean_of_two(nodes, alpha, R, frame, psi):
    """The closed form; no number in lanes where it may not be the mean."""
    x, y, z, cosine = relative_log(R, 9 * nodes[0], R, 9 * nodes[1])
    p, q, r = alpha[1] * x, alpha[1] * y, alpha[1] * z
    a, b, c, d, e, f, g, h, i = rotated(R, 9 * nodes[0], p, q, r)
    near = a * frame[0] + b * frame[1] + c * frame[2] + d * frame[3] + e * frame[4] + f * frame[5]
    near = near + g * frame[6] + h * frame[7] + i * frame[8]
    found = (cosine > 0.0) & ~(near < 1.0)
    frame[0], frame[1], frame[2] = a, b, c
    frame[3], frame[4], frame[5] = d, e, f
    frame[6], frame[7], frame[8] = g, h, i
    psi[0], psi[1], psi[2] = -p, -q, -r
    psi[3], psi[4], psi[5] = alpha[0] * x, alpha[0] * y, alpha[0] * z
    if not every(found):
        for k in range(6):
            psi[k] = where(found, psi[k], spread(NONE))
