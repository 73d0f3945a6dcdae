"""What sensors read in a state: channels, of the kinds of `sebody.contract.law_row`."""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.law_row import (
    ALONG,
    ANGLE,
    DOT,
    FLAT_ALONG,
    FLAT_RATE,
    IN_PLANE,
    INTO,
    ITS_RATE,
    TURNED,
)
from sebody.kernels.readings import angle, dot
from sebody.kernels.ways import way, way_rate


@compiled
def read_channel(now, row, c, last):
    """The quantity of a channel in a state; `last` is what it was before, for angles that turn."""
    if row[0] == DOT:           # c0 + e . x + f . y
        return c[0] + dot(now, row[1], c, 1) + dot(now, row[2], c, 4)
    if row[0] == TURNED:        # e . (R v)
        value = 0.0
        for i in range(3):
            if c[1 + i] != 0.0:
                for j in range(3):
                    value += c[1 + i] * now[row[1] + 3 * i + j] * now[row[2] + j]
        return value
    if row[0] == INTO:          # e . (R' v)
        value = 0.0
        for i in range(3):
            for j in range(3):
                value += c[1 + j] * now[row[1] + 3 * i + j] * now[row[2] + i]
        return value
    if row[0] == IN_PLANE:      # the same with an angle
        cosine, sine, x, y = (np.cos(now[row[1]]), np.sin(now[row[1]]), now[row[2]],
                              now[row[2] + 1])
        return c[1] * (cosine * x + sine * y) + c[2] * (cosine * y - sine * x)
    if row[0] == ALONG or row[0] == FLAT_ALONG:     # c0 + (R e) . (x - y)
        return c[0] + way(row[0] == FLAT_ALONG, now, row[1], (c[1], c[2], c[3]), now, row[2],
                          row[3])
    if row[0] == ITS_RATE or row[0] == FLAT_RATE:
        return way_rate(row[0] == FLAT_RATE, now, row[1], (c[1], c[2], c[3]), now, row[2], row[3],
                        now, row[4], row[5], row[6])
    if row[0] == ANGLE:
        return angle(now, row[1], row[2], c, last)
    return last
