"""The index row of a continuous controller behind its unknowns, and its row of constants.

First there is the header. Then the tape of its inputs: of every number that is read a row of
`READ_PLACES`, the places of all inputs, those of angles, steps and factors, see
`sebody.kernels.tapes`. Then of every output a row of `OUTPUT_PLACES` numbers, and of every actuator
the places of its unknowns among those of the law, then its own index row.
"""

# the law's function, that of its derivatives or 0, inputs, states, outputs, first local unknown
# of the states; numbers that are read, numbers of the tape, products and angles on it, where its
# steps, their factors and the outputs begin in the row of the law
(LAW_FUNCTION, DERIVATIVES, INPUTS, STATES, OUTPUTS, FIRST_STATE, READS, NUMBERS, PRODUCTS, ANGLES,
 AT_STEPS, AT_FACTORS, AT_OUTPUTS) = range(13)
LAW_HEADER = 13
# of a number that is read: kind as of `contract.read_numbers`, OF_NOTHING of one in the frames; its
# place in q, v, R or the frames; its place on the tape; the local unknown that it varies with, of a
# rotation matrix the first of the rotation, -1 of what stays, as the ground does
KIND, AT, NUMBER, LOCAL = range(4)
READ_PLACES = 4
SCALE, BIAS = range(2)              # of an input, in its constants
# of an output: its port or -1; its place in the frames; the address of the actuator's kernel, its
# unknowns, the length of its index row, and where in the law's row its places begin
PORT, PLACE, KERNEL, WIDTH, STRIDE, ITS_ROW = range(6)
OUTPUT_PLACES = 6


def scratch(inputs: int, states: int, outputs: int, width: int, widest: int, numbers: int) -> int:
    """Scratch memory of a law with `width` unknowns and a tape of so many numbers.

    `widest` is the largest actuator.
    """
    results = states + outputs
    return (inputs + 2 * states + 2 * results + results * (inputs + states)
            + (inputs + results) * width + 5 * widest + outputs + 2 * numbers + 64)
