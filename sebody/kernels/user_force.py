"""Kernel of forces by a function of the user, with the signature of every other kernel.

It is written by hand, since there is nothing to derive: the forces come from the function, the
matrix from central differences of these forces.
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from sebody.compiler.decorators import compiled, kernel_function
from sebody.contract.layout import AT_PORT, C_DAMPING, C_STIFFNESS, ENERGY, HEADER, POWERS, TANGENT
from sebody.kernels.abi import at

PLANAR = False
N_POSITIONS = None      # any number
N_ROTATIONS = 0
CONSTANTS = ()
MULTIPLIERS = 0
READS = 0
MEMORY = ()
WIDTH = None            # any number
INERTIAL = False
POWER = True
DRIVEN = False
WORK_ROWS = 4
OPERATIONS = {"residual": (0, 0, 0, 0), "column": (0, 0, 0, 0)}
STEP = 1e-6     # of differences, relative to the coordinate and at least absolute


@intrinsic
def _call(typingctx, address, n, t, x, v, force):
    def codegen(context, builder, sig, args):
        word, double = ir.IntType(64), ir.DoubleType()
        kind = ir.FunctionType(ir.VoidType(), [word, double, *[a.type for a in args[3:]]])
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), args[1:])
        return context.get_dummy_value()
    return types.void(types.int64, types.int64, types.float64, x, v, force), codegen


@compiled(fastmath=False)
def _evaluate(address, n, t, x, v, force):
    """Set the forces; returns their power."""
    for i in range(n):
        force[i] = 0.0
    _call(address, n, t, x, v, force)
    power = 0.0
    for i in range(n):
        power += force[i]*v[i]
    return power


@kernel_function
def kernel(task, count, stride, width, index, constants, q, R, v, a, references, frames, T, loads,
           coefficients, forces, matrices, work, energies):
    n = width
    x, rate, force, other = work, at(work, n), at(work, 2*n), at(work, 3*n)
    for element in range(count):
        row = at(index, element*stride)
        unknowns, port = at(row, HEADER), row[AT_PORT]
        address, t = unknowns[n], loads[3*port]
        for i in range(n):
            x[i], rate[i] = q[unknowns[i]], v[unknowns[i]]
        g = at(forces, element*n)
        power = _evaluate(address, n, t, x, rate, force)
        for i in range(n):
            g[i] = -force[i]
        if task == ENERGY:
            energies[POWERS + port] = power
        if task == TANGENT:
            J = at(matrices, element*n*n)
            for column in range(n):
                for i in range(n):
                    J[i*n + column] = 0.0
                for values, c in ((x, coefficients[C_STIFFNESS]), (rate, coefficients[C_DAMPING])):
                    value = values[column]
                    h = STEP*max(1.0, abs(value))
                    values[column] = value + h
                    _evaluate(address, n, t, x, rate, force)
                    values[column] = value - h
                    _evaluate(address, n, t, x, rate, other)
                    values[column] = value
                    for i in range(n):
                        J[i*n + column] -= c*(force[i] - other[i])/(2.0*h)
    return 0
