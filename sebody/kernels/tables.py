"""Laws by tables that kernels call: force, its slope and its integral at an elongation.

A table is a row of numbers: how many intervals it has, the slope below its first row, then of each
row its place u, the force there, its slope behind it, two coefficients of the cubic up to the next
row, ``F + s x + b x^2 + c x^3`` with x from this row, and the integral of the force up to here.
"""

from sebody.compiler.decorators import compiled

ROWS, TERMS, HEAD = 65, 6, 2
SIZE = HEAD + TERMS * ROWS


@compiled
def table_law(table, u, order):
    """Integral of the force (order 0), force (1) or slope (2); at a row that of the one before."""
    low, high = 0, int(table[0])
    straight = u <= table[HEAD] or u > table[HEAD + TERMS * high]
    if u > table[HEAD + TERMS * high]:
        low = high
    while not straight and high - low > 1:
        middle = (low + high) // 2
        if u > table[HEAD + TERMS * middle]:
            low = middle
        else:
            high = middle
    first = HEAD + TERMS * low
    x = u - table[first]
    force, slope, b, c = table[first + 1], table[first + 2], table[first + 3], table[first + 4]
    if straight:
        b, c = 0.0, 0.0
        if u <= table[HEAD]:
            slope = table[1]
    if order == 2:
        return slope + x * (2.0 * b + 3.0 * c * x)
    if order == 1:
        return force + x * (slope + x * (b + c * x))
    return table[first + 5] + x * (force + x * (slope / 2.0 + x * (b / 3.0 + c * x / 4.0)))
