"""Dependent positions in products: the operators (20) of `links` and their transposes, compiled."""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.kernels.abi import at, pointer_to


@compiled(forceinline=True)
def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled(forceinline=True)
def _out(R, x):
    """``R x``."""
    return (R[0] * x[0] + R[1] * x[1] + R[2] * x[2], R[3] * x[0] + R[4] * x[1] + R[5] * x[2],
            R[6] * x[0] + R[7] * x[1] + R[8] * x[2])


@compiled(forceinline=True)
def _into(R, x):
    """``R^T x``."""
    return (R[0] * x[0] + R[3] * x[1] + R[6] * x[2], R[1] * x[0] + R[4] * x[1] + R[7] * x[2],
            R[2] * x[0] + R[5] * x[1] + R[8] * x[2])


@compiled(forceinline=True)
def _three(x, first):
    return x[first], x[first + 1], x[first + 2]


@compiled(forceinline=True)
def _arm_in_plane(state, c, r):
    """An arm in global axes, and the same a right angle ahead."""
    co, si = np.cos(state.q[c]), np.sin(state.q[c])
    x, y = co * r[0] - si * r[1], si * r[0] + co * r[1]
    return x, y, -y, x


@compiled
def place_weights(system, state, w):
    """Weights of dependent positions: ``G w``, those of the virtual motion of the unknowns."""
    links, d = system.links, system.dimension[0]
    for k in range(links.dependent.shape[0]):
        x, root = links.dependent[k, 0], links.dependent[k, 1]
        for i in range(d):
            w[x + i] = w[root + i]
        for m in range(links.dependent[k, 2], links.dependent[k, 3]):
            c, r = links.arms[m, 1], links.arm_vectors[m]
            if d == 2:
                _, _, s, t = _arm_in_plane(state, c, r)
                w[x] += w[c] * s
                w[x + 1] += w[c] * t
                continue
            R = at(pointer_to(state.R), 9 * links.arms[m, 0])
            turned = _out(R, _cross(_three(w, c), r))
            for i in range(3):
                w[x + i] += turned[i]


@compiled
def place_motion(system, state, moves):
    """Motion, rates and second rates of dependent positions: (18) and (19) of `links`."""
    links, d = system.links, system.dimension[0]
    xi, v, a = moves[0], moves[1], moves[2]
    for k in range(links.dependent.shape[0]):
        x, root = links.dependent[k, 0], links.dependent[k, 1]
        for i in range(d):
            xi[x + i], v[x + i], a[x + i] = xi[root + i], v[root + i], a[root + i]
        for m in range(links.dependent[k, 2], links.dependent[k, 3]):
            c, r = links.arms[m, 1], links.arm_vectors[m]
            if d == 2:
                px, py, tx, ty = _arm_in_plane(state, c, r)
                rate, second = state.v[c], state.a[c]
                xi[x] += tx * xi[c]
                xi[x + 1] += ty * xi[c]
                v[x] += tx * v[c] - rate * px * xi[c]
                v[x + 1] += ty * v[c] - rate * py * xi[c]
                a[x] += (tx * a[c] - 2.0 * rate * px * v[c]
                         - (second * px + rate * rate * tx) * xi[c])
                a[x + 1] += (ty * a[c] - 2.0 * rate * py * v[c]
                             - (second * py + rate * rate * ty) * xi[c])
                continue
            R = at(pointer_to(state.R), 9 * links.arms[m, 0])
            spin, theta = _three(state.v, c), _three(xi, c)
            s = _cross(spin, r)
            u, dspin = _cross(_three(state.a, c), r), _three(v, c)
            z, ds = _cross(spin, s), _cross(dspin, r)
            of_turn, of_spin = _cross(theta, s), _cross(dspin, s)
            moved = _cross(theta, (u[0] + z[0], u[1] + z[1], u[2] + z[2]))
            again, last = _cross(spin, ds), _cross(_three(a, c), r)
            dx = _out(R, _cross(theta, r))
            dv = _out(R, (ds[0] + of_turn[0], ds[1] + of_turn[1], ds[2] + of_turn[2]))
            da = _out(R, (last[0] + of_spin[0] + again[0] + moved[0],
                          last[1] + of_spin[1] + again[1] + moved[1],
                          last[2] + of_spin[2] + again[2] + moved[2]))
            for i in range(3):
                xi[x + i] += dx[i]
                v[x + i] += dv[i]
                a[x + i] += da[i]


@compiled
def pull_back_bars(system, state, w, bars):
    """Bars of dependent positions, their rates and second rates, given to those of the unknowns."""
    links, d = system.links, system.dimension[0]
    q, v, a = bars[0], bars[1], bars[2]
    for k in range(links.dependent.shape[0]):
        x, root = links.dependent[k, 0], links.dependent[k, 1]
        for i in range(d):
            q[root + i] += q[x + i]
            v[root + i] += v[x + i]
            a[root + i] += a[x + i]
        for m in range(links.dependent[k, 2], links.dependent[k, 3]):
            c, r = links.arms[m, 1], links.arm_vectors[m]
            if d == 2:
                px, py, tx, ty = _arm_in_plane(state, c, r)
                rate, second = state.v[c], state.a[c]
                ahead = tx * a[x] + ty * a[x + 1]
                out = px * a[x] + py * a[x + 1]
                q[c] += (tx * q[x] + ty * q[x + 1] - rate * (px * v[x] + py * v[x + 1])
                         - second * out - rate * rate * ahead)
                v[c] += tx * v[x] + ty * v[x + 1] - 2.0 * rate * out
                a[c] += ahead
                continue
            R = at(pointer_to(state.R), 9 * links.arms[m, 0])
            f, g, e = _into(R, _three(q, x)), _into(R, _three(v, x)), _into(R, _three(a, x))
            spin = _three(state.v, c)
            s, u = _cross(spin, r), _cross(_three(state.a, c), r)
            z = _cross(spin, s)
            of_x, of_v = _cross(r, f), _cross(s, g)
            of_a = _cross((u[0] + z[0], u[1] + z[1], u[2] + z[2]), e)
            rate, one = _cross(r, g), _cross(s, e)
            other, last = _cross(r, _cross(spin, e)), _cross(r, e)
            for i in range(3):
                q[c + i] += of_x[i] + of_v[i] + of_a[i]
                v[c + i] += rate[i] + one[i] - other[i]
                a[c + i] += last[i]
    add_levers(system, state, w, q, True)


@compiled
def add_levers(system, state, x, out, back):
    """Derivative of the moments of constant forces as their arms turn, or its transpose."""
    links, d = system.links, system.dimension[0]
    for k in range(links.dependent.shape[0]):
        at_x = links.dependent[k, 0]
        for m in range(links.dependent[k, 2], links.dependent[k, 3]):
            c, r = links.arms[m, 1], links.arm_vectors[m]
            if d == 2:
                px, py, _, _ = _arm_in_plane(state, c, r)
                out[c] -= (px * state.residual[at_x] + py * state.residual[at_x + 1]) * x[c]
                continue
            R = at(pointer_to(state.R), 9 * links.arms[m, 0])
            f = _into(R, _three(state.residual, at_x))
            own = _three(x, c)
            turned = _cross(f, _cross(r, own)) if back else _cross(r, _cross(f, own))
            for i in range(3):
                out[c + i] += turned[i]
