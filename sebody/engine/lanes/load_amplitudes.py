"""Time functions and inputs in lanes: times are the same for all members."""

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import number_of, some, spread, with_number
from sebody.contract.counts import MEMBERS
from sebody.engine import actuator_inputs, load_amplitudes
from sebody.engine.actuator_inputs import FROM, LAG, RATE, SINCE, VALUE


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
    """See `actuator_inputs.input_at`."""
    value, begun, passed = kept[at + VALUE], kept[at + FROM], max(t - kept[at + SINCE], 0.0)
    lag, fastest = pieces[row, LAG], pieces[row, RATE]
    if some((lag != 0.0) | (fastest != 0.0)):
        for member in range(MEMBERS):
            value = with_number(value, member, actuator_inputs.follow(
                number_of(value, member), number_of(begun, member), number_of(lag, member),
                number_of(fastest, member), number_of(passed, member)))
    return value
