"""Products of the derivatives of a model's forces with vectors, in a state that is held.

    transposed   K^T w, C^T w and M^T w     of weights w of the residuals
    along        K xi + C v + M a           of a motion of the unknowns

and the same of what laws keep from step to step, see `laws`.

Kernels of products (`derive/kernels/products.py`) do this element by element: first PREPARE, once
in a state, then as many products as are asked for. Vectors are those of all coordinates, in global
axes. Dependent positions, at the ends of rigid links, follow the unknowns: see `link_products`.
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
    OK,
    PREPARE,
    TRANSPOSED,
)
from sebody.contract.names import element_name
from sebody.engine.arrays import Arrays
from sebody.engine.evaluate import sum_forces
from sebody.engine.links import pull_back
from sebody.gradients import laws
from sebody.gradients.element_products import PARTS, ROWS, run_element
from sebody.gradients.link_products import add_levers, place_motion, place_weights, pull_back_bars
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.loader import element_kernel_name, load, products_kernel_name
from sebody.model.parts import Superelement
from sebody.runs.first_run import compile_missing
from sebody.runs.simulation import Simulation

CONTINUOUS = element_name("continuous")     # kernel of laws of controllers


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
    def none(cls) -> "Products":
        """Products of no element."""
        none = np.zeros(0, dtype=np.int64)
        return cls(none, none, none, np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((4, 0)),
                   none.reshape(0, laws.BATCH + 1), np.zeros((2, 0)))

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
            size = PARTS * width * width if module is None else whole_vectors(module.KEPT)
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
    system, found = run.system, [""] * run.system.address.size
    for owner, first in run.numbering.forces_at.items():
        b = int(np.searchsorted(system.at_g, first, side="right")) - 1
        found[b] = owner.kernel if isinstance(owner, Superelement) else element_kernel_name(
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
        for k in range(system.count[b]):
            status = run_element(task, b, k, products.at_work[element], system, state, products)
            if status != OK:
                return status
            element += 1
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
    place_weights(system, state, w)
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
        pull_back_bars(system, state, w, bars)


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
        place_motion(system, state, moves)
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
        add_levers(system, state, moves[0], f, False)


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
                turn(system, state, products.vectors, to, system.at_index[b]
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
                turn(system, state, products.vectors, to, system.at_index[b]
                      + k * system.stride[b], True)
            for i in range(width):
                vector[system.g_unknown[first + i]] += products.vectors[to + i]


@compiled
def turn(system, state, vectors, first, at_index, back):
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
