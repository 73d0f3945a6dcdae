"""The one signature of every compiled kernel, and how the time loop calls it.

A kernel is reached through its address: a call costs a few nanoseconds and the loop's cache does
not depend on which kernels a scene uses.

===============  =================================================================================
argument         meaning
===============  =================================================================================
task             RESIDUAL, TANGENT (residual and matrix), ENERGY, or VELOCITY and ACCELERATION:
                 constraints differentiated in time
count            number of elements in the batch
stride           length of an index row
width            number n of unknowns of an element (coordinates, then multipliers)
index            rows: offset into constants, frame, item, ids of rotations, ids of unknowns; an
                 item is something that does work: load, damper, drive
constants        one flat row per body type; matrices by padded columns, see `padded`
q, R             coordinates (positions, modes, multipliers; rotations' step increments), rotations
v, a             velocities and accelerations of the coordinates
reference        frames of the last converged step, (frames, 9)
frames           frames of the current iterate, (frames, 9); superelements write theirs
T                tangent operators of the step increments of rotations, (rotations, 9)
loads            of every item its amplitude now, and the two rates of that
coefficients     c_mass, c_rate, c_place, c_geo, c_constraint of the matrix; gravity (3)
g, J             element blocks: forces (count, n), matrices (count, n, n)
work             scratch memory, WORK_ROWS padded rows
energy           sums: kinetic, strain, momentum (3), moment of momentum (3), potential; then the
                 power of every item
===============  =================================================================================

``J = c_mass dG/da + c_rate dG/dv + c_place dG/dq T``: rotations vary multiplicatively, and T
turns the variation of the step's increment into that of the rotation.
"""

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

RESIDUAL, TANGENT, ENERGY, VELOCITY, ACCELERATION = range(5)
HEADER = 3          # integers of an index row before the ids
LANES = 4           # columns of a body's matrices are padded to whole vectors of so many
POTENTIAL, POWERS = 8, 9      # among the energies; powers are the last


@njit(cache=True)
def padded(n):
    """Length of a column of n numbers in a kernel's matrices: whole vectors."""
    return (n + LANES - 1) // LANES * LANES


@intrinsic
def at(typingctx, pointer, first):
    """The pointer to an element: an array from `first` on, without bounds or negative indices."""
    def codegen(context, builder, sig, args):
        return builder.gep(args[0], [args[1]])

    return pointer(pointer, types.int64), codegen


@intrinsic
def pointer_to(typingctx, array):
    """The pointer to the data of an array."""
    def codegen(context, builder, sig, args):
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return types.CPointer(array.dtype)(array), codegen


_floats = types.CPointer(types.float64)
_ints = types.CPointer(types.int64)
SIGNATURE = types.int64(types.int64, types.int64, types.int64, types.int64, _ints,
                        *(_floats,) * 14)


@intrinsic
def call_kernel(typingctx, address, task, count, stride, width, arrays):
    """Call the kernel at an address with a tuple of arrays or pointers."""
    signature = types.int64(address, task, count, stride, width, arrays)

    def codegen(context, builder, sig, args):
        word = ir.IntType(64)
        scalars = list(args[1:5])
        values = [builder.extract_value(args[5], k) for k in range(len(sig.args[5]))]
        pointers = [context.make_array(kind)(context, builder, value).data
                    if isinstance(kind, types.Array) else value
                    for kind, value in zip(sig.args[5], values, strict=True)]
        function = ir.FunctionType(word, [word] * 4 + [p.type for p in pointers])
        return builder.call(builder.inttoptr(args[0], function.as_pointer()),
                            scalars + pointers)

    return signature, codegen
