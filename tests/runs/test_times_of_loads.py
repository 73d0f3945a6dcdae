"""Times of forces by functions, of modes, actuators and joints on paths."""

import numpy as np
import pytest

from sebody import InputError, Model, PhasedSimulation, simulate
from sebody.control import pid
from sebody.fem import Section, planar_beam
from sebody.reduction import craig_bampton

SECTION = Section(area=0.2, inertia_y=0.02, inertia_z=0.02, torsion=0.04, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
OFF = 0.417     # between two steps


def cart(mass=2.0) -> Model:
    """A cart on a rail."""
    model = Model(planar=True)
    model.rigid_body("body", model.node("cart", (0.0, 0.0)), mass, 1.0)
    model.prismatic("cart", (1.0, 0.0), name="rail")
    return model


def pushed(t, x, v, force):
    """A force that grows."""
    force[0] = 4.0 * t


def test_a_force_by_a_function_ends():
    model = cart()
    model.user_force("push", ["cart"], pushed, until=OFF)
    run = simulate(model, 1e-3, 1.0)
    np.testing.assert_allclose(run["cart.velocity"][:, 0], np.minimum(run.t, OFF)**2, atol=1e-6)
    assert run["push.work"][-1] == pytest.approx(OFF**4, rel=1e-5)
    assert run["push.work"][-1] == pytest.approx(run["energy.kinetic"][-1], rel=1e-7)
    (event,) = run.events
    assert event[:2] == (pytest.approx(OFF, abs=1e-12), "push let go")


def test_a_force_on_a_mode_begins():
    """The arm is at rest before, and vibrates from then on as under a load from the start."""
    def arm(**when):
        model = Model(planar=True)
        base, tip = model.node("base", (0.0, 0.0)), model.node("tip", (20.0, 0.0))
        model.superelement("arm", craig_bampton(planar_beam((0.0, 0.0), (20.0, 0.0), SECTION, 4),
                                                [(0, "full"), (4, "full")], 3), (base, tip))
        model.fix(base)
        model.mode_force("arm", 0, 50.0, name="shake", **when)
        return model
    late, early = simulate(arm(from_=0.02), 1e-3, 0.06), simulate(arm(), 1e-3, 0.04)
    assert not late["arm.modes"][:20].any()
    scale = np.abs(early["arm.modes"]).max()
    np.testing.assert_allclose(late["arm.modes"][20:], early["arm.modes"], atol=1e-9 * scale)


@pytest.mark.parametrize("way", ["joint", "node"])
def test_an_actuator_lets_go(way):
    """Its signal goes on, its force is none, and the rotor stays."""
    model = cart()
    given = {"joint": "rail", "inertia": 0.5} if way == "joint" else {
        "node": "cart", "direction": (1.0, 0.0)}
    model.actuator("motor", **given, until=OFF)
    model.sensor("place", "cart.position.x")
    model.controller("loop", pid(8.0, reference=1.0),
                     inputs=("place",), outputs=("motor",))
    run = simulate(model, 1e-3, 1.0)
    mass = 2.5 if way == "joint" else 2.0
    rate = np.sqrt(8.0 / mass)
    expected = np.where(run.t < OFF, rate * np.sin(rate * run.t), rate * np.sin(rate * OFF))
    np.testing.assert_allclose(run["cart.velocity"][:, 0], expected, atol=1e-5)
    np.testing.assert_allclose(run["motor.value"], 8.0 * (1.0 - run["cart.position"][:, 0]),
                               atol=2e-2)
    assert run["motor.work"][-1] == pytest.approx(run["energy.kinetic"][-1], rel=1e-6)
    assert not run["motor.power"][run.t > OFF].any()


def test_a_carriage_leaves_its_path():
    """What acts along its way goes with the joint; it flies on a parabola."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    post = model.node("post", (0.0, 0.0))
    model.fix(post)
    model.rigid_body("carriage", model.node("wagon", (0.0, 0.0)), 2.0, 1.0)
    rail = model.path(
        "rail", on=post, points=[(0.0, 0.0), (1.0, 0.3), (2.0, 0.2), (3.0, 0.5)])
    runs = model.path_joint("wagon", rail, inertia=0.1, rate=3.0, name="runs", until=OFF)
    model.spring(runs, stiffness=5.0, name="drawn")
    run = simulate(model, 1e-3, 0.8)
    (event,) = run.events
    after = run.t > OFF
    k = int(np.flatnonzero(after)[0])
    late = run.t[after] - run.t[k]
    flight = (run["wagon.position"][k] + run["wagon.velocity"][k] * late[:, None]
              - 4.905 * late[:, None]**2 * np.array([0.0, 1.0]))
    np.testing.assert_allclose(run["wagon.position"][after], flight, atol=1e-12)
    assert not run["runs.force"][after].any() and run["runs.force"][~after].any()
    assert event.what == "runs let go" and run.energy_balance() < 1e-4


def test_what_has_let_go_reads_as_in_results():
    model = cart()
    model.node("hook", (0.0, 0.0))
    model.rigid_body("load", "hook", 1.0, 1.0)
    model.weld("hook", to="cart", explicit=True, name="grip", until=0.1)
    model.user_force("push", ["cart"], pushed, until=0.2)
    run = PhasedSimulation(model, 1e-2)
    run.run_to(0.05)
    assert np.linalg.norm(run.read("grip.force")) > 0.0
    run.run_to(0.3)
    for name in ("grip.force", "grip.moment", "grip.multipliers", "push.power", "push.work"):
        np.testing.assert_array_equal(run.read(name), run.result()[name][-1], name)
    with pytest.raises(InputError, match="'push' is unknown"):
        run.read("grip.push")


@pytest.mark.parametrize(("build", "message"), [
    (lambda m: m.move("cart", (1.0, 0.0), lambda t: t, until=0.1),
     "move has no until=: .*give drive_slide or drive_angle"),
    (lambda m: m.drive_way("runs", lambda t: t, breaks_at=3.0),
     "drive_way has no breaks_at=: .*give the path_joint the times"),
    (lambda m: m.fix("cart", until=0.2), "fix has no until=: .*give weld"),
    (lambda m: m.user_force("f", ["cart"], pushed, until=-1.0), "'f': until is -1"),
    (lambda m: m.path_joint("wagon", "rail", from_=0.2), "path joint at 'wagon' has from_=")])
def test_what_has_no_times_says_what_has(build, message):
    model = cart()
    rail = model.path("rail", points=[(0.0, 0.0), (1.0, 0.3), (2.0, 0.2)])
    model.node("wagon", (0.0, 0.0))
    model.path_joint("wagon", rail, name="runs")
    with pytest.raises(InputError, match=message):
        build(model)
