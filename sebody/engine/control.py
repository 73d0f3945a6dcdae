"""Sensors and controllers in compiled code: what happens at the samples of a run.

A step ends at every sample. There sensors are read and controllers are called, in the order of
`Control.tasks`; what they set holds until the next sample. Accelerations are solved anew where an
input changed, see `engine.restart`. No step is repeated across a sample.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.engine.actuator_inputs import FROM, SINCE, VALUE, input_at
from sebody.engine.aid import aided
from sebody.engine.control_data import (
    APPLY,
    AT_FACTORS,
    AT_STEPS,
    AT_WEIGHTS,
    BIAS,
    COUNTS,
    DELAY,
    END_READ,
    ENDS,
    FAULTY,
    FIRST_END,
    FIRST_READ,
    FIRST_WIRE,
    FUNCTION,
    GAIN,
    ITS_DELAY,
    ITS_QUEUE,
    LATER,
    NEVER,
    NEXT,
    NOISE,
    NUMBERS,
    OUTPUT,
    PARAMETERS,
    QUEUE,
    SCRATCH,
    SENSOR,
    SLOT,
    STATES,
    STOP,
    WIRES,
)
from sebody.engine.state import (
    BAD_CONTROL,
    DONE,
    FAILED,
    NO_AID,
    READINGS,
    SAMPLED,
)
from sebody.engine.step_control import NEAR
from sebody.kernels.abi import at, call_law, pointer_to
from sebody.kernels.tapes import play


@compiled
def sample(system, state):
    """Sample what is due at the time reached; DONE or FAILED."""
    control, memory, t = system.control, state.memory, state.clock.time
    near = NEAR * state.clock.step
    if control.outside[0] == 1 and not aided(system, READINGS):
        state.control.reason = NO_AID
        return FAILED
    changed = False
    for k in range(control.periods.size):
        if memory[COUNTS + k] * control.periods[k] + control.offsets[k] > t + near:
            continue
        number = control.tasks[k, 1]
        if control.tasks[k, 0] == SENSOR:
            changed |= _hold(system, state, number)
        elif control.tasks[k, 0] == APPLY:
            changed |= _apply(system, state, number) > 0
        else:
            status = _control(system, state, number)
            if status < 0:
                memory[FAULTY] = number
                state.control.reason = BAD_CONTROL
                return FAILED
            changed |= status > 0
        memory[COUNTS + k] += 1.0
    if 0.0 <= memory[STOP] <= t + near:
        memory[STOP] = NEVER
    set_next(control, memory)
    if not changed and state.control.meets == SAMPLED and state.control.inside == 0:
        state.control.restart = 0      # nothing jumps
    return DONE


@compiled
def set_next(control, memory):
    """Find the time at which the next step has to end."""
    memory[NEXT] = memory[STOP]
    for k in range(control.periods.size):
        t = memory[COUNTS + k] * control.periods[k] + control.offsets[k]
        if memory[NEXT] < 0.0 or t < memory[NEXT]:
            memory[NEXT] = t


@compiled
def _hold(system, state, k):
    """Read a sensor with a rate of its own, and hold what it reads, or read some samples ago.

    Returns whether something jumps with it.
    """
    control, row = system.control, system.control.sensors[k]
    value = _reading(system, state, k)
    if row[DELAY] > 0:
        queue = state.memory[row[QUEUE]:row[QUEUE] + 1 + row[DELAY]]
        if state.memory[COUNTS + control.periods.size + control.sensors.shape[0] + k] == 1.0:
            for i in range(row[DELAY]):
                queue[1 + i] = value        # before the first reading there is none
        place = 1 + np.int64(queue[0])
        value, queue[place] = queue[place], value
        queue[0] = place % row[DELAY]
    jumps = control.read[0] == 1 and state.frames[row[SLOT]] != value
    state.frames[row[SLOT]] = value
    return jumps


@compiled
def _reading(system, state, k):
    """The present reading of a sensor, with bias and noise."""
    control, first = system.control, COUNTS + system.control.periods.size
    value, counts = measured(system, state, k), first + control.sensors.shape[0] + k
    count = state.memory[counts]
    state.memory[counts] = count + 1.0
    value += control.scales[k, BIAS]
    if control.scales[k, NOISE] > 0.0:
        value += control.scales[k, NOISE] * normal(control.seeds[k], np.int64(count))
    return value


@compiled
def measured(system, state, k):
    """The quantity that a sensor measures, with its gain."""
    control, row = system.control, system.control.sensors[k]
    if row[OUTPUT] == 0:
        return state.memory[COUNTS + control.periods.size + k]
    numbers = at(pointer_to(state.memory), row[NUMBERS])
    numbers[0] = 1.0
    for i in range(row[FIRST_READ], row[END_READ]):
        numbers[control.reads[i, 0]] = state.now[control.reads[i, 1]]
    play(at(pointer_to(control.steps), row[AT_STEPS]),
         at(pointer_to(control.factors), row[AT_FACTORS]),
         at(pointer_to(control.weights), row[AT_WEIGHTS]), numbers)
    return control.scales[k, GAIN] * numbers[row[OUTPUT]]


@compiled
def _control(system, state, k):
    """Call a controller; 1 where an input changed, 0 where none did, -1 after a fault."""
    control, row, memory = system.control, system.control.controllers[k], state.memory
    y, u = row[SCRATCH], row[SCRATCH] + row[WIRES]
    for i in range(row[WIRES]):
        place, sensor = control.wires[row[FIRST_WIRE] + i, 0], control.wires[row[FIRST_WIRE] + i, 1]
        if sensor >= 0:
            state.frames[place] = _reading(system, state, sensor)
        memory[y + i] = state.frames[place]
    for i in range(row[ENDS]):
        memory[u + i] = _held(system, state, row[FIRST_END] + i)
    status = call_law(row[FUNCTION], state.clock.time, at(pointer_to(memory), y),
                   at(pointer_to(state.frames), row[STATES]), at(pointer_to(memory), u),
                   at(pointer_to(control.parameters), row[PARAMETERS]))
    if status != 0:
        return -1
    if row[ITS_DELAY] > 0:
        _delay(memory, row[ITS_QUEUE], row[ITS_DELAY], u, row[ENDS])
    return 0 if row[LATER] == 1 else _apply(system, state, k)


@compiled
def _apply(system, state, k):
    """Set what a controller, or a delay after it, gave last; 1 where an input changed."""
    control, row, memory = system.control, system.control.controllers[k], state.memory
    changed, u = 0, row[SCRATCH] + row[WIRES]
    for i in range(row[ENDS]):
        number, signal = control.ends[row[FIRST_END] + i, 0], control.ends[row[FIRST_END] + i, 1]
        if number >= 0:
            changed |= set_input(system, state, number, memory[u + i])
        else:
            changed |= np.int64(control.read[0] == 1 and state.frames[signal] != memory[u + i])
            state.frames[signal] = memory[u + i]
    return changed


@compiled
def _held(system, state, end):
    """The present value of an output of a controller."""
    control = system.control
    number = control.ends[end, 0]
    return state.frames[control.inputs[number, 1] + VALUE if number >= 0 else control.ends[end, 1]]


@compiled
def _delay(memory, queue, delay, u, size):
    """Put outputs in a queue, take those of some samples ago from it."""
    place = np.int64(memory[queue])
    for i in range(size):
        slot = queue + 1 + place * size + i
        memory[slot], memory[u + i] = memory[u + i], memory[slot]
    memory[queue] = (place + 1) % delay


@compiled
def set_input(system, state, k, value):
    """Set an input, within its limits; 1 where it changed."""
    control = system.control
    place, piece = control.inputs[k, 1], control.inputs[k, 2]
    if control.limits[k, 0] <= control.limits[k, 1]:
        value = min(max(value, control.limits[k, 0]), control.limits[k, 1])
    if value == state.frames[place + VALUE]:
        return 0
    t = state.clock.time
    begun = input_at(system.table_pieces, piece, state.frames, place, t)
    state.frames[place + VALUE], state.frames[place + SINCE] = value, t
    state.frames[place + FROM] = begun
    return 1


@compiled
def normal(seed, count):
    """A number of the standard normal distribution, by Box and Muller, of a seed and a count."""
    one = _uniform(np.uint64(seed), np.uint64(2 * count))
    other = _uniform(np.uint64(seed), np.uint64(2 * count + 1))
    return np.sqrt(-2.0 * np.log(one)) * np.cos(2.0 * np.pi * other)


@compiled
def _uniform(seed, count):
    """A number in (0, 1] by SplitMix64, G. L. Steele et al., OOPSLA 2014, of its count-th state."""
    z = _mixed(seed * np.uint64(0xD1342543DE82EF95) + np.uint64(0x9E3779B97F4A7C15))
    z = _mixed(z + (count + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15))
    return (np.float64(z >> np.uint64(11)) + 1.0) / 9007199254740992.0


@compiled
def _mixed(z):
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
