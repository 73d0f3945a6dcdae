"""Products of one element with the derivatives of its forces, by its kernel.

Laws of continuous controllers, whose kernel is written by hand, have their matrices made in place
of a kernel of products.
"""

from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    ALONG,
    C_CONSTRAINT,
    C_DAMPING,
    C_MASS,
    C_STIFFNESS,
    OK,
    PREPARE,
    TANGENT,
)
from sebody.kernels.abi import Arguments, at, call_kernel, pointer_to

ROWS = 4                    # vectors of an element: forces or weights, motion, rates, second rates
PARTS = 3                   # matrices that are made: stiffness, damping, mass


@compiled
def run_element(task, b, k, at_work, system, state, products):
    """A task for element k of batch b, whose scratch memory begins at `at_work`; a status."""
    stride, width = system.stride[b], system.width[b]
    first = system.at_g[b] + k * width
    vectors = at(pointer_to(products.vectors), ROWS * first)
    work = at(pointer_to(products.work), at_work)
    if products.address[b] == 0:
        return _by_matrices(task, b, k, system, state, vectors, work)
    return call_kernel(
        products.address[b], task, 1, stride, width,
        Arguments(index=at(pointer_to(system.index), system.at_index[b] + k * stride),
                  constants=system.constants, q=state.q, R=state.R, v=state.v, a=state.a,
                  references=state.frames_old, frames=state.frames, T=state.T, loads=state.loads,
                  coefficients=state.coefficients, forces=at(pointer_to(state.g), first),
                  matrices=vectors, work=work, energies=state.energy))


@compiled
def _by_matrices(task, b, k, system, state, vectors, matrices):
    """The same of an element whose matrices K, C and M are made."""
    if task == PREPARE:
        return _make(b, k, system, state, matrices)
    width = system.width[b]
    size = width * width
    for i in range(width):
        if task == ALONG:
            vectors[i] = 0.0
        for part in range(PARTS):
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
def _make(b, k, system, state, matrices):
    """The matrices of an element; a status."""
    width, stride, c = system.width[b], system.stride[b], state.coefficients
    size = width * width
    for i in range(state.T.size):
        state.T[i] = 1.0 if i % 9 % 4 == 0 else 0.0
    for part in range(PARTS):
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
