"""Paths against whole FE models, other programs and an integrator without errors to speak of."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sebody import Model, generalized_alpha, rest_to_rest, simulate
from sebody.analysis import equilibrium
from sebody.contract.layout import KINETIC, POTENTIAL, STRAIN
from sebody.fem import frame, rectangle
from sebody.reduction import PathLoads, craig_bampton
from sebody.results.postprocessing import energies
from sebody.runs.simulation import Simulation

G = 9.81


def falling(modes=2, rate=None):
    """A mass slides on a flexible arm that falls about its hinge."""
    model = Model(planar=True)
    along = np.array([np.cos(0.5), np.sin(0.5)])
    ends = model.node("base", (0.0, 0.0)), model.node("tip", 2.0 * along)
    model.beam("arm", ends, rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.0,
                                      density=2700.0), elements=20, bodies=1, modes=modes)
    model.revolute("base")
    car = model.node("car", 1.2 * along, "translation")
    model.point_mass("mass", car, 0.3)
    model.gravity((0.0, -G))
    model.path("rail", on="arm")
    model.path_joint(car, "rail", rate=rate, name="runs")
    return model


@pytest.mark.parametrize("coefficient", [0.0, 0.2])
def test_work_on_a_path_is_energy_lost(coefficient):
    """Accelerations of the equations, integrated to 1e-9: what is left of the energy is rounding.

    The joint does no work, friction that of its force along the path. The scheme comes to the same
    place.
    """
    def build():
        model = falling(rate=0.5 if coefficient else None)
        if coefficient:
            model.friction("runs", coefficient, speed=0.1, name="rub")
        return model
    model = build()
    run = Simulation(model, 1e-3)
    state, moving = run.state, np.flatnonzero(run.system.is_multiplier[:11] == 0)
    half, at = len(moving), run.numbering.dof_blocks[model.ways()[0]]

    def rate(_, z):
        state.q[moving], state.v[moving] = z[:half], z[half:2 * half]
        run._accelerate_again()
        power = run.read("runs.thrust") * state.v[at] if coefficient else 0.0
        return np.concatenate([z[half:2 * half], state.a[moving], [power]])

    def energy(z):
        rate(0.0, z)
        found = energies(run.system, state, state.now[None].copy())[0]
        return [float(np.sum(found[part])) for part in (KINETIC, STRAIN, POTENTIAL)]
    start = np.concatenate([state.q[moving], state.v[moving], [0.0]])
    found = solve_ivp(rate, (0.0, 0.05), start, "DOP853", rtol=1e-9, atol=1e-11).y[:, -1]
    before, after = energy(start), energy(found)
    assert after[0] > 0.1 and after[1] > 0.01
    lost = sum(before) - sum(after)
    assert abs(lost + found[-1]) < 1e-8 * after[0]
    assert lost > 0.001 if coefficient else abs(lost) < 1e-8 * after[0]
    assert abs(lost + found[-1]) < 1e-6 * lost or not coefficient
    way, scheme = found[list(moving).index(at)], generalized_alpha(1.0, index=2)
    # of order 2 in a step: a rate along an arm that rings, as its weight acts at once
    off = 5e-6 if coefficient else 1e-7
    assert simulate(build(), 2.5e-5, 0.05, scheme)["runs.way"][-1] == pytest.approx(way, abs=off)


def telescope(bodies):
    """An inner beam slides in an outer one at two places, each of which is a node of the other."""
    model, length, over = Model(planar=True), 2.0, 1.0
    section = rectangle(0.02, 0.04, youngs_modulus=7e10, poisson_ratio=0.0, density=2700.0)
    base, tip = model.node("base", (0.0, 0.0)), model.node("tip", (length, 0.0))
    root = model.node("root", (length - over, 0.0))
    end = model.node("end", (2 * length - over, 0.0))
    for name, nodes in (("outer", (base, tip)), ("inner", (root, end))):
        model.beam(name, nodes, section, elements=20, bodies=bodies, modes=4)
        model.path(name, on=name)
    model.revolute(base, name="hinge")
    model.drive_angle("hinge", (lambda t: 2 * (t - np.sin(np.pi * t) / np.pi),
                                lambda t: 2 * (1 - np.cos(np.pi * t)),
                                lambda t: 2 * np.pi * np.sin(np.pi * t)))
    model.spring(base, root, 150.0)
    model.path_joint(root, "outer", name="root slides")
    model.path_joint(tip, "inner", name="tip slides")
    return model


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("bodies", [1, 4])
def test_a_telescopic_boom_as_by_cable_elements(bodies):
    """Those of `tests/data/sliding_on_cables.py`; forces are normal to the beams."""
    result = simulate(telescope(bodies), 1e-3, 0.8)
    assert result["root slides.way"][-1] == pytest.approx(1.660664, abs=1.5e-4)
    assert result["tip slides.way"][-1] == pytest.approx(0.339335, abs=1.5e-4)
    assert result["end.position"][-1] == pytest.approx((1.725450, 3.222000), abs=6e-4)
    for name in ("root", "tip"):
        force = result[f"{name} slides.local_force"]
        assert np.abs(force[100:, 0]).max() < 1e-6 * np.abs(force).max()


SPAN, GAUGE, PARTS, ROPES = 20.0, 3.0, 24, 5.0
WHEEL, LOAD, DAMPING = 400.0, 5000.0, 2e-4
START, WAY, DURATION, END, H = 4.0, 10.0, 6.0, 6.0, 1e-2
HELD = (0, 0), (0, 1), (0, 2), (2, 0), (2, 1), (2, 2), (1, 1), (1, 2), (3, 1), (3, 2)


def structure():
    """Two girders and two carriages of beams, and the nodes along the girders."""
    section = rectangle(0.7, 0.25, youngs_modulus=2.1e11, poisson_ratio=0.3, density=2747.5)
    fe = frame([(x, y, 0.0) for y in (0.0, GAUGE) for x in (0.0, SPAN)],
               [(0, 1), (2, 3), (0, 2), (1, 3)], section, PARTS, up=(0, 0, 1))
    x, y, _ = fe.coordinates.T
    girders = [np.flatnonzero(np.isclose(y, side)) for side in (0.0, GAUGE)]
    return fe, [own[np.argsort(x[own])] for own in girders]


def place_of_load():
    """Under the girders, nearer to the first one: it hangs by a rope to each wheel."""
    return np.array([START, 1.0, -ROPES])


def crane(modes, loads):
    """Of the reduced structure, with static modes of so many loads on each girder."""
    fe, girders = structure()
    body = craig_bampton(fe, [(corner, "full") for corner in range(4)], modes, paths={
        f"rail {k}": PathLoads(nodes, loads) for k, nodes in enumerate(girders)})
    body = replace(body, damping=DAMPING * body.stiffness)
    model = Model()
    corners = [model.node(f"corner {k}", point) for k, point in enumerate(body.coordinates)]
    model.superelement("crane", body, corners, stiffening=False)
    for k in (0, 2):
        model.fix(corners[k], "position")
    for k in (1, 3):
        model.slider(corners[k], axis=(1.0, 0.0, 0.0), name=f"guide {k}")
    load = model.node("load", place_of_load(), "translation")
    model.point_mass("crate", load, LOAD)
    model.force(load, (0, 0, -LOAD * G), name="weight")
    for k in range(2):
        wheel = model.node(f"wheel {k}", (START, k * GAUGE, 0.0), "translation")
        model.point_mass(f"wheel {k} mass", wheel, WHEEL)
        model.force(wheel, (0, 0, -WHEEL * G), name=f"weight {k}")
        model.path(f"rail {k}", on="crane", nodes=f"rail {k}")
        model.path_joint(wheel, f"rail {k}", name=f"runs {k}")
        model.drive_way(f"runs {k}", rest_to_rest(WAY, DURATION))
        model.distance(load, wheel, name=f"rope {k}")
    return model


def whole_crane(rho=0.9):
    """Mid-spans and places of wheels and load, (steps + 1, 2 + 9), by all FE DOFs.

    Generalized-alpha of a linear structure and of points on it, places of wheels by the shape
    functions of the elements, constraints of positions by elimination of their forces.
    """
    fe, girders = structure()
    free = np.setdiff1d(np.arange(fe.stiffness.shape[0]),
                        [fe.dofs(node)[axis] for node, axis in HELD])
    K, M = (matrix.toarray()[np.ix_(free, free)] for matrix in (fe.stiffness, fe.mass))
    n, size = len(free), len(free) + 9
    column = {dof: k for k, dof in enumerate(free)}
    dofs_of = [[fe.dofs(node) for node in own] for own in girders]

    def row(k, s):
        """Displacements of a place on a girder by the unknowns, (3, n)."""
        i = min(int(s / SPAN * PARTS), PARTS - 1)
        h = SPAN / PARTS
        u, found = s / h - i, np.zeros((3, n))
        values = ((1 - u)**2 * (1 + 2 * u), u * u * (3 - 2 * u))
        slopes = (h * u * (1 - u)**2, -h * u * u * (1 - u))
        for dofs, linear, value, slope in zip(dofs_of[k][i:i + 2], (1 - u, u), values, slopes,
                                              strict=True):
            for axis, dof, shape in ((0, 0, linear), (1, 1, value), (1, 5, slope), (2, 2, value),
                                     (2, 4, -slope)):
                if dofs[dof] in column:
                    found[axis, column[dofs[dof]]] = shape
        return found

    def equations(q, s):
        """Gaps of wheels from their girders, stretch of the ropes; their derivatives."""
        gaps, B = np.zeros(8), np.zeros((8, size))
        for k in range(2):
            own, wheel = slice(3 * k, 3 * k + 3), n + 3 * k + np.arange(3)
            shape = row(k, s)
            gaps[own] = q[wheel] - (s, k * GAUGE, 0.0) - shape @ q[:n]
            B[own, :n], B[own, wheel] = -shape, np.eye(3)
            rope = q[n + 6:] - q[wheel]
            length = np.linalg.norm(rope)
            gaps[6 + k] = length - lengths[k]
            B[6 + k, n + 6:], B[6 + k, wheel] = rope / length, -rope / length
        return gaps, B

    wheels = np.array([(START, 0.0, 0.0), (START, GAUGE, 0.0)])
    lengths = np.linalg.norm(place_of_load() - wheels, axis=1)
    masses = np.repeat([WHEEL, WHEEL, LOAD], 3)
    weight = np.zeros(size)
    weight[n + 2::3] = -G * np.array([WHEEL, WHEEL, LOAD])

    def inverse(structural, points):
        """Of a matrix in the structure and of the points, as a function of columns."""
        solved = np.linalg.inv(structural)

        def apply(x):
            few = np.flatnonzero(x[:n].reshape(n, -1).any(axis=1))
            return np.concatenate([solved[:, few] @ x[few], (x[n:].T / points).T])
        return apply

    def settle(q, lam, s, apply, pulled):
        """Unknowns on the constraints from those without their forces, by Newton's iteration."""
        for _ in range(30):
            gaps, B = equations(q, s)
            new = pulled - apply(B.T @ lam)
            right = gaps + B @ (new - q)
            change = np.linalg.solve(B @ apply(B.T), right)
            lam, moved = lam + change, new - apply(B.T @ change) - q
            q = q + moved
            if np.abs(moved).max() < 1e-11:
                return q, lam
        raise AssertionError("no convergence")

    am, af = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma = 0.5 + af - am
    beta = (gamma + 0.5)**2 / 4
    bp, gp = (1 - am) / (beta * H * H * (1 - af)), gamma / (beta * H)
    q, v, a, x, lam = np.zeros(size), *np.zeros((3, size)), np.zeros(8)
    q[n:] = np.concatenate([*wheels, place_of_load()])
    lam[6:] = LOAD * G * lengths / (2 * ROPES)      # near the equilibrium: Newton's iteration
    for _ in range(20):
        gaps, B = equations(q, START)
        turned = np.zeros((size, size))
        turned[:n, :n] = K
        for k in range(2):      # ropes under tension turn with their ends
            own = np.r_[n + 3 * k + np.arange(3), n + 6 + np.arange(3)]
            along = B[6 + k, n + 6:]
            across = lam[6 + k] / lengths[k] * (np.eye(3) - np.outer(along, along))
            turned[np.ix_(own, own)] += np.block([[across, -across], [-across, across]])
        residual = np.concatenate([K @ q[:n], np.zeros(9)]) - weight + B.T @ lam
        moved = np.linalg.solve(np.block([[turned, B.T], [B, np.zeros((8, 8))]]),
                                -np.concatenate([residual, gaps]))
        q, lam = q + moved[:size], lam + moved[size:]
        if np.abs(moved[:size]).max() < 1e-12:
            break
    apply = inverse(bp * M + (1 + gp * DAMPING) * K, bp * masses)
    middles = [row(k, SPAN / 2)[2] for k in range(2)]
    found = [np.concatenate([[middle @ q[:n] for middle in middles], q[n:]])]
    for step in range(1, round(END / H) + 1):
        u = min(step * H / DURATION, 1.0)
        s = START + WAY * (10 * u**3 - 15 * u**4 + 6 * u**5)
        aux = (af * a - am * x) / (1 - am)
        guess = q + H * v + H * H * ((0.5 - beta) * x + beta * aux)
        speed = v + H * ((1 - gamma) * x + gamma * aux)
        force = weight - np.concatenate([K @ (guess[:n] + DAMPING * speed[:n]), np.zeros(9)])
        pulled = guess + apply(force)
        q, lam = settle(pulled.copy(), lam, s, apply, pulled)
        v, new = speed + gp * (q - guess), bp * (q - guess)
        x = ((1 - af) * new + af * a - am * x) / (1 - am)
        a = new
        found.append(np.concatenate([[middle @ q[:n] for middle in middles], q[n:]]))
    return np.array(found)


@pytest.mark.filterwarnings("ignore")
def test_a_crane_reduced_with_few_loads_moves_as_all_of_it():
    """Without any vibration mode; between the loaded nodes, under a wheel, by less."""
    exact = whole_crane()
    size = np.abs(exact).max(axis=0)
    model = crane(0, 3)
    result = simulate(model, H, END, generalized_alpha(0.9), start=equilibrium(model))
    middles = [result[f"crane.node{girder[PARTS // 2]}.position.z"] for girder in structure()[1]]
    for found, wanted, largest in zip(middles, exact[:, :2].T, size, strict=False):
        assert np.abs(found - wanted).max() < 2e-4 * largest
    assert result["wheel 0.position.z"] == pytest.approx(exact[:, 4], abs=1.2e-2 * size[4])
    assert result["load.position"] == pytest.approx(exact[:, 8:], abs=1e-4)
    assert np.ptp(result["load.position.x"] - result["wheel 0.position.x"]) > 0.5
