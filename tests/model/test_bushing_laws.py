"""Laws along and about the axes of bushings against SciPy, in general position."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.analysis import equilibrium, final, gradient, vibrations
from sebody.model.variants import planar

TURN = Rotation.from_rotvec((0.3, 1.1, -0.4)).as_matrix()
PLACE = np.array([0.4, -2.0, 1.0])
EXACT = generalized_alpha(1.0, index=2, tolerance=1e-12)
ROWS = [(-0.5, -30.0), (-0.2, -8.0), (0.0, 0.0), (0.15, 4.0), (0.4, 20.0), (0.6, 60.0)]
DAMPER = [(-2.0, -0.5), (-0.5, -0.4), (0.0, 0.0), (0.5, 1.0), (2.0, 1.5)]
LAWS = {"x": {"force": ROWS, "damping": DAMPER}, "rz": {"force": [(u, 2.0 * f) for u, f in ROWS],
                                                       "damping": 0.1, "preload": 0.5}}
MASS, INERTIA, SPEEDS, SPIN = 2.0, 0.7, np.array([1.5, -0.8, 0.6]), 2.5


def table(rows):
    """Monotone cubics, straight beyond the ends."""
    u, f = np.array(rows).T
    law = PchipInterpolator(u, f)
    ends = law.derivative()(u[[0, -1]])
    return lambda x: np.where(x < u[0], f[0] + ends[0] * (x - u[0]), np.where(
        x > u[-1], f[-1] + ends[1] * (x - u[-1]), law(np.clip(x, u[0], u[-1]))))


def block(space=True, laws=LAWS, **given) -> Model:
    """A body on a bushing, which moves along all axes of it and turns about the third."""
    model = Model(planar=not space)
    d = 3 if space else 2
    turn = TURN if space else np.array([[0.6, -0.8], [0.8, 0.6]])
    base, node = model.node("base", PLACE[:d]), model.node("block", PLACE[:d])
    model.fix(base)
    model.rigid_body("mass", node, MASS, INERTIA * np.eye(3) if space else INERTIA)
    model.bushing(base, node, 50.0, 0.3, turning_stiffness=4.0, turning_damping=0.2, rotation=turn,
                  laws=laws, name="mount", **given)
    model.initial_velocity(node, turn @ SPEEDS[:d], turn[:, 2] * SPIN if space else SPIN)
    return model


def _angle(R):
    """Of a rotation about the third axis."""
    first = R @ TURN[:, 0]
    return np.arctan2(first @ TURN[:, 1], first @ TURN[:, 0])


@pytest.mark.parametrize("space", [True, False])
def test_laws_against_scipy(space):
    """Along an axis with a law, one with coefficients, and about the third axis."""
    runs = [simulate(block(space), h, 0.5, EXACT) for h in (2e-4, 1e-4)]
    d, t = 3 if space else 2, runs[0].t
    turn = TURN if space else np.array([[0.6, -0.8], [0.8, 0.6]])
    ways = [(run["block.position"] - PLACE[:d]) @ turn for run in runs]
    ways = (4.0 * ways[1][::2] - ways[0]) / 3.0
    angles = [_angle(run["block.rotation"]) if space else run["block.rotation"] for run in runs]
    angle = (4.0 * angles[1][::2] - angles[0]) / 3.0
    force, damper = table(ROWS), table(DAMPER)

    def rates(_, y):
        u, v, a, w = y[:d], y[d:2 * d], y[-2], y[-1]
        pull = 50.0 * u + 0.3 * v
        pull[0] = force(u[0]) + damper(v[0])
        lever, c = (np.sin(a), np.cos(a)) if space else (a, 1.0)
        moment = (2.0 * force(lever) + 0.5) * c + 0.1 * w
        return [*v, *(-pull / MASS), w, -moment / INERTIA]
    exact = solve_ivp(rates, (0, 0.5), [*np.zeros(d), *SPEEDS[:d], 0.0, SPIN], "DOP853", t,
                      rtol=1e-12, atol=1e-13, max_step=1e-3).y
    assert np.abs(exact[0]).max() > 0.3 and np.abs(exact[-2]).max() > 0.2
    np.testing.assert_allclose(ways, exact[:d].T, atol=1e-8)
    np.testing.assert_allclose(angle, exact[-2], atol=1e-8)
    for run in runs:
        balance = run["energy.kinetic"] + run["energy.strain"] - run["mount.work"]
        np.testing.assert_allclose(balance, balance[0], rtol=1e-4)


def test_straight_laws_are_coefficients():
    """Bit for bit is too much: sums are in another order."""
    laws = {"y": {"stiffness": 50.0, "damping": 0.3}, "rx": {"stiffness": 4.0, "damping": 0.2}}
    own, other = (simulate(block(laws=one), 1e-3, 0.2) for one in (laws, None))
    for name in ("block.position", "block.rotation", "mount.work", "energy.strain"):
        np.testing.assert_allclose(own[name], other[name], atol=1e-11)


def test_gaps_and_one_side():
    """A free way, then a contact that only pulls."""
    run = simulate(block(False, {"x": {"stiffness": 200.0, "gap": 0.1, "tension_only": True}}),
                   1e-3, 0.2)
    u = (run["block.position"] - PLACE[:2]) @ np.array([0.6, 0.8])
    free = u < 0.1
    np.testing.assert_allclose(u[free], 1.5 * run.t[free], atol=1e-9)
    assert 0.15 < u.max() < 1.5 * 0.2


def test_equilibria_frequencies_and_gradients():
    model = block(False, {"x": {"force": ROWS}})
    for rate in (model.nodes["block"].position, model.nodes["block"].rotation):
        rate.rate[:] = 0.0
    model.gravity((0.6 * 4.0, 0.8 * 4.0))
    found = equilibrium(model)
    u = (found["block.position"][-1] - PLACE[:2]) @ np.array([0.6, 0.8])
    assert table(ROWS)(u) == pytest.approx(8.0, rel=1e-8)
    slope = (table(ROWS)(u + 1e-6) - table(ROWS)(u - 1e-6)) / 2e-6
    assert np.abs(np.abs(vibrations(found).omega) - np.sqrt(slope / MASS)).min() < 2e-2
    scheme = generalized_alpha(0.9, tolerance=1e-11)
    kept = {"end": final("block.position")}
    made = gradient(block(), 2e-3, 0.1, kept, ["mass.mass"], scheme=scheme)

    def end(factor):
        model = block()
        body = model.rigid_bodies["mass"]
        body.constants = {k: v * factor for k, v in body.constants.items()}
        return simulate(model, 2e-3, 0.1, scheme)["block.position"][-1]
    wanted = (end(1.0 + 1e-4) - end(1.0 - 1e-4)) / 2e-4
    np.testing.assert_allclose(made.matrix[:, 0], wanted, rtol=1e-5)


@pytest.mark.parametrize(("given", "said"), [
    ({"laws": {"q": {"force": ROWS}}}, "axis of laws of bushing at 'base' 'q' is unknown|'q' is"),
    ({"laws": {"x": {"forc": ROWS}}}, "'forc' is unknown: did you mean 'force'"),
    ({"laws": {"x": ROWS}}, "law of x is .*give a dict of axes"),
    ({"laws": 3}, "laws is 3: give a dict of axes"),
    ({"laws": {"x": {"force": ROWS, "stiffness": 2.0}}}, "law of x has a stiffness and a force"),
    ({"laws": {"rz": {"damping": [(-1.0, 1.0), (1.0, -1.0)]}}}, "force drives the rate"),
    ({"laws": LAWS, "stiffness": [[5.0, 1.0], [-1.0, 5.0]]}, "laws and coupled axes"),
    ({"force": ROWS}, "has a law by force=: give it to an axis, laws="),
])
def test_refused(given, said):
    model = Model()
    base, node = model.node("base", PLACE), model.node("block", PLACE)
    with pytest.raises(InputError, match=said):
        model.bushing(base, node, **given)
    assert not model.loads


SECOND = {"force": [(-0.3, -20.0), (0.0, 0.0), (0.5, 15.0)]}


def mounted(normal, side=1.0, **preloads):
    """A body that moves in a plane on a bushing with one axis along the normal or against it."""
    axes = np.diag([1.0, side, side]) @ np.roll(np.eye(3), normal - 2, axis=1)
    inside = Rotation.from_rotvec((0.0, 0.0, 0.4)).as_matrix()
    model, names = Model(), np.roll(["x", "y", "z"], 2 - normal)
    base, node = model.node("base", PLACE), model.node("block", PLACE)
    model.fix(base)
    model.rigid_body("mass", node, MASS, INERTIA * np.eye(3))
    laws = {names[0]: LAWS["x"], names[1]: SECOND, "r" + names[2]: LAWS["rz"]}
    laws |= {axis: {"force": ROWS, "preload": preload} for axis, preload in preloads.items()}
    model.bushing(base, node, 50.0, 0.3, turning_stiffness=4.0, rotation=TURN @ inside @ axes,
                  laws=laws, name="mount")
    model.initial_velocity(node, TURN @ (1.5, -0.8, 0.0), TURN[:, 2] * SPIN)
    return model


@pytest.mark.parametrize("normal, side", [(0, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)])
def test_in_a_plane_as_built_there(normal, side):
    """Whichever axis is the normal, seen from its tip; no law is symmetric."""
    flat = Model(planar=True)
    base, node = flat.node("base", PLACE[:2]), flat.node("block", PLACE[:2])
    flat.fix(base)
    flat.rigid_body("mass", node, MASS, INERTIA)
    c, s = np.cos(0.4), side * np.sin(0.4)
    flat.bushing(base, node, 50.0, 0.3, turning_stiffness=4.0, rotation=[[c, -s], [s, c]],
                 laws=LAWS | {"y": SECOND})
    flat.initial_velocity(node, (1.5, -0.8 * side), SPIN * side)
    variant = planar(mounted(normal, side))
    assert "moments of mount follow angles, in space their sines" in str(variant)
    found, built = (simulate(one, 1e-3, 0.5, EXACT)["energy.kinetic"]
                    for one in (variant.model, flat))
    assert found == pytest.approx(built, abs=1e-10)
    assert np.ptp(built) > 1.0


def test_laws_that_push_out_of_the_plane_are_refused():
    with pytest.raises(InputError, match="'mount' pushes out of the plane where it is at rest"):
        planar(mounted(2, z=0.5))
