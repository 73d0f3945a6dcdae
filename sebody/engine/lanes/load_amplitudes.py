"""Time functions and inputs in lanes: times are the same for all members."""

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import some, spread
from sebody.engine import actuator_inputs, load_amplitudes
from sebody.kernels.lanes.rotations import NONE


@in_lanes_of(load_amplitudes.time_function_at)
def time_function_at(times, pieces, first, last, t, beside, out, at):
    """See `load_amplitudes.time_function_at`."""
    i = first
    while i < last and times[i + 1] <= t + beside:
        i += 1
    x = max(t - times[i], 0.0)
    load_amplitudes.polynomial_at(pieces, i, x, out, at)
    if some(pieces[i, load_amplitudes.AMPLITUDE] != 0.0):
        load_amplitudes.add_harmonic(pieces, i, x, out, at)
    if t + beside < times[first]:
        out[at + 1] = out[at + 2] = spread(0.0)


@in_lanes_of(actuator_inputs.input_at)
def input_at(pieces, row, kept, at, t):
    """No number: models with inputs are run one by one."""
    return spread(NONE)
