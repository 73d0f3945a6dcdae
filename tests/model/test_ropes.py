"""Ropes over points and sheaves against closed forms and other ways to compute them."""

import numpy as np
import pytest
from hanging import AT, TURN, G, heights, hung, turned
from scipy.optimize import brentq

from sebody import InputError, LimitWarning, Model, Simulation, generalized_alpha, simulate
from sebody.analysis import equilibrium, final, gradient
from sebody.fem import rectangle
from sebody.model.variants import planar
from sebody.runs.restart import resume, save_state


@pytest.mark.parametrize("form", ["space", "plane", "planar form"])
def test_machine_of_atwood(form):
    """Over a sheave without mass: the acceleration is constant, and so is the tension."""
    masses, pull = {"a": 3.0, "b": 1.2}, 2 * G * 3.0 * 1.2 / 4.2
    model = hung({"p": (0, 0), "a": (-0.2, -1), "b": (0.2, -4)}, masses, {"p": 0.2},
                 form == "plane")
    model.rope("rope", ("a", "wheel p", "b"), stiffness=1e6, pretension=pull, wrap="-")
    if form == "planar form":
        model = planar(model).model
    result = simulate(model, 0.01, 0.8)
    sunk = 0.5 * G * (3.0 - 1.2) / 4.2 * result.t**2
    for name, start, way in (("a", -1.0, -sunk), ("b", -4.0, sunk)):
        assert heights(model, result, name) == pytest.approx(start + way, abs=1e-10)
    assert result["rope.tension"] == pytest.approx(np.full((len(result.t), 2), pull), rel=1e-9)
    assert result["rope.length"] == pytest.approx(5.0 + 0.2 * np.pi, rel=1e-12)


@pytest.mark.parametrize("form", ["space", "plane", "planar form"])
def test_machine_of_atwood_with_an_inert_sheave(form):
    """``a = (m - M) g / (m + M + J/r^2)``; the rope is so stiff that it hardly swings."""
    (m, M), J, r, flat = (3.0, 1.2), 0.05, 0.2, form == "plane"
    model = hung({"p": (0, 0), "a": (-r, -2), "b": (r, -4)}, {"a": m, "b": M}, flat=flat)
    model.sheave("wheel", "p", r, inertia=J, **({} if flat else {"axis": TURN[:, 2]}))
    rate = (m - M) * G / (m + M + J / r**2)
    tensions = m * (G - rate), M * (G + rate)
    model.rope("rope", ("a", "wheel", "b"), 2e10, damping=1e7, pretension=sum(tensions) / 2,
               wrap="-")
    if form == "planar form":
        model = planar(model).model
    result = simulate(model, 0.01, 0.8, scheme=generalized_alpha(index=3))
    sunk = rate * result.t**2 / 2
    assert heights(model, result, "a") == pytest.approx(-2.0 - sunk, abs=1e-8)
    assert result["wheel.angle"] == pytest.approx(sunk / r, abs=1e-7)
    assert result["rope.tension"][-1] == pytest.approx(tensions, rel=1e-5)
    assert result["wheel.rate"][-1] == pytest.approx(rate * 0.8 / r, rel=1e-6)
    assert result["rope.length"] == pytest.approx(6.0 + r * np.pi, abs=1e-6)    # its arc included


def test_work_of_a_winch_is_the_energy():
    """A load that is hauled up from rest to rest, less what damping takes."""
    model = hung({"p": (0, 0), "a": (0, -3)}, {"a": 20.0})
    model.rope("rope", ("p", "a"), 2e5, damping=2e3, pretension=20.0 * G,
               length=lambda t: -2.0 * (t / 2)**3 * (10 - 15 * t / 2 + 6 * (t / 2)**2))
    result = simulate(model, 5e-4, 2.0)
    energy = sum(result[f"energy.{kind}"] for kind in ("kinetic", "strain", "potential"))
    work = result["winch of rope.work"]
    assert energy - energy[0] == pytest.approx(work + result["rope.work"], abs=1e-8 * work[-1])
    raised = heights(model, result, "a")[-1] + 3.0
    length = result["rope.length"][-1] - result["rope.elongation"][-1]
    assert length == pytest.approx(3.0 / (1.0 + 20.0 * G / 2e5) - 2.0, rel=1e-12)
    assert work[-1] + result["rope.work"][-1] == pytest.approx(20.0 * G * raised, rel=1e-3)


@pytest.mark.parametrize("flat", [False, True])
def test_a_sheave_in_its_bearing_does_not_turn_with_its_node(flat):
    """A torque turns a bracket up; what turns on it without a rope stands in space."""
    model = Model(planar=flat)
    axis = 1.0 if flat else TURN[:, 2]
    node = model.node("bracket", (0.3, -0.2) if flat else AT)
    model.rigid_body("body", node, 2.0, 0.5 if flat else 0.5 * np.eye(3))
    model.revolute(node, **({} if flat else {"axis": axis}))
    model.sheave("wheel", node, 0.1, inertia=0.3, **({} if flat else {"axis": axis}))
    model.torque(node, 2.0 * axis, 1.0)
    result = simulate(model, 0.01, 0.5)
    rate = result["bracket.angular_velocity"].reshape(len(result.t), -1) @ np.atleast_1d(axis)
    assert rate[-1] == pytest.approx(2.0 / 0.5 * 0.5, rel=1e-9)
    assert result["wheel.rate"] == pytest.approx(-rate, abs=1e-9)


def tangent_length(points, radii, signs):
    """Length of a rope past circles, by tangents that are found as zeros of their angles."""
    def contact(k, angle):
        """Where a rope that travels along an angle touches circle k."""
        return points[k] + radii[k] * signs[k] * np.array([np.sin(angle), -np.cos(angle)])

    angles = []
    for k in range(len(points) - 1):
        d = points[k + 1] - points[k]
        middle = np.arctan2(d[1], d[0])

        def off(angle, k=k):
            gap = contact(k + 1, angle) - contact(k, angle)
            return gap[0] * np.sin(angle) - gap[1] * np.cos(angle)
        angles.append(brentq(off, middle - 1.5, middle + 1.5, xtol=1e-15))
    total = sum(np.linalg.norm(contact(k + 1, a) - contact(k, a)) for k, a in enumerate(angles))
    for k in range(1, len(points) - 1):
        total += radii[k] * ((signs[k] * (angles[k] - angles[k - 1])) % (2 * np.pi)) if (
            radii[k]) else 0.0
    return total


@pytest.mark.parametrize("flat", [False, True])
def test_length_and_force_past_sheaves_and_a_ring(flat):
    """Against tangents found by bisection; the force on a node is the slope of the energy."""
    places = {"a": (-2.0, -1.0), "p": (-1.0, 1.0), "q": (0.6, 0.2), "r": (2.0, 1.4),
              "s": (3.0, -0.5), "b": (4.5, 0.3)}
    radii, sides = [0, 0.3, 0.25, 0, 0.4, 0], [0, -1, 1, 0, 1, 0]
    stiffness, length = 2e4, 9.9
    model = hung(places, {"b": 40.0}, {"p": 0.3, "q": 0.25, "s": 0.4}, flat)
    model.rope("rope", ("a", "wheel p", "wheel q", "r", "wheel s", "b"), stiffness,
               length=length, wrap="-++")
    result = simulate(model, 0.002, 0.3)
    points = np.array(list(places.values()))

    def way(end):
        return tangent_length(np.vstack([points[:-1], end]), radii, sides)
    for k in (0, 40, 90):
        place = result["b.position"][k]
        end = place if flat else (TURN.T @ (place - AT))[:2]
        assert result["rope.length"][k] == pytest.approx(way(end), rel=1e-10)
        tension = max(stiffness * (way(end) / length - 1), 0.0)
        assert result["rope.tension"][k] == pytest.approx(np.full(5, tension), rel=1e-9)
        slope = np.array([way(end + d) - way(end - d) for d in 1e-6 * np.eye(2)]) / 2e-6
        force = result["b.acceleration"][k]
        if not flat:
            force = (TURN.T @ force)[:2]
        assert force == pytest.approx(-tension * slope / 40 + (0, -G), abs=1e-7 * tension)
    assert result["energy.external_work"] == pytest.approx(0.0, abs=1e-12)


def test_slack_and_taut_again():
    """A mass falls freely until its rope is taut, and then moves as on a spring.

    Without damping energy is kept; the speed at which the rope becomes slack again is the same.
    """
    mass, stiffness, length, drop = 2.0, 4e3, 1.5, 0.5
    model = hung({"p": (0, 0), "a": (0, -drop)}, {"a": mass})
    model.rope("rope", ("p", "a"), stiffness, length=length)
    result = simulate(model, 2e-4, 1.2)
    k = stiffness / length
    t1 = np.sqrt(2 * (length - drop) / G)
    v1, w, sag = G * t1, np.sqrt(k / mass), mass * G / k
    t = result.t
    fall = drop + G * t**2 / 2
    t_up = t1 + 2 / w * (np.pi - np.arctan2(v1 / w, sag))
    y = np.where(t < t1, fall, length + sag * (1 - np.cos(w * (t - t1)))
                 + v1 / w * np.sin(w * (t - t1)))
    y = np.where(t < t_up, y, length - v1 * (t - t_up) + G * (t - t_up)**2 / 2)
    assert -heights(model, result, "a") == pytest.approx(y, abs=2e-4)
    slack = result["rope.elongation"] < 0
    assert slack[0] and slack[-1] and not slack.all()
    assert not result["rope.tension"][slack].any() and (result["rope.tension"] >= 0).all()
    energy = sum(result[f"energy.{kind}"] for kind in ("kinetic", "strain", "potential"))
    assert energy == pytest.approx(energy[0], abs=2e-4 * mass * G)


def test_drum_winds_its_rope():
    """A drum that a drive turns: what it takes up lifts the load, and the work is the energy."""
    mass, radius, stiffness = 5.0, 0.25, 3e5
    model = Model()
    model.node("hub", AT)
    model.rigid_body("drum", "hub", 4.0, (0.2, 0.2, 0.1))
    model.revolute("hub", TURN[:, 2], name="axle")
    model.node("load", turned(radius, -6.0), "translation")
    model.point_mass("mass", "load", mass)
    model.gravity(TURN @ (0, -G, 0))
    model.sheave("barrel", "hub", radius, axis=TURN[:, 2])
    model.rope("rope", ("barrel", "load"), stiffness, damping=300.0, pretension=mass * G, wrap="-")
    turn = 20.0     # rad, more than three turns
    model.drive_angle("axle", lambda t: 20.0 * (t / 4.0)**3 * (10 - 15 * t / 4 + 6 * (t / 4)**2),
                      name="motor")
    result = simulate(model, 2e-3, 4.0)
    free = result["rope.length"] - result["rope.elongation"]
    assert free[0] - free[-1] == pytest.approx(turn * radius, rel=1e-4)
    energy = sum(result[f"energy.{kind}"] for kind in ("kinetic", "strain", "potential"))
    supplied = result["motor.work"] + result["rope.work"]

    assert energy - energy[0] == pytest.approx(supplied, abs=1e-8 * mass * G * turn * radius)
    lifted = heights(model, result, "load")
    assert lifted[-1] - lifted[0] == pytest.approx(turn * radius, rel=2e-4)


def test_equilibrium_of_a_hanging_ring():
    """A ring with a weight on a rope between two points: the way is the shortest for its sag."""
    model = hung({"a": (-1, 0), "ring": (0.4, -1.0), "b": (1, 0.3)}, {"ring": 20.0})
    model.rope("rope", ("a", "ring", "b"), 5e4, length=2.8)
    found = equilibrium(model)
    a, b, ring = (TURN.T @ (p - AT) for p in (
        model.nodes["a"].point, model.nodes["b"].point, found["ring.position"][-1]))
    one, other = (a - ring) / np.linalg.norm(a - ring), (b - ring) / np.linalg.norm(b - ring)
    pull = 20.0 * G / (one + other)[1]
    assert found["rope.tension"][-1] == pytest.approx([pull, pull], rel=1e-8)
    assert (one + other)[0] == pytest.approx(0.0, abs=1e-9)
    assert found["rope.elongation"][-1] == pytest.approx(2.8 * pull / 5e4, rel=1e-7)


def test_a_rope_that_should_leave_its_sheave_is_told():
    """A weight swings up until its rope is straight past the sheave."""
    model = hung({"a": (-1, -0.2), "p": (0, 0), "b": (1, -0.2)}, {"b": 1.0}, {"p": 0.1})
    model.initial_velocity("b", TURN @ (0, 4.0, 0))
    model.rope("rope", ("a", "wheel p", "b"), 1e4, pretension=5.0, wrap="-")
    with pytest.warns(LimitWarning, match="rope 'rope' should have left sheave 'wheel p' at t ="):
        result = simulate(model, 1e-3, 0.22)
    wraps, ends = result["rope.wraps"], result["b.position"]
    first, last = ((TURN.T @ (ends[k] - AT))[:2] for k in (0, -1))
    assert wraps[0] > 0 > wraps[-1]

    def leaving(end):
        return np.arctan2(end[1], end[0]) - np.arcsin(0.1 / np.linalg.norm(end))
    assert (wraps[0] - wraps[-1]).item() == pytest.approx(leaving(last) - leaving(first), abs=1e-9)


def test_three_falls_on_a_flexible_boom():
    """Against the least energy of the boom's tip and the load, with a rope of the same length."""
    section = rectangle(0.2, 0.1, youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
    model = Model()
    for name, point in (("root", (0, 0, 0)), ("tip", (4, 0, 0))):
        model.node(name, turned(*point))
    model.beam("boom", ("root", "tip"), section, elements=4, bodies=1, modes=2, up=TURN[:, 2])
    model.fix("root")
    stiffness, mass, drop, weight = 3e5, 150.0, 3.0, 150.0 * G
    model.node("hook", turned(4, -drop), "translation")
    model.point_mass("load", "hook", mass)
    model.rope("rope", ("tip", "hook", "tip", "hook"), stiffness, length=3 * drop)
    bare = Model()
    for name, point in (("root", (0, 0, 0)), ("tip", (4, 0, 0))):
        bare.node(name, turned(*point))
    bare.beam("boom", ("root", "tip"), section, elements=4, bodies=1, modes=2, up=TURN[:, 2])
    bare.fix("root")
    for made in (model, bare):
        made.gravity(TURN @ (0, -G, 0))
    bare.force("tip", TURN @ (0, -1, 0), weight)
    found, pressed = equilibrium(model), equilibrium(bare)
    assert found["tip.position"][-1] == pytest.approx(pressed["tip.position"][-1], abs=1e-9)
    pull = weight / 3
    gap = found["tip.position"][-1] - found["hook.position"][-1]
    assert np.linalg.norm(gap) == pytest.approx(drop * (1 + pull / stiffness), rel=1e-9)
    assert found["rope.tension"][-1] == pytest.approx(3 * [pull], rel=1e-9)


def pulled(factor=1.0):
    """A weight that a torque on a drum hauls up over a sheave."""
    model = hung({"p": (0, 0), "q": (1.5, 0.2), "a": (-0.2, -1)}, {"a": 3.0}, {"p": 0.2})
    model.node("hub", turned(1.5, 0.2))
    model.rigid_body("drum", "hub", 3.0, (0.02, 0.02, 0.02))
    model.revolute("hub", TURN[:, 2], name="axle")
    model.sheave("barrel", "hub", 0.1, axis=TURN[:, 2])
    model.rope("rope", ("a", "wheel p", "barrel"), 1e5, damping=10.0, wrap="-")
    model.torque("hub", -2.5 * TURN[:, 2], factor, name="push")
    return model


def test_gradients_are_those_of_differences():
    scheme, h, end = generalized_alpha(index=3), 0.002, 0.2
    wanted = {"x": final("a.position.y"), "T": final("rope.tension.0")}
    found = gradient(pulled(), h, end, wanted, ["push.amplitude"], scheme=scheme).matrix[:, 0]
    ends = [simulate(pulled(factor), h, end, scheme=scheme) for factor in (1 - 1e-4, 1 + 1e-4)]
    for k, values in enumerate(([one["a.position"][-1, 1] for one in ends],
                                [one["rope.tension"][-1, 0] for one in ends])):
        assert found[k] == pytest.approx((values[1] - values[0]) / 2e-4, rel=1e-5)


def test_a_run_goes_on_from_a_file(tmp_path):
    """To the same numbers, turns of the drum included."""
    whole, half = simulate(pulled(), 0.002, 0.1), Simulation(pulled(), 0.002)
    half.run_to(0.05)
    other = resume(pulled(), save_state(half, tmp_path / "state.npz"))
    other.run_to(0.1)
    for name in ("a.position", "rope.tension", "rope.elongation", "rope.wraps"):
        assert np.array_equal(other.result()[name][-1], whole[name][-1])


@pytest.mark.parametrize("how", [{"until": 0.1}, {"breaks_at": 20.0}])
def test_a_load_on_a_rope_lets_go(how):
    """It flies on a parabola, and the drum goes on from what it has wound."""
    model = pulled()
    model.node("crate", model.nodes["a"].point, "translation")
    model.point_mass("cargo", "crate", 2.0)
    model.spherical("crate", "a", name="grip", **how)
    result = simulate(model, 0.002, 0.3)
    (time, what, lost), = result.events
    assert what == ("grip let go" if "until" in how else "grip broke") and lost == 0.0
    gone = result.t > time
    assert gone.any() and not result["grip.force"][gone].any()
    s = (result.t[gone] - result.t[gone][0])[:, None]
    x, v = result["crate.position"][gone], result["crate.velocity"][gone]
    assert x == pytest.approx(x[0] + v[0] * s + TURN @ (0, -G, 0) * s**2 / 2, abs=1e-9)
    free = result["rope.length"] - result["rope.elongation"]        # what is not on the drum
    assert free - free[0] == pytest.approx(0.1 * result["axle.angle"], abs=1e-9)
    assert result.energy_balance() < 1e-4


def test_ropes_are_always_there():
    model = hung({"p": (0, 0), "a": (0, -1)}, {"a": 1.0})
    for until in ("until", "from_", "breaks_at", "release_when"):
        with pytest.raises(TypeError, match=f"rope has no {until}=: its arguments are name"):
            model.rope("rope", ("p", "a"), 1e4, **{until: 0.2})
        with pytest.raises(TypeError, match=f"sheave has no {until}=: its arguments are name"):
            model.sheave("wheel", "p", 0.1, axis=TURN[:, 2], **{until: 0.2})
    assert not model.ropes and not model.sheaves and not model.switches


@pytest.mark.parametrize("places, wrap, said", [
    (("a", "wheel p", "b"), "*", "give '+' or '-', or one of them for each of its 1 sheaves"),
    (("a", "wheel p", "b"), "+-", "give '+' or '-', or one of them for each of its 1 sheaves"),
    (("a",), "+", "rope 'rope' has 1 place: give the nodes and sheaves"),
    (("a", "q"), "+", "node or sheave 'q' is unknown"),
    (("a", "a", "b"), "+", "'a' and 'a' are at one point"),
    (("p", "wheel p"), "+", "'p' and 'wheel p' are at one point"),
    (("near", "wheel p"), "+", "'near' and 'wheel p' are 0.1 apart and overlap"),
    (("off", "wheel p"), "+", "it leaves the plane of sheave 'wheel p' by"),
    (("wheel p", "wheel t"), "+", "have axes that are not parallel")])
def test_refused(places, wrap, said):
    model = hung({"a": (-1, 0), "b": (1, 0), "p": (0, 1), "near": (0.1, 1), "off": (1, 1, 0.4),
                  "t": (2, 1)}, {}, {"p": 0.2})
    model.sheave("wheel t", "t", 0.1, axis=TURN[:, 1])
    with pytest.raises(InputError) as caught:
        model.rope("rope", places, 1e5, wrap=wrap)
    assert said in str(caught.value)
