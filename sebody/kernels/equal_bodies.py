"""Kernel of many equal bodies: their own kernel, compiled for lanes, gets eight of them at a time.

It is called as that kernel is, for the same rows, which tell where both are. Numbers of eight
bodies are gathered, and forces, frames and matrices put back. There is one row of constants for all
lanes: bodies have the same constants, but for how they are oriented at the start; see
`sebody.kernels.lanes.turned_bodies`. Up to `ALONE` bodies left over are evaluated one by one;
more are filled up to eight with repeats of the last. If one of eight has no frame, they and all
that follow are evaluated one by one: their own kernel tells why. In other tasks all bodies are
evaluated one by one.
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from sebody.compiler.decorators import compiled, kernel_function
from sebody.compiler.inside.lanes import as_lanes
from sebody.contract.counts import MEMBERS
from sebody.contract.equal_row import (
    ALIGNED,
    ANGLE,
    DIMENSION,
    FACTORS,
    IN_COMMON,
    IN_LANES,
    NOT_TURNED,
    OWN,
    TURNED,
)
from sebody.contract.layout import (
    AT_CONSTANTS,
    AT_FRAME,
    AT_POSITIONS,
    AT_ROTATIONS,
    HEADER,
    OK,
    RESIDUAL,
    TANGENT,
)
from sebody.kernels.abi import Arguments, at, call_kernel
from sebody.kernels.lanes.turned_bodies import (
    turn_back,
    turn_coordinates,
    turn_frame_back,
    turn_matrix_back,
    turn_operators,
    turn_rotations,
)

ALONE = 2       # bodies left over that take less time one by one


@intrinsic
def _aligned(typingctx, pointer):
    """The first place of a cache line behind a pointer."""
    def codegen(context, builder, sig, args):
        word = ir.IntType(64)
        size = 8 * ALIGNED
        place = builder.add(builder.ptrtoint(args[0], word), word(size - 1))
        return builder.inttoptr(builder.and_(place, word(-size)), args[0].type)
    return pointer(pointer), codegen


@intrinsic
def _whole_numbers(typingctx, pointer):
    """A pointer to floats as one to whole numbers."""
    def codegen(context, builder, sig, args):
        return builder.bitcast(args[0], ir.IntType(64).as_pointer())
    return types.CPointer(types.int64)(pointer), codegen


@compiled(forceinline=True)
def _gather(numbers, size, unit, places, step, last, to):
    """Stretches of `size` numbers, where `places` tells in units of so many, of eight bodies."""
    for member in range(MEMBERS):
        own = at(numbers, unit * places[step * min(member, last)])
        for i in range(size):
            to[MEMBERS * i + member] = own[i]


@compiled(forceinline=True)
def _gather_coordinates(q, v, a, width, unknowns, step, last, xs, vs, accelerations):
    """Coordinates and their rates of eight bodies."""
    for member in range(MEMBERS):
        places = at(unknowns, step * min(member, last))
        for k in range(width):
            i, to = places[k], MEMBERS * k + member
            xs[to], vs[to], accelerations[to] = q[i], v[i], a[i]


@compiled(forceinline=True)
def _set_row(index, stride, rotations, width, row):
    """The index row of gathered bodies, whose numbers follow one another."""
    for k in range(HEADER):
        row[k] = index[k]
    row[AT_CONSTANTS] = index[stride - IN_COMMON]
    row[AT_FRAME] = 0
    for k in range(rotations):
        row[HEADER + k] = k
    for k in range(width):
        row[HEADER + rotations + k] = k


@compiled(forceinline=True)
def _put(given, size, count, numbers, to_next):
    """Forces or matrices of so many bodies."""
    for member in range(count):
        own = at(numbers, to_next * member)
        for i in range(size):
            own[i] = given[MEMBERS * i + member]


@compiled(forceinline=True)
def _put_frames(given, count, index, stride, frames):
    """Frames of so many bodies."""
    for member in range(count):
        own = at(frames, 9 * index[stride * member + AT_FRAME])
        for i in range(9):
            own[i] = given[MEMBERS * i + member]


@compiled(forceinline=True)
def _are_finite(given, size):
    """Tell if numbers of eight bodies are finite; sums of each, which need not wait for others."""
    nothing = 0.0
    for member in range(MEMBERS):
        own = 0.0
        for k in range(size):
            own += 0.0 * given[MEMBERS * k + member]
        nothing += own
    return nothing == 0.0


@compiled(forceinline=True)
def _turn(turn, first, rotations, rotated, tangent, xs, vs, accelerations, Rs, Ts, frame,
          reference):
    """Numbers of eight bodies to axes in which their constants are the same.

    Parameters
    ----------
    first : int
        First coordinate of the rotations.
    rotated : int
        Rotation matrices; none in a plane, where angles are coordinates.
    """
    turn_rotations(turn, 1, frame)
    turn_rotations(turn, 1, reference)
    turn_rotations(turn, rotated, Rs)
    for x in (xs, vs, accelerations):
        turn_coordinates(turn, rotated, at(x, first))
    if tangent:
        turn_operators(turn, rotated, Ts)
    if rotated == 0:
        for k in range(first, first + rotations):
            xs[k] += turn[ANGLE]


@compiled(forceinline=True)
def _turn_back(turn, dimension, positions, rotated, tangent, width, gs, Js, frame):
    """The results of eight bodies, in their own axes."""
    turn_back(turn, rotated, at(gs, dimension * positions))
    turn_frame_back(turn, frame)
    if tangent:
        turn_matrix_back(turn, dimension, width, positions + rotated, Js)


@kernel_function
def kernel(task, count, stride, width, index, constants, q, R, v, a, references, frames, T, loads,
           coefficients, forces, matrices, work, energies):
    own, in_lanes = index[stride - OWN], index[stride - IN_LANES]
    positions, rotations, squares = index[AT_POSITIONS], index[AT_ROTATIONS], width * width
    dimension = index[stride - DIMENSION]
    rotated = rotations if dimension == 3 else 0        # in a plane angles are coordinates
    turned, tangent = index[stride - TURNED] != NOT_TURNED, task == TANGENT
    # numbers of eight bodies, their index row, scratch memory
    xs = _aligned(work)
    vs, accelerations, gs = (at(xs, MEMBERS * width), at(xs, 2 * MEMBERS * width),
                             at(xs, 3 * MEMBERS * width))
    Rs = at(xs, 4 * MEMBERS * width)
    Ts = at(Rs, 9 * MEMBERS * rotated)
    frame = at(Ts, 9 * MEMBERS * rotated)
    reference = at(frame, 9 * MEMBERS)
    turn = at(reference, 9 * MEMBERS)
    factors = at(turn, MEMBERS * (ANGLE + 1))
    Js = at(factors, MEMBERS * FACTORS)
    row = _whole_numbers(at(Js, MEMBERS * squares))
    scratch = _aligned(at(Js, MEMBERS * squares + HEADER + rotations + width))
    _set_row(index, stride, rotations, width, row)
    for k in range(FACTORS):
        for member in range(MEMBERS):
            factors[MEMBERS * k + member] = coefficients[k]
    done = 0
    while done < count and (task == RESIDUAL or tangent):
        left = count - done
        if left <= ALONE:
            break
        begin = at(index, done * stride)
        last = min(left, MEMBERS) - 1
        _gather_coordinates(q, v, a, width, at(begin, HEADER + rotations), stride, last,
                            xs, vs, accelerations)
        for k in range(rotated):
            place = at(begin, HEADER + k)
            _gather(R, 9, 9, place, stride, last, at(Rs, 9 * MEMBERS * k))
            if tangent:
                _gather(T, 9, 9, place, stride, last, at(Ts, 9 * MEMBERS * k))
        _gather(frames, 9, 9, at(begin, AT_FRAME), stride, last, frame)
        _gather(references, 9, 9, at(begin, AT_FRAME), stride, last, reference)
        if turned:
            _gather(constants, ANGLE + 1, 1, at(begin, stride - TURNED), stride, last, turn)
            _turn(as_lanes(turn), dimension * positions, rotations, rotated, tangent,
                  as_lanes(xs), as_lanes(vs), as_lanes(accelerations), as_lanes(Rs), as_lanes(Ts),
                  as_lanes(frame), as_lanes(reference))
        call_kernel(in_lanes, task, 1, stride, width, Arguments(
            index=row, constants=constants, q=xs, R=Rs, v=vs, a=accelerations,
            references=reference, frames=frame, T=Ts, loads=loads, coefficients=factors,
            forces=gs, matrices=Js, work=scratch, energies=energies))
        if not _are_finite(gs, width):
            break
        if turned:
            _turn_back(as_lanes(turn), dimension, positions, rotated, tangent, width, as_lanes(gs),
                       as_lanes(Js), as_lanes(frame))
        _put(gs, width, last + 1, at(forces, width * done), width)
        _put_frames(frame, last + 1, begin, stride, frames)
        if tangent:
            _put(Js, squares, last + 1, at(matrices, squares * done), squares)
        done += last + 1
    if done == count:
        return OK
    return call_kernel(own, task, count - done, stride, width, Arguments(
        index=at(index, done * stride), constants=constants, q=q, R=R, v=v, a=a,
        references=references, frames=frames, T=T, loads=loads, coefficients=coefficients,
        forces=at(forces, width * done), matrices=at(matrices, squares * done), work=work,
        energies=energies))
