"""Kernel of continuous controllers: a law of users in the equations of motion.

It is written by hand, since there is nothing to derive. Before the actuators are evaluated it sets
their amplitudes to ``u(t, y, x)``, y what is measured in the iterate and x the states of the law.
States are velocities of hidden coordinates, so the scheme integrates them:

    mass (x_i' - f_i(t, y, x)) = 0

with a mass that makes them of the same weight as the rest of the model, for norms. Columns of the
matrix are those of f and of the actuators' forces ``g_1 u``, of which the actuators' kernels know
the derivatives by the motion at constant u:

    J = -g_1 (du/dy dy/dz + du/dx dx/dz)
"""

import numpy as np

from sebody.compiler.decorators import compiled, kernel_function
from sebody.contract.law_row import (
    ANGLES,
    AT,
    AT_FACTORS,
    AT_OUTPUTS,
    AT_STEPS,
    BIAS,
    DERIVATIVES,
    FIRST_STATE,
    INPUTS,
    ITS_ROW,
    KERNEL,
    KIND,
    LAW_FUNCTION,
    LAW_HEADER,
    LOCAL,
    NUMBER,
    NUMBERS,
    OUTPUT_PLACES,
    OUTPUTS,
    PLACE,
    PORT,
    PRODUCTS,
    READ_PLACES,
    READS as READ,
    SCALE,
    STATES,
    STRIDE,
    WIDTH as ITS_WIDTH,
)
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
from sebody.contract.read_numbers import OF_Q, OF_R, OF_V
from sebody.kernels.abi import Arguments, at, call_kernel, call_law
from sebody.kernels.tapes import play, play_back

PLANAR = False
N_POSITIONS = None      # any number
N_ROTATIONS = None
CONSTANTS = (
    Part("mass", (), "of the states, for norms"),
    Part("scales", ("inputs", 2), "what quantities are multiplied with, and what is added"),
    Part("weights", ("products",), "of products on the tape of the inputs"),
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


@compiled(fastmath=False)
def _evaluate(address, t, y, x, copy, states, results, count, parameters):
    """Set the results of a function, NaN after a fault; it may change the copy of x."""
    for i in range(states):
        copy[i] = x[i]
    for i in range(count):
        results[i] = 0.0
    if call_law(address, t, y, copy, results, parameters) != 0:
        for i in range(count):
            results[i] = np.nan


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


@compiled
def _measure(law, scales, weights, kept, q, R, v, references, frames, numbers, y):
    """Read the inputs in the iterate, and keep angles, which count their turns."""
    reads = at(law, LAW_HEADER)
    numbers[0] = 1.0
    for k in range(law[READ]):
        one = at(reads, READ_PLACES*k)
        kind, place = one[KIND], one[AT]
        numbers[one[NUMBER]] = (q[place] if kind == OF_Q else v[place] if kind == OF_V
                                else R[place] if kind == OF_R else frames[place])
    outputs = at(reads, READ_PLACES*law[READ])
    angles = at(outputs, law[INPUTS])
    for k in range(law[ANGLES]):
        numbers[angles[k]] = references[kept + k]
    play(at(law, law[AT_STEPS]), at(law, law[AT_FACTORS]), weights, numbers)
    for k in range(law[ANGLES]):
        frames[kept + k] = numbers[angles[k]]
    for k in range(law[INPUTS]):
        y[k] = scales[2*k + BIAS] + scales[2*k + SCALE]*numbers[outputs[k]]


@compiled
def _vary_inputs(law, n, scales, weights, numbers, bars, R, T, c_q, c_v, Y):
    """Derivatives of the inputs by all unknowns, (inputs, n)."""
    reads = at(law, LAW_HEADER)
    outputs = at(reads, READ_PLACES*law[READ])
    for k in range(law[INPUTS]):
        for i in range(law[NUMBERS]):
            bars[i] = 0.0
        bars[outputs[k]] = scales[2*k + SCALE]
        play_back(at(law, law[AT_STEPS]), at(law, law[AT_FACTORS]), weights, numbers, bars)
        row = at(Y, k*n)
        for i in range(law[READ]):
            one = at(reads, READ_PLACES*i)
            bar = bars[one[NUMBER]]
            if bar == 0.0 or one[LOCAL] < 0:
                continue
            if one[KIND] == OF_Q:
                row[one[LOCAL]] += c_q*bar
            elif one[KIND] == OF_V:
                row[one[LOCAL]] += c_v*bar
            elif one[KIND] == OF_R:
                _turn(at(row, one[LOCAL]), R, T, one[AT], c_q*bar)


@compiled
def _turn(row, R, T, place, bar):
    """Add the derivatives of an entry of a rotation matrix by an increment of its rotation.

    With ``dR = R skew(T d)`` they are those of entry (i, j), ``R_io (T d)_p - R_ip (T d)_o``,
    where (j, o, p) are in cyclic order.
    """
    first = place//9*9
    i, j = (place - first)//3, (place - first) % 3
    o, p = (j + 1) % 3, (j + 2) % 3
    one, other = bar*R[first + 3*i + o], bar*R[first + 3*i + p]
    for k in range(3):
        row[k] += one*T[first + 3*p + k] - other*T[first + 3*o + k]


@compiled(forceinline=True)
def _set_outputs(outputs, ends, limits, values, frames, loads):
    """Set signals, and amplitudes of actuators within their limits."""
    for k in range(outputs):
        end, value = at(ends, OUTPUT_PLACES*k), values[k]
        frames[end[PLACE]] = value
        if end[PORT] >= 0:
            if limits[2*k] <= limits[2*k + 1] and not np.isnan(value):
                value = min(max(value, limits[2*k]), limits[2*k + 1])
            frames[end[PLACE]], frames[end[PLACE] + 2] = value, value   # set, and reached
            loads[3*end[PORT]] = value


@compiled(forceinline=True)
def _mark_varying(outputs, limits, values, varies):
    """1 for each output that varies, 0 for those that are cut off at a limit."""
    for k in range(outputs):
        at_limit = (limits[2*k] <= limits[2*k + 1]
                    and not limits[2*k] <= values[k] <= limits[2*k + 1])
        varies[k] = 0.0 if at_limit else 1.0


@compiled(forceinline=True)
def _vary_results(law, n, D, Y, c_v, varies, G):
    """Derivatives of rates of states and of outputs by all unknowns, (results, n), by the chain."""
    inputs, states, outputs, first = law[INPUTS], law[STATES], law[OUTPUTS], law[FIRST_STATE]
    columns = inputs + states
    for i in range(states + outputs):
        factor = 1.0 if i < states else varies[i - states]
        for column in range(n):
            change = 0.0
            for k in range(inputs):
                change += D[i*columns + k]*Y[k*n + column]
            G[i*n + column] = factor*change
        for j in range(states):
            G[i*n + first + j] += factor*c_v*D[i*columns + inputs + j]


@kernel_function
def kernel(task, count, stride, width, index, constants, q, R, v, a, references, frames, T, loads,
           coefficients, forces, matrices, work, energies):
    n = width
    for element in range(count):
        row = at(index, element*stride)
        unknowns = at(at(row, HEADER), row[AT_ROTATIONS])
        law, c = at(unknowns, n), at(constants, row[AT_CONSTANTS])
        inputs, states, outputs, first = (law[INPUTS], law[STATES], law[OUTPUTS],
                                          law[FIRST_STATE])
        total, columns, t = states + outputs, inputs + states, loads[3*row[AT_PORT]]
        ends = at(law, law[AT_OUTPUTS])
        mass, scales = c[0], at(c, 1)
        weights = at(scales, 2*inputs)
        limits = at(weights, law[PRODUCTS])
        parameters = at(limits, 2*outputs)
        numbers = work
        bars = at(numbers, law[NUMBERS])
        y = at(bars, law[NUMBERS])
        x = at(y, inputs)
        copy = at(x, states)
        results = at(copy, states)
        _measure(law, scales, weights, row[AT_FRAME], q, R, v, references, frames, numbers, y)
        for i in range(states):
            x[i] = v[unknowns[first + i]]
        _evaluate(law[LAW_FUNCTION], t, y, x, copy, states, results, total, parameters)
        g = at(forces, element*n)
        nothing = 0.0*results[total - 1]        # no number after a fault, though all may be signals
        for i in range(n):
            g[i] = nothing
        if task != ENERGY:
            for i in range(states):
                g[first + i] = mass*(a[unknowns[first + i]] - results[i])
        _set_outputs(outputs, ends, limits, at(results, states), frames, loads)
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
        _vary_inputs(law, n, scales, weights, numbers, bars, R, T, c_q, c_v, Y)
        _mark_varying(outputs, limits, at(results, states), unit)      # before results are lost
        if law[DERIVATIVES] != 0:
            _evaluate(law[DERIVATIVES], t, y, x, copy, states, D, total*columns, parameters)
        else:
            _differences(law[LAW_FUNCTION], t, y, x, copy, inputs, states, results, other, total,
                         parameters, D)
        _vary_results(law, n, D, Y, c_v, unit, G)
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
