"""Products of the derivatives of a model's forces with vectors, in a state that is held.

    transposed   K^T w, C^T w and M^T w     of weights w of the residuals
    along        K xi + C v + M a           of a motion of the unknowns

and the same of what laws keep from step to step, see `laws`.

Kernels of products (`derive/kernels/products.py`) do this element by element: first PREPARE, once
in a state, then as many products as are asked for. Laws of continuous controllers, whose kernel is
written by hand, have their matrices made in its place. Vectors are those of all coordinates, in
global axes. Dependent positions, at the ends of rigid links, follow the unknowns by the operators
(20) of `links`, which are written out here, with their transposes.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.axes import in_frames
from sebody.compiler.decorators import compiled
from sebody.contract.counts import scratch_size, whole_vectors
from sebody.contract.layout import (
    ALONG,
    AT_FRAME,
    AT_POSITIONS,
    AT_ROTATIONS,
    C_CONSTRAINT,
    C_DAMPING,
    C_MASS,
    C_STIFFNESS,
    OK,
    PREPARE,
    TANGENT,
    TRANSPOSED,
)
from sebody.contract.names import element_name
from sebody.engine.arrays import Arrays
from sebody.engine.evaluate import sum_forces
from sebody.engine.links import pull_back
from sebody.gradients import laws
from sebody.gradients.laws import ROWS
from sebody.kernels.abi import Arguments, at, call_kernel, pointer_to
from sebody.kernels.loader import element_kernel_name, load, products_kernel_name
from sebody.runs.first_run import compile_missing
from sebody.runs.simulation import Simulation

CONTINUOUS = element_name("continuous")     # kernel of laws of controllers
PARTS = "stiffness", "damping", "mass"      # matrices that are made


@dataclass(frozen=True, eq=False)
class Products(Arrays):
    """Kernels of products of a model, and what they work on.

    ==========  ====================================================================================
    address     (batches,) of the kernel; 0 where matrices are made
    turned      (batches,) 1 where vectors of elements are in axes of frames
    at_work     (elements,) where the scratch memory of each begins, which it keeps in a state
    work        this memory
    vectors     ROWS of each element
    forces      (coordinates,) weights, or products with motions
    motion      (4, coordinates) motion, rates, second rates and increments of rotations, or
                products with weights
    laws        (laws, 11) see `laws`
    kept        (2, numbers) of all laws: changes or bars of what the step before has left; changes
                or weights of what the step leaves
    ==========  ====================================================================================
    """

    address: NDArray
    turned: NDArray
    at_work: NDArray
    work: NDArray
    vectors: NDArray
    forces: NDArray
    motion: NDArray
    laws: NDArray
    kept: NDArray

    @classmethod
    def of(cls, run: Simulation) -> "Products | None":
        """Those of a model; None if it has an element without them."""
        system = run.system
        kernels = _kernels(run)
        names = [None if kernel == CONTINUOUS else products_kernel_name(kernel) or ""
                 for kernel in kernels]
        if "" in names:
            return None
        compile_missing([name for name in names if name])
        modules, sizes = [None if name is None else load(name) for name in names], []
        for b, module in enumerate(modules):
            rotations, width = (int(system.index[system.at_index[b] + AT_ROTATIONS]),
                                int(system.width[b]))
            size = len(PARTS) * width * width if module is None else whole_vectors(module.KEPT)
            if module is not None and module.WORK_ROWS:
                size += scratch_size(module.WORK_ROWS, getattr(module, "WORK_SQUARES", 0), width,
                                     rotations)
            sizes += [size] * int(system.count[b])
        ends, total = np.cumsum(sizes), run.numbering.total
        at_work = (ends - sizes).astype(np.int64)
        of_laws = laws.places_of(system, modules, at_work)
        return cls(np.array([module.kernel.address if module else 0 for module in modules]),
                   in_frames(run.model, run.numbering, system).astype(np.int64),
                   at_work, np.zeros(max(int(ends[-1]), 1)),
                   np.zeros(ROWS * int(system.at_g[-1])), np.zeros(total), np.zeros((4, total)),
                   of_laws, np.zeros((2, int(of_laws[:, laws.COUNT].sum()))))


def _kernels(run: Simulation) -> list[str]:
    """Names of the kernels of all batches."""
    model, system, found = run.model, run.system, [""] * run.system.address.size
    for owner, first in run.numbering.forces_at.items():
        b = int(np.searchsorted(system.at_g, first, side="right")) - 1
        found[b] = owner.kernel if owner in model.bodies.values() else element_kernel_name(
            owner.kind)
    return found


@compiled
def prepare(system, state, products):
    """Get ready for products in the present state, its forces in `State.residual`; a status."""
    status = _run(PREPARE, system, state, products)
    if status == OK and system.links.dependent.shape[0] > 0:
        sum_forces(system, state, state.residual)
    return status


@compiled
def _run(task, system, state, products):
    """All elements, one after the other; the status of the first that fails."""
    element = 0
    for b in range(system.address.size):
        stride, width = system.stride[b], system.width[b]
        for k in range(system.count[b]):
            first = system.at_g[b] + k * width
            if products.address[b] == 0:
                status = _by_matrices(task, b, k, system, state, at(
                    pointer_to(products.vectors), ROWS * first), at(
                        pointer_to(products.work), products.at_work[element]))
                if status != OK:
                    return status
                element += 1
                continue
            status = call_kernel(
                products.address[b], task, 1, stride, width,
                Arguments(index=at(pointer_to(system.index), system.at_index[b] + k * stride),
                          constants=system.constants, q=state.q, R=state.R, v=state.v, a=state.a,
                          references=state.frames_old, frames=state.frames, T=state.T,
                          loads=state.loads, coefficients=state.coefficients,
                          forces=at(pointer_to(state.g), first),
                          matrices=at(pointer_to(products.vectors), ROWS * first),
                          work=at(pointer_to(products.work), products.at_work[element]),
                          energies=state.energy))
            if status != OK:
                return status
            element += 1
    return OK


@compiled
def _by_matrices(task, b, k, system, state, vectors, matrices):
    """The same of an element whose matrices K, C and M are made."""
    width, stride, c = system.width[b], system.stride[b], state.coefficients
    size = width * width
    if task == PREPARE:
        for i in range(state.T.size):
            state.T[i] = 1.0 if i % 9 % 4 == 0 else 0.0
        for part in range(3):
            c[C_STIFFNESS] = c[C_CONSTRAINT] = 1.0 * (part == 0)
            c[C_DAMPING], c[C_MASS] = 1.0 * (part == 1), 1.0 * (part == 2)
            status = call_kernel(
                system.address[b], TANGENT, 1, stride, width,
                Arguments(index=at(pointer_to(system.index), system.at_index[b] + k * stride),
                          constants=system.constants, q=state.q, R=state.R, v=state.v, a=state.a,
                          references=state.frames_old, frames=state.frames, T=state.T,
                          loads=state.loads, coefficients=c,
                          forces=at(pointer_to(state.g), system.at_g[b] + k * width),
                          matrices=at(matrices, part * size), work=state.work,
                          energies=state.energy))
            if status != OK:
                return status
        return OK
    for i in range(width):
        if task == ALONG:
            vectors[i] = 0.0
        for part in range(3):
            total, row = 0.0, (part + 1) * width
            for j in range(width):
                if task == ALONG:
                    total += matrices[part * size + i * width + j] * vectors[row + j]
                else:
                    total += matrices[part * size + j * width + i] * vectors[j]
            if task == ALONG:
                vectors[i] += total
            else:
                vectors[row + i] = total
    return OK


@compiled
def transposed(system, state, products, free):
    """From `forces` of the unknowns to `motion`: ``K^T w``, ``C^T w`` and ``M^T w``.

    The second row of `kept` has weights, too, and its first row gets what they give. The state is
    prepared. What is behind the unknowns in `motion` has no meaning.
    """
    w, bars = products.forces, products.motion
    for i in range(free, w.size):
        w[i] = 0.0
    _place(system, state, w)
    _take(system, state, products, w, 0)
    laws.give(system, products, True)
    _run(TRANSPOSED, system, state, products)
    for r in range(4):
        for i in range(w.size):
            bars[r, i] = 0.0
        if r < 3:
            _give(system, state, products, bars[r], r + 1)
    laws.take(system, products, True)
    if system.links.dependent.shape[0] > 0:
        _pull_back(system, state, w, bars)


@compiled
def along(system, state, products, free):
    """From `motion` of the unknowns to `forces`: ``K xi + C v + M a``. The state is prepared.

    The same of `kept`, from the first row to the second one, and of increments in `motion`.
    """
    f, moves = products.forces, products.motion
    for r in range(4):
        for i in range(free, f.size):
            moves[r, i] = 0.0
    if system.links.dependent.shape[0] > 0:
        _place_moved(system, state, moves)
    for r in range(3):
        _take(system, state, products, moves[r], r + 1)
    laws.give(system, products, False)
    _run(ALONG, system, state, products)
    laws.take(system, products, False)
    for i in range(f.size):
        f[i] = 0.0
    _give(system, state, products, f, 0)
    if system.links.dependent.shape[0] > 0:
        pull_back(system.links, state.q, state.R, state.turns, f)
        _add_levers(system, state, moves[0], f, False)


@compiled
def _take(system, state, products, vector, row):
    """A row of all elements from a vector of all coordinates."""
    for b in range(system.address.size):
        width = system.width[b]
        for k in range(system.count[b]):
            first = system.at_g[b] + k * width
            to = ROWS * first + row * width
            for i in range(width):
                products.vectors[to + i] = vector[system.g_unknown[first + i]]
            if products.turned[b]:
                _turn(system, state, products.vectors, to, system.at_index[b]
                      + k * system.stride[b], False)


@compiled
def _give(system, state, products, vector, row):
    """Add a row of all elements to a vector of all coordinates."""
    for b in range(system.address.size):
        width = system.width[b]
        for k in range(system.count[b]):
            first = system.at_g[b] + k * width
            to = ROWS * first + row * width
            if products.turned[b]:
                _turn(system, state, products.vectors, to, system.at_index[b]
                      + k * system.stride[b], True)
            for i in range(width):
                vector[system.g_unknown[first + i]] += products.vectors[to + i]


@compiled
def _turn(system, state, vectors, first, at_index, back):
    """Positions of an element into axes of its frame, or back to global ones."""
    R = at(pointer_to(state.frames), 9 * system.index[at_index + AT_FRAME])
    p = at(pointer_to(vectors), first)
    if system.dimension[0] == 2:        # in a plane the frame holds cosine and sine
        c, s = R[0], -R[3] if back else R[3]
        for k in range(system.index[at_index + AT_POSITIONS]):
            x, y = p[2 * k], p[2 * k + 1]
            p[2 * k], p[2 * k + 1] = c * x + s * y, c * y - s * x
        return
    for k in range(system.index[at_index + AT_POSITIONS]):
        x, y, z = p[3 * k], p[3 * k + 1], p[3 * k + 2]
        for i in range(3):
            p[3 * k + i] = (R[3 * i] * x + R[3 * i + 1] * y + R[3 * i + 2] * z if back else
                            R[i] * x + R[3 + i] * y + R[6 + i] * z)


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
def _place(system, state, w):
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
def _place_moved(system, state, moves):
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
def _pull_back(system, state, w, bars):
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
    _add_levers(system, state, w, q, True)


@compiled
def _add_levers(system, state, x, out, back):
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
