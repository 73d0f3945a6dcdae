"""The index row of a continuous controller behind its unknowns, and its row of constants.

First there is the row `LAW`; then of every input a row of `READING_PLACES` numbers, of every output
a row of `OUTPUT_PLACES` numbers, and of every actuator the places of its unknowns among those of
the law, then its own index row.
"""

# the law's function, that of its derivatives or 0, inputs, states, outputs, first local unknown
# of the states, parameters
LAW_FUNCTION, DERIVATIVES, INPUTS, STATES, OUTPUTS, FIRST_STATE = range(6)
LAW_HEADER = 6
# kinds of readings: OUTSIDE are those of Python alone, HELD a number in the frames
# ALONG the way along an axis that turns with a body, ITS_RATE that of this, FLAT_ both in a plane
(OUTSIDE, DOT, TURNED, ANGLE, INTO, IN_PLANE, HELD, ALONG, ITS_RATE, FLAT_ALONG,
 FLAT_RATE) = range(11)
(KIND, OF_RATES, FIRST, SECOND, THIRD, TURN, FIRST_LOCAL, SECOND_LOCAL, THIRD_LOCAL
 ) = range(9)       # of a row
READING_PLACES = 9
READING_NUMBERS = 11                # channel, then the bias of the sensor
# of an output: its port or -1; its place in the frames; the address of the actuator's kernel, its
# unknowns, the length of its index row, and where in the law's row its places begin
PORT, PLACE, KERNEL, WIDTH, STRIDE, ITS_ROW = range(6)
OUTPUT_PLACES = 6


def scratch(inputs: int, states: int, outputs: int, width: int, widest: int) -> int:
    """Scratch memory of a law with `width` unknowns; `widest` is the largest actuator."""
    results = states + outputs
    return (inputs + 2 * states + 2 * results + results * (inputs + states)
            + (inputs + results) * width + 5 * widest + outputs + 64)
