"""Contacts and friction beside everything else: statics, small motion, ensembles, files, input."""

import numpy as np
import pytest
from contact_models import G, anchored, bar, block

from sebody import (
    InputError,
    Model,
    Result,
    SimulationError,
    plane,
    ramp,
    rest_to_rest,
    simulate,
    sphere,
)
from sebody.analysis import Ensemble, equilibrium, final, linearize
from sebody.explore.sweep import Distribution, sweep
from sebody.model.impacts import damping_of, restitution_of
from sebody.scenes.scene import Scene


def resting(friction=0.3):
    model = Model(planar=True)
    model.node("ball", (0.0, 0.1))
    model.rigid_body("body", "ball", 1.0, 0.004)
    model.gravity((0.0, -G))
    model.contact("ball", on=plane((0.0, 1.0)), radius=0.1, stiffness=1e6, friction=friction,
                  name="floor")
    return model


def incline(mu):
    model = block(axis=(np.cos(0.3), np.sin(0.3), 0.0))
    model.gravity((0.0, -G))
    model.friction("slide", mu, name="dry")
    return model


def test_equilibrium_on_a_surface():
    """As deep as the weight presses; a run from it stays."""
    model = resting()
    found = equilibrium(model)
    assert found["ball.position"][-1, 1] - 0.1 == pytest.approx(-(G / 1e6)**(2 / 3), rel=1e-9)
    assert found["floor.normal_force"][-1] == pytest.approx(G, rel=1e-9)
    result = simulate(model, 1e-3, 0.2, start=found)
    assert np.ptp(result["ball.position"], axis=0).max() < 1e-12


@pytest.mark.parametrize("held", [True, False])
def test_a_held_or_moved_point_has_forces(held):
    """No mass is known that resists: forces and works were no numbers, without a word."""
    model = Model(planar=True)
    model.rigid_body("body", model.node("ball", (0.0, 0.1)), 1.0, 0.004)
    tool = model.node("tool", (2.0, 1e-3), keeps="translation")
    if held:
        model.fix(tool, "position")
    else:
        model.move(tool, (1, 0), ramp(0.5))
        model.move(tool, (0, 1), rest_to_rest(-3e-3, 0.05))
    model.contact(tool, on=plane((0.0, 1.0)), stiffness=1e5, friction=0.3, name="cut")
    result = simulate(model, 1e-3, 0.1)
    normal = 0.0 if held else 1e5 * 2e-3**1.5
    assert result["cut.force"][-1] == pytest.approx([-0.3 * normal, normal], rel=1e-6)
    # the friction works all the way but the last bend of its bristle
    assert np.isfinite(result["cut.work"]).all() and result.energy_balance() < 1e-2


@pytest.mark.parametrize("bristle", [None, 1e4])
def test_a_turned_floor_gives_turned_motion(bristle):
    """Bristles are as stiff and damped for a body that gives way unlike in different directions."""
    def run(angle):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s], [s, c]])
        model = Model(planar=True)
        model.rigid_body("body", model.node("ball", (0.0, 0.101)), 1.0, 0.02, turn @ (0.1, 0.03)
                         + (0.0, 0.101))
        model.gravity(turn @ (0.0, -G))
        model.initial_velocity("ball", linear=turn @ (0.3, -0.5))
        model.contact("ball", on=plane(turn @ (0.0, 1.0), (0.0, 0.101) - 0.101 * turn[:, 1]),
                      radius=0.1, stiffness=1e5, friction=0.3, bristle=bristle)
        return (simulate(model, 1e-3, 0.05)["ball.position"] - (0.0, 0.101)) @ turn
    # rounding, amplified by the impact; 1e-4 where the damping depends on the axes of space
    assert np.abs(run(0.6) - run(0.0)).max() < 1e-9


def test_equilibrium_sticks_or_slides():
    model = incline(0.4)
    found = equilibrium(model)
    assert np.abs(found["block.position"][-1]).max() < 1e-7
    result = simulate(model, 1e-2, 1.0, start=found)
    assert np.ptp(result["block.position"], axis=0).max() < 1e-12
    assert linearize(result).contacts == {"dry": "sticks"}
    sliding = linearize(simulate(incline(0.1), 1e-2, 1.0))
    assert sliding.contacts == {"dry": "slides"}
    assert abs(sliding.stiffness[0, 0]) < 1e-9      # sliding friction has none
    assert linearize(result).stiffness[0, 0] > 1.0


@pytest.mark.parametrize("time", [1e-3, 1.0, 1e3])
def test_equilibrium_sticks_in_any_unit_of_time(time):
    """What a hinge holds beside a spring; in units of 1000 s it gave way by 3 degrees."""
    model = Model(planar=True)
    model.node("root", (0.0, 0.0))
    model.rigid_body("bar", "root", 1.0, 1.0 / 12.0, centre=(0.5, 0.0))
    model.revolute("root", name="hinge")
    model.torsion_spring("root", 50.0 / time**2)
    model.gravity((0.0, -G / time**2))
    model.friction("hinge", 0.4, radius=0.05, preload=300.0 / time**2, name="dry")
    found = equilibrium(model)
    assert abs(found["root.rotation"][-1]) < 1e-6
    assert found["dry.moment"][-1] * time**2 == pytest.approx(G / 2.0, rel=1e-5)


def test_linearized_contact():
    """On its depth the ball has the stiffness 3/2 k sqrt(d), along a bristle its own."""
    found = linearize(equilibrium(resting(friction=0.0)))
    assert found.contacts == {"floor": "presses"}
    stiff = np.sort(np.abs(np.diag(found.stiffness)))[-1]
    assert stiff == pytest.approx(1.5 * 1e6 * (G / 1e6)**(1 / 3), rel=1e-9)


def test_ensembles_vary_coefficients_stiffness_and_limits():
    def build(mu, stiffness, lower):
        model = bar()
        model.friction("hinge", mu, static=1.2 * mu, radius=0.05, name="dry")
        model.stop("hinge", lower=lower, stiffness=stiffness, name="buffer")
        return model
    values = {"dry.coefficient": [0.1, 0.3], "buffer.stiffness": [1e4, 1e5],
              "buffer.lower": [-1.2, -1.3]}
    found = Ensemble(build(0.2, 2e4, -1.25), 2e-3).run(values, t_end=1.0,
                                                      outputs={"end": final("pin.rotation")})
    each = [simulate(build(*row), 2e-3, 1.0)["pin.rotation"][-1]
            for row in zip(*values.values(), strict=True)]
    assert found["end"] == pytest.approx(each, abs=1e-13)


def geared(play=2e-3, friction=0.2):
    """Two wheels in gear, and a ball that falls on the first, in general position."""
    model = Model(planar=True)
    for name, place, J in (("a", (0.3, -0.2), 0.1), ("b", (1.1, 0.1), 0.4)):
        model.rigid_body(f"{name} wheel", model.node(name, place), 1.0, J)
        model.revolute(name, name=f"shaft {name}")
    model.torque("a", 1.0, 1.0)
    model.gear("shaft a", "shaft b", ratio=-2, backlash=play, name="teeth")
    model.rigid_body("body", model.node("ball", (0.33, 0.12)), 0.2, 2e-4)
    model.gravity((0.0, -G))
    model.contact("ball", on=sphere(0.2, node="a"), radius=0.05, stiffness=2e5, friction=friction,
                  name="hit")
    return model


def test_sweeps_vary_friction_stiffness_and_play():
    """By name, without building the model anew; and by arguments of the scene."""
    def build(play=2e-3, friction=0.2):
        return Scene("geared", "wheels in gear", geared(play, friction), h=1e-3, t_end=0.2,
                     base="a")
    outputs = {"b": final("b.rotation"), "ball": final("ball.position")}
    asked = {"hit.coefficient": [0.1, 0.4], "teeth.backlash": [1e-3, 4e-3]}
    stiffness = {"hit.stiffness": Distribution("uniform", (1e5, 3e5))}
    table = sweep(build, outputs, asked, stiffness, runs=2, seed=3, threads=1)
    assert table.good.all() and table.runs == 8
    for k in range(8):
        model = geared(table["teeth.backlash"][k])
        constants = model.element("hit").constants
        constants["coefficient"] = constants["static"] = table["hit.coefficient"][k]
        constants["stiffness"] = table["hit.stiffness"][k]
        alone = simulate(model, 1e-3, 0.2)
        assert table["b"][k] == pytest.approx(alone["b.rotation"][-1], rel=1e-9)
        assert table["ball"][k] == pytest.approx(alone["ball.position"][-1], rel=1e-9)
    anew = sweep(build, outputs, {"play": [1e-3, 4e-3], "friction": [0.1]}, threads=1)
    assert anew["b"][0] == pytest.approx(simulate(geared(1e-3, 0.1), 1e-3, 0.2)["b.rotation"][-1],
                                         rel=1e-9)
    assert len(set(table["b"])) == 8


def oblique(stiffness, restitution, friction):
    """Two balls on a slope and on a body, and a stop of another restitution and speed."""
    model = Model()
    model.gravity((0.4, -0.3, -9.0))
    for name, place in (("ball", (0.1, 0.2, 0.16)), ("table", (2.0, 0.0, 0.0)),
                        ("egg", (2.1, 0.1, 0.2))):
        model.rigid_body(f"{name} body", model.node(name, place), 0.7, (0.01, 0.012, 0.015))
    model.revolute("table", axis=(0.3, 1.0, 0.1), name="pin")
    model.contact("ball", on=plane((0.2, -0.1, 1.0)), radius=0.12, stiffness=stiffness,
                  restitution=restitution, at_speed=0.5, friction=friction, name="slope")
    model.contact("egg", on=plane((0.2, -0.1, 1.0), node="table"), radius=0.1, stiffness=2e4,
                  friction=friction, name="top")
    model.stop("pin", -0.1, 0.2, restitution=restitution, at_speed=2.0, stiffness=500.0, name="end")
    return model


def test_ensembles_vary_contacts_in_space():
    """Stiffness, restitution and friction together, against models built with them."""
    cases = [(1e4, 0.3, 0.1), (4e4, 0.95, 0.5), (2e4, 0.02, 0.0), (1e4, 1.0, 0.3)]
    k, e, mu = np.transpose(cases)
    values = {"slope.stiffness": k, "slope.restitution": e, "end.restitution": e,
              "slope.coefficient": mu, "top.coefficient": mu}
    outputs = {"ball": final("ball.position"), "egg": final("egg.position")}
    found = Ensemble(oblique(3e4, 0.6, 0.2), 2e-3).run(values, t_end=0.5, outputs=outputs)
    for row, case in enumerate(cases):
        result = simulate(oblique(*case), 2e-3, 0.5)
        for name in outputs:
            # impacts enlarge rounding
            assert found[name][row] == pytest.approx(result[f"{name}.position"][-1], abs=1e-9)
    assert np.ptp(found["ball"], axis=0).min() > 1e-4


@pytest.mark.parametrize("e", [0.01, 0.02, 0.1, 0.7, 0.999, 1.0])
def test_restitution_and_damping(e):
    """The damping satisfies its equation, and gives the restitution back."""
    c = damping_of(e, 3.0, "law")
    assert restitution_of(c, 3.0) == pytest.approx(e, rel=1e-9)
    if 0.1 <= e < 1:        # below, 1 - c v e is lost in the last digit
        # about e = 1 both sides are about 1e-3, and their difference is of third order
        assert 3 * c * (1 + e) == pytest.approx(np.log((1 + 3 * c) / (1 - 3 * c * e)), rel=1e-9)


@pytest.mark.parametrize("name, value, said", [
    ("end.restitution", 1.2, "end.restitution of run 0 is 1.2: it must be at most 1"),
    ("top.restitution", 0.0, "top.restitution of run 0 is 0.0: it must be at least 0.01"),
    ("pin friction.restitution", 0.5, "has no restitution")])
def test_restitution_refused(name, value, said):
    model = oblique(2e4, 0.5, 0.2)
    model.friction("pin", 0.1, radius=0.1, name="pin friction")
    with pytest.raises(InputError, match=said):
        Ensemble(model, 2e-3).run({name: [value]}, t_end=0.01,
                                  outputs={"ball": final("ball.position")})


def test_results_are_saved(tmp_path):
    result = simulate(incline(0.2), 1e-2, 0.5)
    result.save(tmp_path / "run.npz")
    again = Result.load(tmp_path / "run.npz")
    for quantity in ("sticks", "normal_force", "dissipation", "work", "force"):
        assert np.array_equal(again[f"dry.{quantity}"], result[f"dry.{quantity}"])


def test_names_of_quantities():
    result = simulate(resting(), 1e-3, 0.01)
    assert {"floor.force", "floor.normal_force", "floor.gap", "floor.sticks",
            "floor.dissipation"} <= set(result.names())
    with pytest.raises(InputError, match="has no gap: it is friction in a joint"):
        simulate(incline(0.2), 1e-2, 0.1)["dry.gap"]


def test_failed_run_keeps_what_it_computed():
    """A contact so stiff that no step resolves it: in words, with the results before."""
    model = Model(planar=True)
    model.node("ball", (0.0, 0.05))
    model.rigid_body("body", "ball", 1.0, 0.1)
    model.initial_velocity("ball", (0.0, -1.0))
    model.contact("ball", on=plane((0.0, 1.0)), stiffness=1e14)
    with pytest.raises(SimulationError, match="a contact or stop changes its rate by more than a "
                                              "tenth") as caught:
        simulate(model, 0.01, 0.2)
    assert 0.03 < caught.value.result["t"][-1] < 0.06


def test_sliding_that_cannot_go_on_is_named():
    """A rod pushed over rough ground, its end ahead of the centre: Painleve's case, here with a
    surface so hard that no step follows it."""
    model = Model(planar=True)
    model.node("end", (0.0, 0.0))
    model.rigid_body("rod", "end", 1.0, 1e-3, centre=(-0.5, 0.9))
    model.gravity((0.0, -G))
    model.initial_velocity("end", (5.0, -0.3), 0.0)
    model.contact("end", on=plane((0.0, 1.0)), stiffness=1e16, friction=3.0, name="ground")
    with pytest.raises(SimulationError, match="With the friction of ground sliding may jam.*Painl"):
        simulate(model, 1e-2, 0.5)


def model():
    found = bar(planar=False)
    found.node("ball", (0.0, 0.0, 2.0))
    found.rigid_body("round", "ball", 1.0, (0.1,) * 3)
    found.node("point", (0.0, 0.0, 3.0), keeps="translation")
    found.point_mass("mass", "point", 1.0)
    found.weld("ball", name="weld")
    return found


UP = plane((0.0, 0.0, 1.0))
BAD = {
    "coefficient is -0.1": lambda m: m.friction("hinge", -0.1, radius=1.0),
    "static is 0.2, below the coefficient of sliding 0.3": lambda m: m.friction(
        "hinge", 0.3, static=0.2, radius=1.0),
    "acts on a radius: give radius=": lambda m: m.friction("hinge", 0.3),
    "a weld has no friction": lambda m: m.friction("weld", 0.3, radius=1.0),
    "nothing presses": lambda m: m.friction("hinge", 0.3, radius=1.0, reaction=False),
    "hing": lambda m: m.friction("hing", 0.3),
    "preload is -1": lambda m: m.friction("hinge", 0.3, radius=1.0, preload=-1.0),
    "restitution is 1.2, and more than 1": lambda m: m.stop("hinge", upper=1.0, stiffness=1.0,
                                                           restitution=1.2),
    "give a number from 0.01 to 1": lambda m: m.stop("hinge", upper=1.0, stiffness=1.0,
                                                     restitution=0.0),
    "at_speed is 0": lambda m: m.stop("hinge", upper=1.0, stiffness=1.0, at_speed=0.0),
    "lower is 0.5 and upper -0.5, which leaves no room": lambda m: m.stop(
        "hinge", lower=0.5, upper=-0.5, stiffness=1.0),
    "it has no limit": lambda m: m.stop("hinge", stiffness=1.0),
    "it starts at 0, beyond the limits 0.1": lambda m: m.stop("hinge", lower=0.1, stiffness=1.0),
    "neither an angle nor a way": lambda m: m.stop("weld", upper=1.0, stiffness=1.0),
    "give stiffness=": lambda m: m.stop("hinge", upper=1.0),
    "it starts 0.3 deep in the plane": lambda m: m.contact(
        "ball", on=plane((0, 0, 1.0), point=(0, 0, 2.2)), radius=0.1, stiffness=1.0),
    "has no rotation, so a sphere about it cannot roll": lambda m: m.contact(
        "point", on=UP, radius=0.1, stiffness=1.0),
    "on is 'floor'": lambda m: m.contact("ball", on="floor", stiffness=1.0),
    "the sphere is on the node itself": lambda m: m.contact(
        "ball", on=sphere(0.1, node="ball"), stiffness=1.0),
    "exponent is 0.5": lambda m: m.contact("ball", on=UP, stiffness=1.0, exponent=0.5),
    "node 'bal'": lambda m: m.contact("bal", on=UP, stiffness=1.0),
    "ratio is 0": lambda m: m.gear("hinge", "hinge 2", ratio=0.0),
    "give two joints": lambda m: m.gear("hinge", "hinge", ratio=2.0),
    "is a weld: give revolute joints": lambda m: m.gear("hinge", "weld", ratio=2.0),
}


@pytest.mark.parametrize("message", BAD)
def test_bad_input(message):
    """Named, shown and with a remedy; the model stays as it was."""
    given = model()
    if "hinge 2" in BAD[message].__code__.co_consts:
        given.node("second", (5.0, 0.0, 0.0))
        given.rigid_body("wheel", "second", 1.0, (0.1,) * 3)
        given.revolute("second", name="hinge 2")
    loads, constraints = len(given.loads), len(given.constraints)
    with pytest.raises(InputError) as caught:
        BAD[message](given)
    assert message in str(caught.value)
    assert (len(given.loads), len(given.constraints)) == (loads, constraints)


def test_anchored_block_slips_to_balance():
    """In statics a block slips until spring and friction balance: F = k x at the limit."""
    mu, k = 0.2, 100.0
    given = anchored(incline(mu), k, 0.0)
    found = equilibrium(given)["block.position"][-1]
    along = np.array([np.cos(0.3), np.sin(0.3)])
    way = -found @ along
    wall = np.array([-1.0, 0.0])
    arm = found - wall
    length = np.linalg.norm(arm)
    pull = k * (length - 1.0) * arm / length
    across = np.array([-along[1], along[0]])
    normal = G * np.cos(0.3) + pull @ across
    assert way > 0
    assert G * np.sin(0.3) + pull @ along == pytest.approx(mu * abs(normal), rel=1e-6)
