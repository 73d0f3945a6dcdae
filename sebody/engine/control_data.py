"""Sensors, controllers and inputs of a model as arrays, and the places of their numbers."""

from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.engine.arrays import Arrays

# numbers of a row of `Control.channels` and `Control.coefficients`
CHANNEL_PLACES, CHANNEL_NUMBERS = 6, 10
# numbers of a row of `Control.sensors`: where its value is in State.frames, its channel, its delay
# in samples, its queue in State.memory
SLOT, CHANNEL, DELAY, QUEUE = range(4)
BIAS, NOISE = range(2)                  # of a row of `Control.errors`
SENSOR, APPLY, CONTROLLER = range(3)    # kinds of tasks; APPLY sets outputs of a controller
# numbers of a row of `Control.controllers`
(FUNCTION, FIRST_WIRE, WIRES, FIRST_END, ENDS, STATES, PARAMETERS, ITS_DELAY, ITS_QUEUE,
 SCRATCH, LATER) = range(11)
# State.memory: the next sample; the next stop that Python asked for; whether it waits for readings
# of Python and whether it has them; the controller with a fault; then of every task its samples so
# far, of every sensor its reading by Python and its readings so far, then queues and scratch memory
NEXT, STOP, WAITS, HAS, FAULTY = range(5)
COUNTS = FAULTY + 1
NEVER = -1.0            # time of a stop that there is none: of ordinary size, for ensembles


@dataclass(frozen=True, eq=False)
class Control(Arrays):
    """Sensors, controllers and inputs of a model: constant during a run.

    ==============  ================================================================================
    tasks           (n, 2) what is sampled in its order: kind, number
    periods         (n,) of these
    offsets         (n,) when they are due first
    channels        (s, 1 + CHANNEL_PLACES) kind, and places in `State.now` that it reads
    coefficients    (s, CHANNEL_NUMBERS) what they are multiplied with
    sensors         (s, 4) see SLOT
    errors          (s, 2) bias, and standard deviation of the noise
    seeds           (s,) of the noise
    controllers     (c, 11) see FUNCTION
    wires           (w, 2) what controllers are given: place in `State.frames`, and the sensor that
                    is read for it, or -1
    ends            (e, 2) what they set: number of the input or -1, else place of the signal
    inputs          (i, 3) port, place in `State.frames`, row of `System.table_pieces`
    limits          (i, 2) least and largest value; none where the largest is below the least
    parameters      of all controllers
    outside         (1,) 1 where Python has to read a sensor
    flowing         (f,) places in `State.frames` that continuous controllers set
    read            (1,) 1 where continuous controllers read what is sampled
    memory          (1,) length of `State.memory`
    ==============  ================================================================================
    """

    tasks: NDArray
    periods: NDArray
    offsets: NDArray
    channels: NDArray
    coefficients: NDArray
    sensors: NDArray
    errors: NDArray
    seeds: NDArray
    controllers: NDArray
    wires: NDArray
    ends: NDArray
    inputs: NDArray
    limits: NDArray
    parameters: NDArray
    outside: NDArray
    flowing: NDArray
    read: NDArray
    memory: NDArray
