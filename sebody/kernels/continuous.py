"""Kernel of continuous controllers: a law of users in the equations of motion.

It is written by hand, since there is nothing to derive. Before the actuators are evaluated it sets
their amplitudes to ``u(t, y, x)``, y what is measured in the iterate and x the states of the law.
States are velocities of hidden coordinates, so the scheme integrates them:

    mass (x_i' - f_i(t, y, x)) = 0

with a mass that makes them of the same weight as the rest of the model, for norms. Columns of the
matrix are those of f and of the actuators' forces ``g_1 u``, of which the actuators' kernels know
the derivatives by the motion at constant u:

    J = -g_1 (du/dy dy/dz + du/dx dx/dz)

Kinds of inputs are those of the sampled controllers, `sebody.engine.control`.
"""

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from sebody.compiler.decorators import compiled, kernel_function
from sebody.contract.law_row import (
    ALONG,
    ANGLE,
    DERIVATIVES,
    DOT,
    FIRST,
    FIRST_LOCAL,
    FIRST_STATE,
    FLAT_ALONG,
    FLAT_RATE,
    HELD,
    IN_PLANE,
    INPUTS,
    INTO,
    ITS_RATE,
    ITS_ROW,
    KERNEL,
    KIND,
    LAW_FUNCTION,
    LAW_HEADER,
    OF_RATES,
    OUTPUT_PLACES,
    OUTPUTS,
    PLACE,
    PORT,
    READING_NUMBERS,
    READING_PLACES,
    SECOND,
    SECOND_LOCAL,
    STATES,
    STRIDE,
    THIRD,
    THIRD_LOCAL,
    TURN,
    TURNED,
)
from sebody.contract.law_row import WIDTH as ITS_WIDTH
from sebody.contract.layout import (
    AT_CONSTANTS,
    AT_FRAME,
    AT_PORT,
    AT_ROTATIONS,
    C_DAMPING,
    C_MASS,
    C_STIFFNESS,
    ENERGY,
    HEADER,
    RESIDUAL,
    TANGENT,
    Part,
)
from sebody.kernels.abi import Arguments, at, call_kernel
from sebody.kernels.ways import between, carried, turned, turning, way, way_rate

PLANAR = False
N_POSITIONS = None      # any number
N_ROTATIONS = None
CONSTANTS = (
    Part("mass", (), "of the states, for norms"),
    Part("readings", ("inputs", READING_NUMBERS), "numbers of the channels, and biases"),
    Part("limits", ("outputs", 2), "least and largest value; none where the largest is smaller"),
    Part("parameters", ("parameters",), "of the law"),
)
MULTIPLIERS = 0
READS = 0
MEMORY = ()
WIDTH = None            # any number
INERTIAL = False
POWER = True            # of none: its port tells the time
DRIVEN = False
WORK_ROWS = 4
OPERATIONS = {"residual": (0, 0, 0, 0), "column": (0, 0, 0, 0)}
STEP = 6e-6     # of differences, relative to the number and at least absolute


@intrinsic
def _call(typingctx, address, t, y, x, results, parameters):
    """Call a law, or its derivatives; returns 1 after a fault."""
    def codegen(context, builder, sig, args):
        kinds = [context.get_value_type(kind) for kind in sig.args[1:]]
        function = ir.FunctionType(ir.IntType(64), kinds)
        return builder.call(builder.inttoptr(args[0], function.as_pointer()), args[1:])
    return types.int64(types.int64, types.float64, y, x, results, parameters), codegen


@compiled(fastmath=False)
def _evaluate(address, t, y, x, copy, states, results, count, parameters):
    """Set the results of a function, NaN after a fault; it may change the copy of x."""
    for i in range(states):
        copy[i] = x[i]
    for i in range(count):
        results[i] = 0.0
    if _call(address, t, y, copy, results, parameters) != 0:
        for i in range(count):
            results[i] = np.nan


@compiled
def _dot(x, first, c, place):
    found = 0.0
    for i in range(3):
        if c[place + i] != 0.0:
            found += c[place + i]*x[first + i]
    return found


@compiled
def _back(R, first, c, place, i):
    """Component i of the transpose of a rotation matrix times a vector."""
    return R[first + i]*c[place] + R[first + 3 + i]*c[place + 1] + R[first + 6 + i]*c[place + 2]


@compiled
def _forth(R, first, c, place, i):
    """Component i of a rotation matrix times a vector."""
    return (R[first + 3*i]*c[place] + R[first + 3*i + 1]*c[place + 1]
            + R[first + 3*i + 2]*c[place + 2])


@compiled
def _reading(row, c, q, R, v, frames, last):
    """What an input is in the iterate, without bias; `last` is an angle's last value."""
    kind, one, two = row[KIND], row[FIRST], row[SECOND]
    x = v if row[OF_RATES] == 1 else q
    if kind == HELD:
        return frames[one]
    if kind == DOT:             # c0 + e . x + f . y
        return c[0] + _dot(x, one, c, 1) + _dot(x, two, c, 4)
    if kind == TURNED:          # e . (R v)
        return sum3(_back(R, one, c, 1, 0)*v[two], _back(R, one, c, 1, 1)*v[two + 1],
                    _back(R, one, c, 1, 2)*v[two + 2])
    if kind == INTO:            # e . (R' x)
        return sum3(_forth(R, one, c, 1, 0)*x[two], _forth(R, one, c, 1, 1)*x[two + 1],
                    _forth(R, one, c, 1, 2)*x[two + 2])
    if kind == IN_PLANE:        # the same with an angle
        cosine, sine = np.cos(q[one]), np.sin(q[one])
        return (c[1]*(cosine*x[two] + sine*x[two + 1])
                + c[2]*(cosine*x[two + 1] - sine*x[two]))
    if kind == ALONG or kind == FLAT_ALONG:
        return c[0] + way(kind == FLAT_ALONG, q if kind == FLAT_ALONG else R, one,
                          (c[1], c[2], c[3]), q, two, row[THIRD])
    if kind == ITS_RATE or kind == FLAT_RATE:
        return way_rate(kind == FLAT_RATE, q if kind == FLAT_RATE else R, one,
                        (c[1], c[2], c[3]), q, two, row[THIRD], v, two, row[THIRD], row[TURN])
    along = across = 0.0        # ANGLE: of n of a against n and m of b, or the ground
    for i in range(3):
        own = _forth(R, one, c, 1, i)
        along += own*(_forth(R, two, c, 4, i) if two >= 0 else c[4 + i])
        across += own*(_forth(R, two, c, 7, i) if two >= 0 else c[7 + i])
    angle = np.arctan2(across, along)
    return angle + 2.0*np.pi*np.floor((last - angle)/(2.0*np.pi) + 0.5)


@compiled
def sum3(a, b, c):
    """Sum of three numbers."""
    return a + b + c


@compiled
def _turn(Y, local, T, first, x, y, z, factor):
    """Add the derivatives by a rotation's increment: those by the rotation times T."""
    for j in range(3):
        Y[local + j] += factor*(x*T[first + j] + y*T[first + 3 + j] + z*T[first + 6 + j])


@compiled
def _shift(planar, R, first, e, b, a, factor, Y):
    """Add the derivatives of ``(R e) . (x_b - x_a)`` by both points."""
    r = turned(planar, R, first, e[0], e[1], e[2])
    for i in range(2 if planar else 3):
        Y[b + i] += factor*r[i]
        Y[a + i] -= factor*r[i]


@compiled
def _spin(planar, Y, local, T, first, r, factor):
    """Add derivatives by a rotation of a body, those by an angle in a plane."""
    if planar:
        Y[local] += factor*r[2]
    else:
        _turn(Y, local, T, first, r[0], r[1], r[2], factor)


@compiled
def _vary(row, c, q, R, v, T, c_q, c_v, Y):
    """Add the derivatives of an input by all unknowns."""
    kind, one, two = row[KIND], row[FIRST], row[SECOND]
    at_one, at_two = row[FIRST_LOCAL], row[SECOND_LOCAL]
    x = v if row[OF_RATES] == 1 else q
    factor = c_v if row[OF_RATES] == 1 else c_q
    if kind == DOT:
        for i in range(3):
            if c[1 + i] != 0.0:
                Y[at_one + i] += factor*c[1 + i]
            if c[4 + i] != 0.0:
                Y[at_two + i] += factor*c[4 + i]
    elif kind == TURNED:        # d(R v) = R (dv + theta x v), e . R (theta x v) = theta . (v x R'e)
        a, b, d = _back(R, one, c, 1, 0), _back(R, one, c, 1, 1), _back(R, one, c, 1, 2)
        p, r, s = v[two], v[two + 1], v[two + 2]
        Y[at_two] += c_v*a
        Y[at_two + 1] += c_v*b
        Y[at_two + 2] += c_v*d
        _turn(Y, at_one, T, one, r*d - s*b, s*a - p*d, p*b - r*a, c_q)
    elif kind == INTO:          # d(R' x) = R' dx - theta x R' x
        p = R[one]*x[two] + R[one + 3]*x[two + 1] + R[one + 6]*x[two + 2]
        r = R[one + 1]*x[two] + R[one + 4]*x[two + 1] + R[one + 7]*x[two + 2]
        s = R[one + 2]*x[two] + R[one + 5]*x[two + 1] + R[one + 8]*x[two + 2]
        for i in range(3):
            Y[at_two + i] += factor*_forth(R, one, c, 1, i)
        _turn(Y, at_one, T, one, c[2]*s - c[3]*r, c[3]*p - c[1]*s, c[1]*r - c[2]*p, c_q)
    elif kind == IN_PLANE:
        cosine, sine = np.cos(q[one]), np.sin(q[one])
        Y[at_two] += factor*(c[1]*cosine - c[2]*sine)
        Y[at_two + 1] += factor*(c[1]*sine + c[2]*cosine)
        Y[at_one] += c_q*(c[1]*(cosine*x[two + 1] - sine*x[two])
                          - c[2]*(sine*x[two + 1] + cosine*x[two]))
    elif kind == ALONG or kind == FLAT_ALONG:
        planar = kind == FLAT_ALONG
        e, A = (c[1], c[2], c[3]), q if planar else R
        _shift(planar, A, one, e, at_two, row[THIRD_LOCAL], c_q, Y)
        r = turning(planar, A, one, e, between(planar, q, two, row[THIRD]))
        _spin(planar, Y, at_one, T, one, r, c_q)
    elif kind == ITS_RATE or kind == FLAT_RATE:
        planar = kind == FLAT_RATE
        e, A = (c[1], c[2], c[3]), q if planar else R
        f = carried(planar, v, row[TURN], e[0], e[1], e[2])
        d, w = between(planar, q, two, row[THIRD]), between(planar, v, two, row[THIRD])
        _shift(planar, A, one, e, at_two, row[THIRD_LOCAL], c_v, Y)
        _shift(planar, A, one, f, at_two, row[THIRD_LOCAL], c_q, Y)
        r, s = turning(planar, A, one, e, w), turning(planar, A, one, f, d)
        _spin(planar, Y, at_one, T, one, (r[0] + s[0], r[1] + s[1], r[2] + s[2]), c_q)
        r = turning(planar, A, one, e, d)       # by the angular velocity
        if planar:
            Y[at_one] += c_v*r[2]
        else:
            for i in range(3):
                Y[at_one + i] += c_v*r[i]
    elif kind == ANGLE:         # about the axis n x m, which both bodies have
        a, b, d = (c[5]*c[9] - c[6]*c[8], c[6]*c[7] - c[4]*c[9], c[4]*c[8] - c[5]*c[7])
        _turn(Y, at_one, T, one, a, b, d, c_q)
        if two >= 0:
            _turn(Y, at_two, T, two, -a, -b, -d, c_q)


@compiled
def _differences(address, t, y, x, copy, inputs, states, results, other, count, parameters, D):
    """Derivatives of the results of a law by y and x, (count, inputs + states), by differences."""
    columns = inputs + states
    for column in range(columns):
        values, k = (y, column) if column < inputs else (x, column - inputs)
        own = values[k]
        h = STEP*max(1.0, abs(own))
        values[k] = own + h
        _evaluate(address, t, y, x, copy, states, results, count, parameters)
        values[k] = own - h
        _evaluate(address, t, y, x, copy, states, other, count, parameters)
        values[k] = own
        for i in range(count):
            D[i*columns + column] = (results[i] - other[i])/(2.0*h)


@kernel_function
def kernel(task, count, stride, width, index, constants, q, R, v, a, references, frames, T, loads,
           coefficients, forces, matrices, work, energies):
    n = width
    for element in range(count):
        row = at(index, element*stride)
        unknowns = at(at(row, HEADER), row[AT_ROTATIONS])
        law, c, kept = at(unknowns, n), at(constants, row[AT_CONSTANTS]), row[AT_FRAME]
        inputs, states, outputs, first = (law[INPUTS], law[STATES], law[OUTPUTS],
                                          law[FIRST_STATE])
        total, columns, t = states + outputs, inputs + states, loads[3*row[AT_PORT]]
        readings = at(law, LAW_HEADER)
        ends = at(readings, READING_PLACES*inputs)
        mass, numbers = c[0], at(c, 1)
        limits = at(numbers, READING_NUMBERS*inputs)
        parameters = at(limits, 2*outputs)
        y, x = work, at(work, inputs)
        copy = at(x, states)
        results = at(copy, states)
        for k in range(inputs):
            own = at(numbers, READING_NUMBERS*k)
            bias = own[READING_NUMBERS - 1]
            y[k] = bias + _reading(at(readings, READING_PLACES*k), own, q, R, v, frames,
                                   references[kept + k] - bias)
            frames[kept + k] = y[k]
        for i in range(states):
            x[i] = v[unknowns[first + i]]
        _evaluate(law[LAW_FUNCTION], t, y, x, copy, states, results, total, parameters)
        g = at(forces, element*n)
        for i in range(n):
            g[i] = 0.0
        if task != ENERGY:
            for i in range(states):
                g[first + i] = mass*(a[unknowns[first + i]] - results[i])
        for k in range(outputs):
            end, value = at(ends, OUTPUT_PLACES*k), results[states + k]
            frames[end[PLACE]] = value
            if end[PORT] >= 0:
                if limits[2*k] <= limits[2*k + 1] and not np.isnan(value):
                    value = min(max(value, limits[2*k]), limits[2*k + 1])
                frames[end[PLACE]], frames[end[PLACE] + 2] = value, value   # set, and reached
                loads[3*end[PORT]] = value
        if task != TANGENT:
            continue
        other = at(results, total)
        D = at(other, total)
        Y = at(D, total*columns)
        G = at(Y, inputs*n)
        unit = at(G, total*n)
        J = at(matrices, element*n*n)
        c_q, c_v = coefficients[C_STIFFNESS], coefficients[C_DAMPING]
        for i in range(n*n):
            J[i] = 0.0
        for i in range(states):
            J[(first + i)*n + first + i] = coefficients[C_MASS]*mass
        if c_q == 0.0 and c_v == 0.0:
            continue
        for i in range(inputs*n):
            Y[i] = 0.0
        for k in range(inputs):
            _vary(at(readings, READING_PLACES*k), at(numbers, READING_NUMBERS*k), q, R, v, T, c_q,
                  c_v, at(Y, k*n))
        for k in range(outputs):        # what is cut off does not vary; before results are lost
            value = results[states + k]
            at_limit = (limits[2*k] <= limits[2*k + 1]
                        and not limits[2*k] <= value <= limits[2*k + 1])
            unit[k] = 0.0 if at_limit else 1.0
        if law[DERIVATIVES] != 0:
            _evaluate(law[DERIVATIVES], t, y, x, copy, states, D, total*columns, parameters)
        else:
            _differences(law[LAW_FUNCTION], t, y, x, copy, inputs, states, results, other, total,
                         parameters, D)
        for i in range(total):
            varies = 1.0 if i < states else unit[i - states]
            for column in range(n):
                change = 0.0
                for k in range(inputs):
                    change += D[i*columns + k]*Y[k*n + column]
                G[i*n + column] = varies*change
            for j in range(states):
                G[i*n + first + j] += varies*c_v*D[i*columns + inputs + j]
        for i in range(states):
            for column in range(n):
                J[(first + i)*n + column] -= mass*G[i*n + column]
        for k in range(outputs):
            end = at(ends, OUTPUT_PLACES*k)
            if end[PORT] < 0:
                continue
            wide, places = end[ITS_WIDTH], at(law, end[ITS_ROW])
            amplitude = loads[3*end[PORT]]
            loads[3*end[PORT]] = 1.0
            call_kernel(end[KERNEL], RESIDUAL, 1, end[STRIDE], wide, Arguments(
                index=at(places, wide), constants=constants, q=q, R=R, v=v, a=a,
                references=references, frames=frames, T=T, loads=loads, coefficients=coefficients,
                forces=unit, matrices=matrices, work=at(unit, wide), energies=energies))
            loads[3*end[PORT]] = amplitude
            for i in range(wide):
                for column in range(n):
                    J[places[i]*n + column] += unit[i]*G[(states + k)*n + column]
    return 0
