"""Sensors, controllers and inputs of a model as arrays, and the places of their numbers."""

from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.engine.arrays import Arrays

# numbers of a row of `Control.sensors`: where its value is in State.frames; its delay in samples;
# its queue in State.memory; of its tape the place of the quantity, 0 where the loop's aid reads it,
# the place of the first number in State.memory, first and end of what it reads, and where its
# steps, their factors and weights begin
(SLOT, DELAY, QUEUE, OUTPUT, NUMBERS, FIRST_READ, END_READ, AT_STEPS, AT_FACTORS,
 AT_WEIGHTS) = range(10)
GAIN, BIAS, NOISE = range(3)            # of a row of `Control.scales`
SENSOR, APPLY, CONTROLLER = range(3)    # kinds of tasks; APPLY sets outputs of a controller
# numbers of a row of `Control.controllers`
(FUNCTION, FIRST_WIRE, WIRES, FIRST_END, ENDS, STATES, PARAMETERS, ITS_DELAY, ITS_QUEUE,
 SCRATCH, LATER) = range(11)
# State.memory: the next sample; the next stop that Python asked for; the controller with a fault;
# then of every task its samples so far, of every sensor its reading by the aid and its readings so
# far, then numbers of tapes, queues and scratch memory
NEXT, STOP, FAULTY = range(3)
COUNTS = FAULTY + 1
NEVER = -1.0            # time of a stop that there is none: of ordinary size, for ensembles


@dataclass(frozen=True, eq=False)
class Control(Arrays):
    """Sensors, controllers and inputs of a model: constant during a run.

    ==============  ================================================================================
    tasks           (n, 2) what is sampled in its order: kind, number
    periods         (n,) of these
    offsets         (n,) when they are due first
    sensors         (s, 10) see SLOT
    reads           (r, 2) of their tapes: places on the tape and in `State.now`
    steps           of these tapes, see `sebody.kernels.tapes`, as are the next two
    factors         places of the factors of products
    weights         of products
    scales          (s, 3) gain, bias, and standard deviation of the noise
    seeds           (s,) of the noise
    controllers     (c, 11) see FUNCTION
    wires           (w, 2) what controllers are given: place in `State.frames`, and the sensor that
                    is read for it, or -1
    ends            (e, 2) what they set: number of the input or -1, else place of the signal
    inputs          (i, 3) port, place in `State.frames`, row of `System.table_pieces`
    limits          (i, 2) least and largest value; none where the largest is below the least
    parameters      of all controllers
    outside         (1,) 1 where the aid of the loop has to read a sensor
    flowing         (f,) places in `State.frames` that continuous controllers set
    read            (1,) 1 where continuous controllers read what is sampled
    memory          (1,) length of `State.memory`
    ==============  ================================================================================
    """

    tasks: NDArray
    periods: NDArray
    offsets: NDArray
    sensors: NDArray
    reads: NDArray
    steps: NDArray
    factors: NDArray
    weights: NDArray
    scales: NDArray
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
