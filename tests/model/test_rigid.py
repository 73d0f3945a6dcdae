"""Rigid bodies against closed solutions: free rotation, heavy top, pendulum, rigid links."""

import numpy as np
import pytest
from helpers import order
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk, ellipkinc

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.fem import Section
from sebody.scenes import heavy_top, torque_free_body

SECTION = Section(area=1e-4, inertia_y=1e-9, inertia_z=2e-9, torsion=2e-9, youngs_modulus=2e11,
                  poisson_ratio=0.3, density=7800.0)


def free_rotation(t, inertia, spin):
    """Body rates of a free body in Jacobi's elliptic functions."""
    inertia, spin = np.array(inertia), np.array(spin)
    energy, moment = inertia @ spin**2, (inertia * spin) @ (inertia * spin)
    swapped = moment < energy * inertia[1]
    if swapped:
        inertia, spin = inertia[::-1], spin[::-1] * [1, -1, 1]      # a half turn keeps the hand
    a, b, c = inertia
    A = np.sqrt((energy * c - moment) / (a * (c - a)))
    B = np.sqrt((energy * c - moment) / (b * (c - b)))
    C = np.sqrt((moment - energy * a) / (c * (c - a)))
    n = np.sqrt((c - b) * (moment - energy * a) / (a * b * c))
    m = (b - a) * (energy * c - moment) / ((c - b) * (moment - energy * a))
    sign = np.sign(spin[2])
    phase = np.arctan2(spin[1] / B, spin[0] / A)
    backwards = -1.0 if swapped else 1.0
    sn, cn, dn, _ = ellipj(backwards * sign * n * t + ellipkinc(phase, m), m)
    w = np.array([A * cn, B * sn, sign * C * dn]).T
    return w[:, ::-1] * [1, -1, 1] if swapped else w


def body_rates(result, node="centre"):
    return np.einsum("nji,nj->ni", result[f"{node}.rotation"],
                     result[f"{node}.angular_velocity"])


@pytest.mark.parametrize("spin", [(0.01, 1.0, 0.01), (0.4, 0.5, 1.2), (1.5, 0.4, 0.2),
                                  (-0.3, 0.9, -0.5)])
def test_free_body_turns_as_euler_says(spin):
    steps, errors = (0.02, 0.01, 0.005), []
    for h in steps:
        result = simulate(torque_free_body.build(spin=spin).model, h, 20.0)
        exact = free_rotation(result.t, (1.0, 2.0, 3.0), spin)
        errors.append(np.abs(body_rates(result) - exact).max())
    assert 1.9 < order(steps, errors) < 2.1
    assert errors[-1] < 2e-4
    H = result["angular_momentum"]
    assert np.abs(H - H[0]).max() < 1e-4 * np.linalg.norm(H[0])


def test_free_body_against_printed_values():
    """Attitude and rates at t = 20, close to the unstable axis: DOP853 and a quadrature."""
    result = simulate(torque_free_body.build().model, 0.002, 20.0)
    assert body_rates(result)[-1] == pytest.approx([-0.005813837, -1.0000330991, 0.008827999],
                                                   abs=2e-5)
    e0, e1, e2, e3 = -0.014154745, 0.998506936, -0.003901243, -0.052614854
    exact = Rotation.from_quat([e1, e2, e3, e0]).as_matrix()
    assert np.abs(result["centre.rotation"][-1] - exact).max() < 3e-5


TOP = {     # centre of mass, body rates 1 and 3
    0.05: (0.2257411175, 0.9734319843, -0.0383551802, 3.63026999, -2.97721743),
    0.2: (0.6055505614, 0.5989576818, -0.5239830274, -2.69159091, 4.91726099),
    0.5: (-0.7024682971, -0.0211651847, -0.7114002577, -0.47105310, 5.90108305),
    1.0: (0.1733439641, 0.6400885921, -0.7484907911, -0.82207810, -5.92329135)}


def top_errors(explicit, h):
    """Largest errors of position and rates at the printed times, relative ones of the reaction."""
    result = simulate(heavy_top.build(explicit).model, h, 1.0)
    rates = body_rates(result)
    rows = [round(t / h) for t in TOP]
    exact = np.array(list(TOP.values()))
    place = np.abs(result["centre.position"][rows] - exact[:, :3]).max()
    rate = np.abs(rates[rows][:, [0, 2]] - exact[:, 3:]).max()
    force = (-result["spherical at pivot.multipliers"] if explicit else result["pivot.reaction"])
    return place, rate, result, force


@pytest.mark.parametrize("explicit, steps", [(False, (5e-4, 2.5e-4, 1.25e-4)),
                                             (True, (1e-3, 5e-4, 2.5e-4))])
def test_heavy_top_both_ways(explicit, steps):
    """Against printed values; order 2 in place and rate, the spin is kept."""
    found = [top_errors(explicit, h) for h in steps]
    for k, limit in ((0, 2e-3), (1, 2e-2)):
        errors = [f[k] for f in found]
        assert 1.85 < order(steps, errors) < 2.15
        assert errors[-1] < limit
    result = found[-1][2]
    assert np.abs(body_rates(result)[:, 1] - 150.0).max() < 1e-6
    energy = result["energy.kinetic"] + result["energy.potential"]
    assert energy[0] == pytest.approx(5435.696790866, rel=1e-9)
    force = found[-1][3]
    assert force[0] == pytest.approx([0.0, -319.526, -317.2625], abs=1e-3)
    assert np.abs(force[round(1.0 / steps[-1])] - [-517.601, -396.843, 404.575]).max() < 3.0


def test_multipliers_of_the_heavy_top_have_order_two_after_the_start():
    """Order 1 over the whole run and 2 after the transient, as Arnold, Bruls and Cardona say."""
    steps, whole, late = (1e-3, 5e-4, 2.5e-4), [], []
    reference = simulate(heavy_top.build().model, 1.5625e-5, 1.0, output_every=16)
    exact = reference["pivot.reaction"]
    for h in steps:
        result = simulate(heavy_top.build(True).model, h, 1.0)
        wrong = np.linalg.norm(-result["spherical at pivot.multipliers"]
                               - exact[::round(h / 2.5e-4)], axis=1)
        whole.append(wrong.max())
        late.append(wrong[result.t > 0.5].max())
    assert 0.8 < order(steps, whole) < 1.3
    assert 1.8 < order(steps, late) < 2.3


def pendulum(links=()):
    """A point mass on a massless rod of length one, through any points between."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    last = model.node("hinge", (0.0, 0.0))
    model.fix(last, "position")
    for k, point in enumerate((*links, (-1.0, 0.0))):
        last = model.attach(f"end {k}", point, last)
    model.point_mass("bob", last, 1.0)
    return model, last.name


def exact_pendulum(t):
    k = np.sin(np.pi / 4)
    sn, cn, dn, _ = ellipj(np.sqrt(9.81) * t + ellipk(k * k), k * k)
    angle = 2 * np.arcsin(k * sn)
    return np.array([-np.sin(angle), -np.cos(angle)]).T


@pytest.mark.parametrize("links", [(), ((0.3, 0.4), (-0.2, 0.9))])
def test_simple_pendulum_is_one_unknown(links):
    """Order 2 against the elliptic functions; links through other points change nothing."""
    steps, errors = (4e-3, 2e-3, 1e-3), []
    for h in steps:
        model, bob = pendulum(links)
        result = simulate(model, h, 10.0)
        errors.append(np.abs(result[f"{bob}.position"] - exact_pendulum(result.t)).max())
    assert result.numbering.free == 1
    assert 1.9 < order(steps, errors) < 2.1 and errors[-1] < 2e-4
    assert result[f"{bob}.position"][2000] == pytest.approx([-0.7935661953, -0.6084839304],
                                                            abs=2e-4)


def test_rod_with_multipliers_is_the_same_pendulum():
    """A distance in place of a link: two coordinates and a multiplier."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    model.fix(model.node("hinge", (0.0, 0.0), keeps="translation"), "position")
    bob = model.node("bob", (-1.0, 0.0), keeps="translation")
    model.point_mass("bob", bob, 1.0)
    model.distance("hinge", bob)
    result = simulate(model, 1e-3, 2.0)
    assert np.abs(result["bob.position"] - exact_pendulum(result.t)).max() < 5e-5
    # the last correction is within the tolerance, 1e-8 of the increment h v of a step
    assert result["constraints.position"].max() < 1e-8 * 1e-3 * np.abs(result["bob.velocity"]).max()


def spatial_arm():
    """Two rigid bodies: one turns about a vertical hinge, the other hangs off its tip."""
    model = Model()
    model.gravity((0.0, 0.0, -9.81))
    hub = model.node("hub", (0, 0, 0))
    model.fix(hub, "position")
    model.rigid_body("arm", hub, 2.0, (0.1, 0.3, 0.4), centre=(0.5, 0.1, 0.0))
    tip = model.attach("tip", (1.0, 0.0, 0.2), hub)
    ball = model.node("ball", tip.point, at=tip)
    model.rigid_body("bob", ball, 1.0, np.diag([0.02, 0.03, 0.04]), centre=(1.2, 0.3, -0.4))
    model.attach("end", (1.5, 0.2, -0.9), ball)
    model.initial_velocity(hub, angular=(0.3, -1.0, 2.0))
    model.initial_velocity(ball, angular=(-1.0, 0.5, 0.7))
    return model


def test_hanging_body_keeps_energy_and_needs_no_equation():
    """Six unknowns; the balance falls with the square of the step without damping."""
    balances, steps = [], (4e-3, 2e-3, 1e-3)
    for h in steps:
        result = simulate(spatial_arm(), h, 1.0, generalized_alpha(1.0, 1e-10))
        balances.append(result.energy_balance())
    assert result.numbering.free == 6 and not result.numbering.multipliers
    assert order(steps, balances) > 1.8 and balances[-1] < 1e-4


def test_hanging_body_equals_an_explicit_joint():
    """The same mechanism with the second body free and a joint in place of the shared point."""
    model = spatial_arm()
    explicit = Model()
    explicit.gravity((0.0, 0.0, -9.81))
    hub = explicit.node("hub", (0, 0, 0))
    explicit.fix(hub, "position")
    explicit.rigid_body("arm", hub, 2.0, (0.1, 0.3, 0.4), centre=(0.5, 0.1, 0.0))
    tip = explicit.attach("tip", (1.0, 0.0, 0.2), hub)
    ball = explicit.node("ball", tip.point)
    explicit.rigid_body("bob", ball, 1.0, np.diag([0.02, 0.03, 0.04]), centre=(1.2, 0.3, -0.4))
    explicit.attach("end", (1.5, 0.2, -0.9), ball)
    explicit.spherical(ball, tip)
    explicit.initial_velocity(hub, angular=(0.3, -1.0, 2.0))
    explicit.initial_velocity(ball, angular=(-1.0, 0.5, 0.7))
    tight = generalized_alpha(0.9, 1e-11)
    a, b = (simulate(m, 2.5e-4, 0.5, tight) for m in (model, explicit))
    assert b.numbering.free == a.numbering.free + 6
    assert "ball.position" in b.start.changed
    assert np.abs(a["end.position"] - b["end.position"]).max() < 5e-6


@pytest.mark.parametrize("action, message", [
    (lambda m: m.rigid_body("b", "a", 0.0, np.ones(3)), "mass of 'b' is 0.0: give a positive"),
    (lambda m: m.rigid_body("b", "a", np.nan, np.ones(3)), "mass of 'b' is nan: give a positive"),
    (lambda m: m.rigid_body("b", "a", 1.0, np.ones(2)), r"inertia of 'b' has shape \(2,\): give 3"),
    (lambda m: m.rigid_body("b", "a", 1.0, [[1, 1, 0], [0, 1, 0], [0, 0, 1]]), "not symmetric"),
    (lambda m: m.rigid_body("b", "a", 1.0, (1, 1, 3)), "principal moments .*: no body has one"),
    (lambda m: m.rigid_body("b", "a", 1.0, np.ones(3), (0, 1)), "centre of 'b' is .0, 1.: give 3"),
    (lambda m: (m.point_mass("b", "a", 1.0), m.point_mass("b", "a", 1.0)),
     "body 'b' exists already"),
    (lambda m: m.attach("a", (0, 0, 1), "a"), "node 'a' exists already"),
    (lambda m: m.attach("c", (0, 0, 1), "half"), "node 'half' has no rotation"),
    (lambda m: (m.attach("c", (0, 0, 1), "a"), m.fix("c", "position")),
     "c.position follows another node by a rigid link: fix or move a.position and its rotation"),
    (lambda m: (m.attach("c", (0, 0, 1), "a"), m.initial_velocity("c", (1, 0, 0))),
     "initial rate of c.position is .*, but it is fixed, prescribed or follows another node"),
])
def test_wrong_bodies_and_links(action, message):
    model = Model()
    model.node("a", (0, 0, 0))
    model.node("half", (0, 1, 0), keeps="translation")
    with pytest.raises(InputError, match=message):
        action(model)


@pytest.mark.parametrize("turned", [0.0, 0.7])
def test_a_point_mass_as_a_piston_has_a_loose_rotation(turned):
    """In a loop of three bodies, whose order is found before loose rotations are."""
    model, axis = Model(), (0.0, 0.0, 1.0)
    turn = Rotation.from_rotvec((0.0, 0.0, turned))
    for name, place in (("o", (0, 0, 0)), ("c", (1, 0.5, 0)), ("r", (1, 0.5, 0)), ("e", (3, 0, 0)),
                        ("p", (3, 0, 0))):
        model.node(name, turn.apply(place))
    model.beam("crank", ["o", "c"], SECTION, 2, 1, 1)
    model.beam("rod", ["r", "e"], SECTION, 2, 1, 1)
    model.point_mass("piston", "p", 1.0)
    model.revolute("o", axis)
    model.revolute("r", axis, to="c")
    model.prismatic("p", turn.apply((1, 0, 0)))
    model.revolute("p", axis, to="e")
    with pytest.raises(InputError, match="the rotation of node 'p' is not connected to anything"):
        Simulation(model, 0.01)


def test_a_point_mass_leaves_a_rotation_without_mass():
    model = Model()
    model.point_mass("ball", model.node("a", (0, 0, 0)), 1.0)
    with pytest.raises(InputError, match="the rotation of node 'a' is not connected to anything"):
        Simulation(model, 0.01)
    model = Model()
    hinge = model.node("hinge", (0, 0, 0))
    model.fix(hinge, "position")
    model.point_mass("ball", model.attach("bob", (1, 0, 0), hinge), 1.0)
    with pytest.raises(InputError, match="mass matrix is singular: hinge.rotation.0. moves no "
                                         "mass, and nothing stiff holds it; add mass or inertia"):
        Simulation(model, 0.01)
