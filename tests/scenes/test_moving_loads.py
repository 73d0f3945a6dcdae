"""What moves over bridges and cranes, against series and whole FE models."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sebody import simulate
from sebody.scenes import bridge


def crossing(times, sines=8):
    """The vehicle of the scene on three beams by sines, small motions, from the same start.

    Returns
    -------
    (m, 7)
        Middles of the spans, height and pitch of the body, forces on the front and rear axle.
    """
    L, line, n, speed = bridge.SPAN, bridge.LINE_MASS, sines, 25.0
    waves, size = np.arange(1, n + 1) * np.pi / L, 3 * n + 2
    still = np.diag([line * L / 2] * (3 * n) + [bridge.BODY, bridge.INERTIA])
    stiff = np.diag([*np.tile(bridge.BENDING * L / 2 * waves**4, 3), 0.0, 0.0])
    weight = (bridge.AXLE + bridge.BODY / 2) * bridge.G

    def rows(x):
        found, span = np.zeros((3, size)), int(x // L)
        if 0 <= span < 3:
            u, own = x - span * L, slice(span * n, (span + 1) * n)
            found[:, own] = (np.sin(waves * u), waves * np.cos(waves * u),
                             -waves**2 * np.sin(waves * u))
        return found

    def axles(t):
        for arm in (bridge.FRONT, -bridge.FRONT):
            corner = np.zeros(size)
            corner[-2:] = 1.0, arm
            yield corner, rows(bridge.START + arm + speed * t)

    def stretched(corner, row, q, v):
        stretch, rate = (corner - row[0]) @ q, (corner - row[0]) @ v - speed * row[1] @ q
        return bridge.SPRING * stretch + bridge.DAMPER * rate

    def rate(t, z):
        q, v = z[:size], z[size:]
        mass, force = still.copy(), -stiff @ q
        for corner, row in axles(t):
            mass += bridge.AXLE * np.outer(row[0], row[0])
            moved = bridge.AXLE * (2 * speed * row[1] @ v + speed**2 * row[2] @ q)
            force += -row[0] * (weight + moved) - (corner - row[0]) * stretched(corner, row, q, v)
        return np.concatenate([v, np.linalg.solve(mass, force)])

    # the axles come to spans and leave them at these times
    marks = sorted({(k * L - bridge.START - arm) / speed for k in range(4)
                    for arm in (bridge.FRONT, -bridge.FRONT)})
    z, found = np.zeros(2 * size), {}
    for begin, end in zip([0.0, *marks], [*marks, np.inf], strict=True):
        inside = times[(times > begin) & (times <= min(end, times[-1]))]
        if len(inside) == 0 and not begin < times[-1]:
            break
        end = min(end, times[-1])
        part = solve_ivp(rate, (begin + 1e-12, end - 1e-12), z, "DOP853", rtol=1e-6, atol=1e-9,
                         dense_output=True)
        z = part.y[:, -1]
        found |= {t: part.sol(np.clip(t, begin + 1e-12, end - 1e-12)) for t in inside}
    values = []
    for t in times:
        z = found[t]
        q, v = z[:size], z[size:]
        middles = [np.sin(waves * L / 2) @ q[k * n:(k + 1) * n] for k in range(3)]
        a, forces = rate(t, z)[size:], []
        for corner, row in axles(t):
            up = row[0] @ a + 2 * speed * row[1] @ v + speed**2 * row[2] @ q
            forces.append(weight + bridge.AXLE * up - stretched(corner, row, q, v))
        values.append([*middles, *q[-2:], *forces])
    return np.array(values)


@pytest.mark.filterwarnings("ignore::FutureWarning")
def test_a_vehicle_on_three_spans():
    """Also by other lengths that rails bridge; forces differ while an axle passes a support."""
    scene = bridge.build()
    every = np.arange(10, 1300, 10)
    exact = crossing(every * scene.h)
    size = np.abs(exact).max(axis=0)
    for blend, jump in ((0.5, 0.035), (0.0, 0.19)):
        result = simulate(bridge.build(blend=blend).model, scene.h, scene.t_end)
        found = np.column_stack([*(result[f"span {k}.node10.position.y"] for k in range(3)),
                                 result["chassis.position.y"] - 1.0, result["chassis.rotation"],
                                 result["front.force.y"], result["rear.force.y"]])
        off = np.abs(found[every] - exact) / size
        assert off[:, :4].max() < 1e-3
        assert off[:, 4].max() < 1.5e-3
        assert np.median(off[:, 5:]) < 2e-3
        assert off[:, 5:].max() < jump
    assert result["rear.way"] == pytest.approx(-5.0 + 25.0 * result.t, abs=1e-9)
