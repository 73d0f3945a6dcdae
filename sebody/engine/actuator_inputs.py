"""Inputs of a model in compiled code: what actuators make of the values that are set.

Between two settings the force or torque f of an actuator follows the value v that was set last,
at the time t_0 from f_0: with the time constant T of its lag and the largest rate s,

    f' = (v - f) / T,  |f'| <= s

a ramp until the gap is s T, then an exponential. So it is known at any time, without an unknown.
"""

import numpy as np

from sebody.compiler.decorators import compiled

# numbers of an input's piece in System.table_pieces
START, LAG, RATE = range(3)
VALUE, SINCE, FROM = range(3)       # its numbers in State.frames


@compiled
def input_at(pieces, row, kept, at, t):
    """Force or torque of an input at a time."""
    return follow(kept[at + VALUE], kept[at + FROM], pieces[row, LAG], pieces[row, RATE],
                  max(t - kept[at + SINCE], 0.0))


@compiled
def follow(value, begun, lag, fastest, passed):
    """The output of an actuator for a value, a time after it was set."""
    gap = value - begun
    if fastest > 0.0 and abs(gap) > fastest * lag:
        ramp = (abs(gap) - fastest * lag) / fastest
        change = np.copysign(fastest, gap)
        if passed < ramp:
            return begun + change * passed
        passed, gap = passed - ramp, change * lag
    return value - (gap * np.exp(-passed / lag) if lag > 0.0 else 0.0)
