"""Tables of loads and drives in compiled code."""

from sebody.kernels.pipeline import compiled


@compiled
def cubic_at(times, cubics, first, last, t, out, at):
    """Value and two rates at t of the cubics `first` to `last`; constant outside their times."""
    out[at + 1], out[at + 2] = 0.0, 0.0
    if t <= times[first]:
        out[at] = cubics[first, 0]
        return
    if t >= times[last]:
        out[at] = cubics[last, 0]
        return
    i = first
    while times[i + 1] < t:
        i += 1
    x, c = t - times[i], cubics[i]
    out[at] = c[0] + x * (c[1] + x * (c[2] + x * c[3]))
    out[at + 1] = c[1] + x * (2.0 * c[2] + 3.0 * x * c[3])
    out[at + 2] = 2.0 * c[2] + 6.0 * x * c[3]
