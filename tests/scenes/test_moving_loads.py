"""What moves over bridges and cranes, against series and whole FE models."""

import shutil

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sebody import simulate
from sebody.io import load_body
from sebody.scenes import bridge, crane, crane_girder


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


@pytest.fixture(scope="module")
def carried():
    scene = crane.build()
    return simulate(scene.model, scene.h, scene.t_end)


def test_girders_sag_as_beams_and_share_the_load(carried):
    """While the load hangs still: F a^2 b^2 / (3 E I L), and what shear adds, of both together;
    the carriages at their ends twist, and let the less loaded one bear more.
    """
    still = np.searchsorted(carried.t, 1.4)
    a, b, L = crane.START, crane.LENGTH - crane.START, crane.LENGTH
    bend, area = 2.1e11 * crane.WIDTH * crane.HEIGHT**3 / 12, crane.WIDTH * crane.HEIGHT
    sags = []
    for side, part in (("left", 1 - crane.NEARER), ("right", crane.NEARER)):
        force = carried[f"{side}.normal_force"][still]
        assert force == pytest.approx(part * crane.LOAD * crane.G, rel=5e-3)
        place = carried[f"{side} wheel.position.z"]
        sags.append(place[0] - place[still])
    sag = crane.LOAD * crane.G * (a * a * b * b / (3 * bend * L)
                                  + a * b / L / (5 / 6 * area * 2.1e11 / 2.6))
    assert sum(sags) == pytest.approx(sag, rel=5e-3)
    assert 1.0 < sags[0] / sags[1] < 2.0


def test_a_hanging_load_swings_as_under_a_rigid_crane(carried):
    """Of the rope against the vertical, driven by the acceleration of the trolley."""
    length = crane.ROPE

    def pushed(t):
        u = np.clip((t - crane.PICKED_UP) / crane.MOVED, 0.0, 1.0)
        return crane.WAY / crane.MOVED**2 * (60 * u - 180 * u**2 + 120 * u**3)
    found = solve_ivp(lambda t, z: (z[1], -(crane.G * np.sin(z[0]) + pushed(t) * np.cos(z[0]))
                                    / length), (1.0, 10.0), (0.0, 0.0), t_eval=carried.t[200:],
                      rtol=1e-7, atol=1e-9, max_step=0.05).y[0]
    swing = carried["load.position.x"] - carried["left.way"]
    assert swing[200:] == pytest.approx(length * np.sin(found), abs=2e-2)
    assert np.ptp(swing[-400:]) > 2.0
    # the engines give what load, wheels and frame take along x
    masses = (("load", crane.LOAD), ("left wheel", crane.WHEEL), ("right wheel", crane.WHEEL))
    pushed_by = carried["left engine.thrust"] + carried["right engine.thrust"]
    taken = sum(mass * carried[f"{name}.acceleration.x"] for name, mass in masses)
    taken += crane.TROLLEY * carried["trolley.acceleration.x"]
    assert np.abs(pushed_by - taken).max() < 2e-2 * np.abs(taken).max()


@pytest.mark.skipif(shutil.which("ccx") is None, reason="needs ccx")
def test_the_body_file_is_that_of_its_deck(tmp_path):
    made = crane_girder.girder(crane_girder.write_matrices(tmp_path))
    shipped = load_body(crane_girder.FILE)
    for name in ("stiffness", "mass"):
        one, other = getattr(made, name), getattr(shipped, name)
        assert np.linalg.eigvalsh(one) == pytest.approx(np.linalg.eigvalsh(other), rel=1e-6,
                                                        abs=1e-9 * np.abs(one).max())
    assert made.paths["RAIL"].tolist() == shipped.paths["RAIL"].tolist()
