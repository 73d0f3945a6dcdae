"""Places on the path of a body: cubics of the recovery's rows in the way, and their derivatives.

The numbers of a path are a row of constants, see `sebody.model.path_tables`:

    knots K, followers m, offset of the way, four edges of the weight, first and last way allowed,
    1 or 0: beyond the ends rows go straight on or stay,
    K ways of the knots, ascending,
    of every knot the rows ``X, Phi_y, Phi_eta`` and their slopes, D numbers each,
    m symmetric matrices Q_b, (n, n)

The point in the frame of the body is ``r = X + Phi_y y + Phi_eta eta`` with the followers
``eta_b = y . Q_b y / 2``. Beyond the ends the path is straight: points go on and angles stay. The
weight rises from 0 to 1 between the first two edges and falls between the last two, twice
differentiable, or at once where two edges are the same.
"""

from sebody.compiler.decorators import ANY_ORDER, CONTRACT, compiled
from sebody.contract.layout import OFF_PATH, OK

HEAD = 10           # numbers before the knots
# places in the head, what `path_place` finds: the point r and its derivatives by the way, the
# weight of the body and its derivatives; then the weights of four numbers in a cubic, likewise
ARM, SLOPE, BEND, WEIGHT, CUBIC = 0, 3, 6, 9, 12


@compiled
def path_place(path, s, y, n, dimension, head, shapes, slopes, bends):
    """Point of a path at a way in the frame of the body, and how it moves.

    Parameters
    ----------
    path : the row of numbers
    s : float
        The way along the whole path.
    y : (n,)
        Local coordinates of the body.
    head : written
    shapes, slopes : written, (n, D)
        Derivatives of r by the coordinates, and derivatives of these by the way.
    bends : written, (m, D)
        Rows Phi_eta of the followers.

    Returns
    -------
    int
        OK, or OFF_PATH of a way that is not allowed.
    """
    if s < path[7] or s > path[8]:
        return OFF_PATH
    knots, followers, way = int(path[0]), int(path[1]), s - path[2]
    _set_weight(path, way, head)
    k = _interval(path, way)
    _set_cubics(path, way, k, path[9], head)
    size = dimension * (1 + n + followers)
    first = HEAD + knots + 2 * size * k
    for c in range(dimension):
        head[ARM + c] = _row(path, first + c, size, head, 0)
        head[SLOPE + c] = _row(path, first + c, size, head, 1)
        head[BEND + c] = _row(path, first + c, size, head, 2)
    first += dimension
    _set_rows(path, first, dimension * n, size, head, shapes, slopes)
    for c in range(dimension):
        _move(path, first, c, y, n, dimension, size, head, shapes, slopes)
    for b in range(followers):
        at = first + dimension * (n + b)
        for c in range(dimension):
            bends[dimension * b + c] = _row(path, at + c, size, head, 0)
        eta = _follow(path, at, b, y, n, dimension, size, head, shapes, slopes)
        _add(path, at, size, dimension, eta, head)
    return OK


@compiled
def path_direction(path, s, y, n, head, shapes, slopes, bends, section):
    """Point, or rotation of the section, of a path in space at a way, and a direction of this path.

    Behind the rows of `path_place` stand, of every knot, the direction in the undeformed body and
    its slope, 3 numbers each; beyond the ends the direction stays. `section` is written: the
    direction at the way and its two derivatives by the way.
    """
    status = path_place(path, s, y, n, 3, head, shapes, slopes, bends)
    if status != OK:
        return status
    knots, followers = int(path[0]), int(path[1])
    rows = HEAD + knots + 6 * (1 + n + followers) * knots + followers * n * n
    k = _interval(path, s - path[2])
    first = rows + 6 * k
    _set_cubics(path, s - path[2], k, 0.0, head)
    for derivative in range(3):
        for c in range(3):
            section[3 * derivative + c] = _row(path, first + c, 3, head, derivative)
    return OK


@compiled
def path_loads(path, s, y, n, dimension, head, shapes, slopes, bends, head_1, shapes_1, bends_1):
    """Sums over loads that move along a path: of `path_place`, times the share of each.

    Behind the path stand the number of loads and, of each, how far it is behind the way s, and its
    factor. A load that is not on the path has no share; the sum of shares is at `WEIGHT` of `head`,
    the sum of arms at `ARM`. `slopes`, and what ends with 1, are scratch memory.
    """
    knots, followers = int(path[0]), int(path[1])
    size = dimension * (1 + n + followers)
    loads = HEAD + knots + 2 * size * knots + followers * n * n
    for i in range(12):
        head[i] = 0.0
    for i in range(dimension * n):
        shapes[i] = 0.0
    for i in range(dimension * followers):
        bends[i] = 0.0
    for k in range(int(path[loads])):
        way = s - path[loads + 1 + 2 * k]
        if path_place(path, way, y, n, dimension, head_1, shapes_1, slopes, bends_1) != OK:
            continue
        share = path[loads + 2 + 2 * k] * head_1[WEIGHT]
        if share == 0.0:
            continue
        head[WEIGHT] += share
        for c in range(dimension):
            head[ARM + c] += share * head_1[ARM + c]
        for i in range(dimension * n):
            shapes[i] += share * shapes_1[i]
        for i in range(dimension * followers):
            bends[i] += share * bends_1[i]


@compiled
def path_change(path, bends, dy, n, dimension, changes):
    """Changes of the shapes of `path_place` as coordinates change, through the followers."""
    knots, followers = int(path[0]), int(path[1])
    size = dimension * (1 + n + followers)
    first = HEAD + knots + 2 * size * knots
    for k in range(n * dimension):
        changes[k] = 0.0
    for i in range(n):      # most columns of a matrix move few coordinates
        if dy[i] == 0.0:
            continue
        for b in range(followers):
            for c in range(dimension):
                factor, row = bends[dimension * b + c] * dy[i], first + (b * n + i) * n
                if factor == 0.0:
                    continue
                for k in range(n):
                    changes[dimension * k + c] += factor * path[row + k]


@compiled
def _interval(path, way):
    """Number of the interval between knots that a way is in, beyond the ends of the outer one."""
    low, high = 0, int(path[0]) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if path[HEAD + middle] <= way:
            low = middle
        else:
            high = middle
    return low


@compiled
def _set_cubics(path, way, k, straight, head):
    """Weights of value and slope at both knots of an interval: of the place and its derivatives.

    Beyond the ends rows go straight on, or stay with `straight` zero.
    """
    h = path[HEAD + k + 1] - path[HEAD + k]
    u = (way - path[HEAD + k]) / h
    for i in range(12):
        head[CUBIC + i] = 0.0
    if u < 0.0:
        head[CUBIC], head[CUBIC + 1], head[CUBIC + 5] = 1.0, straight * u * h, straight
        return
    w = 1.0 - u
    if w < 0.0:
        head[CUBIC + 2], head[CUBIC + 3], head[CUBIC + 7] = 1.0, -straight * w * h, straight
        return
    head[CUBIC], head[CUBIC + 1] = w * w * (1.0 + 2.0 * u), u * w * w * h
    head[CUBIC + 2], head[CUBIC + 3] = u * u * (3.0 - 2.0 * u), -u * u * w * h
    head[CUBIC + 4], head[CUBIC + 5] = -6.0 * u * w / h, w * (1.0 - 3.0 * u)
    head[CUBIC + 6], head[CUBIC + 7] = 6.0 * u * w / h, u * (3.0 * u - 2.0)
    head[CUBIC + 8], head[CUBIC + 9] = (12.0 * u - 6.0) / (h * h), (6.0 * u - 4.0) / h
    head[CUBIC + 10], head[CUBIC + 11] = (6.0 - 12.0 * u) / (h * h), (6.0 * u - 2.0) / h


@compiled
def _row(path, at, size, head, derivative):
    """One number of the rows at the way, or a derivative of it."""
    first = CUBIC + 4 * derivative
    return (head[first] * path[at] + head[first + 1] * path[at + size]
            + head[first + 2] * path[at + 2 * size] + head[first + 3] * path[at + 3 * size])


@compiled(apart=True)
def _set_rows(path, first, count, size, head, shapes, slopes):
    """Set so many numbers of the rows at the way, and their derivatives."""
    a, b, c, d = head[CUBIC], head[CUBIC + 1], head[CUBIC + 2], head[CUBIC + 3]
    e, f, g, h = head[CUBIC + 4], head[CUBIC + 5], head[CUBIC + 6], head[CUBIC + 7]
    for i in range(first, first + count):
        value, slope = path[i], path[i + size]
        next_value, next_slope = path[i + 2 * size], path[i + 3 * size]
        shapes[i - first] = a * value + b * slope + c * next_value + d * next_slope
        slopes[i - first] = e * value + f * slope + g * next_value + h * next_slope


@compiled(apart=True)
def _move(path, first, c, y, n, dimension, size, head, shapes, slopes):
    """Add what coordinates move along an axis to the point and its derivatives."""
    place = slope = bend = 0.0
    for k in range(n):
        i = dimension * k + c
        place += y[k] * shapes[i]
        slope += y[k] * slopes[i]
        bend += y[k] * _row(path, first + i, size, head, 2)
    head[ARM + c] += place
    head[SLOPE + c] += slope
    head[BEND + c] += bend


@compiled(apart=True)
def _follow(path, at, b, y, n, dimension, size, head, shapes, slopes):
    """Add a follower, whose row is at `at`, to the shapes and slopes; returns its coordinate."""
    eta, more, most = 0.0, dimension > 1, dimension > 2
    shape, slope = _row(path, at, size, head, 0), _row(path, at, size, head, 1)
    shape_1 = slope_1 = shape_2 = slope_2 = 0.0
    if more:
        shape_1, slope_1 = _row(path, at + 1, size, head, 0), _row(path, at + 1, size, head, 1)
    if most:
        shape_2, slope_2 = _row(path, at + 2, size, head, 0), _row(path, at + 2, size, head, 1)
    for k in range(n):
        moved, i = _followed(path, b, k, y, n, size), dimension * k
        eta += 0.5 * moved * y[k]
        shapes[i] += shape * moved
        slopes[i] += slope * moved
        if more:
            shapes[i + 1] += shape_1 * moved
            slopes[i + 1] += slope_1 * moved
        if most:
            shapes[i + 2] += shape_2 * moved
            slopes[i + 2] += slope_2 * moved
    return eta


@compiled
def _add(path, at, size, dimension, factor, head):
    """Add the displacement by a coordinate to the point and its derivatives."""
    for c in range(dimension):
        head[ARM + c] += factor * _row(path, at + c, size, head, 0)
        head[SLOPE + c] += factor * _row(path, at + c, size, head, 1)
        head[BEND + c] += factor * _row(path, at + c, size, head, 2)


@compiled(fastmath=CONTRACT | ANY_ORDER)
def _followed(path, b, k, y, n, size):
    """Row k of ``Q_b y``."""
    knots, moved = int(path[0]), 0.0
    first = HEAD + knots + 2 * size * knots + (b * n + k) * n
    for i in range(n):
        moved += path[first + i] * y[i]
    return moved


@compiled
def _set_weight(path, way, head):
    """Weight of the body at a way, and its two derivatives."""
    head[WEIGHT], head[WEIGHT + 1], head[WEIGHT + 2] = 1.0, 0.0, 0.0
    for side in range(2):
        first, length = path[3 + 2 * side], path[4 + 2 * side] - path[3 + 2 * side]
        if length > 0.0:
            u = min(max((way - first) / length, 0.0), 1.0)
            value = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
            slope = 30.0 * u * u * (1.0 - u) * (1.0 - u) / length
            bend = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (length * length)
        else:
            value, slope, bend = 0.0, 0.0, 0.0
            if way >= first:
                value = 1.0
        if side == 1:
            value, slope, bend = 1.0 - value, -slope, -bend
        one, rate, second = head[WEIGHT], head[WEIGHT + 1], head[WEIGHT + 2]
        head[WEIGHT] = one * value
        head[WEIGHT + 1] = rate * value + one * slope
        head[WEIGHT + 2] = second * value + 2.0 * rate * slope + one * bend
