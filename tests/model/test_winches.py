"""Winches that drives and actuators move, and falls against springs."""

import numpy as np
import pytest
from hanging import TURN, G, heights, hung, turned

from sebody import InputError, Model, simulate
from sebody.analysis import equilibrium
from sebody.control import pid
from sebody.fem import rectangle
from sebody.model.profiles import rest_to_rest
from sebody.model.variants import planar

MASS = 20.0


def hoist(form="space", **rope):
    """A weight on a rope from a winch over a ring."""
    model = hung({"p": (0, 0), "ring": (1.0, 0.5), "a": (1.0, -3)}, {"a": MASS},
                 flat=form == "plane")
    model.rope("rope", ("p", "ring", "a"), 2e5, damping=2e3, pretension=MASS * G, **rope)
    return model


@pytest.mark.parametrize("form", ["space", "plane"])
def test_a_controller_winds_a_rope_by_an_actuator(form):
    """To the length that it is told; its work is what the potential gains, at rest again."""
    model = hoist(form)
    model.actuator("winch", rope="rope", inertia=0.5, ratio=4.0, start=MASS * G / 4.0)
    model.sensor("length", "rope.length")
    model.controller("loop", pid(kp=-600.0, ki=-900.0, kd=-160.0,
                                 reference=3.5 + np.hypot(1.0, 0.5) - 1.0),
                     ["length"], ["winch"], period=2e-3)
    result = simulate(model, 1e-3, 6.0)
    raised = heights(model, result, "a")[-1] + 3.0
    assert raised == pytest.approx(1.0, abs=0.02)
    energy = sum(result[f"energy.{kind}"] for kind in ("kinetic", "strain", "potential"))
    work = result["winch.work"]
    assert energy - energy[0] == pytest.approx(work + result["rope.work"], abs=1e-4 * work[-1])
    assert work[-1] + result["rope.work"][-1] == pytest.approx(MASS * G * raised, rel=1e-3)


@pytest.mark.parametrize("form", ["space", "plane", "planar form"])
def test_work_of_an_actuator_is_the_energy(form):
    """A torque a little above that of the weight, which is accelerated with the winch."""
    model = hoist(form)
    model.actuator("winch", rope="rope", inertia=0.5, ratio=4.0, start=1.05 * MASS * G / 4.0)
    if form == "planar form":
        model = planar(model).model
    result = simulate(model, 5e-4, 0.5)
    energy = sum(result[f"energy.{kind}"] for kind in ("kinetic", "strain", "potential"))
    work = result["winch.work"]
    assert energy - energy[0] == pytest.approx(work + result["rope.work"], abs=1e-8 * work[-1])
    raised = heights(model, result, "a")[-1] + 3.0
    rate = 0.05 * MASS * G / (MASS + 0.5 * 4.0**2)      # of a stiff rope
    assert raised == pytest.approx(rate * 0.5**2 / 2, rel=0.02)
    assert work[-1] == pytest.approx(1.05 * MASS * G * raised, rel=0.01)


def test_a_winch_follows_a_drive():
    """Along a way: as with the same motion for its length."""
    def driven(length):
        model = hung({"p": (0, 0), "ring": (1.0, 0.5), "a": (1.0, -3)}, {"a": MASS})
        model.node("carriage", turned(-2, 0))
        model.rigid_body("slide", "carriage", 3.0, (0.1, 0.1, 0.1))
        model.prismatic("carriage", TURN[:, 0], name="rail")
        model.drive_slide("rail", rest_to_rest(-1.2, 1.0), name="ram")
        model.rope("rope", ("p", "ring", "a"), 2e5, damping=2e3, pretension=MASS * G,
                   length=length)
        return simulate(model, 1e-3, 1.0)
    found, expected = driven("ram"), driven(rest_to_rest(-1.2, 1.0))
    assert np.array_equal(found["rope.tension"], expected["rope.tension"])
    moved = found["carriage.position"][-1] - found["carriage.position"][0]
    given = np.diff((found["rope.length"] - found["rope.elongation"])[[0, -1]])
    assert np.abs(given) == pytest.approx(np.linalg.norm(moved), abs=1e-9)


@pytest.mark.parametrize("arguments, said", [
    ({"rope": "line", "inertia": 1.0}, "rope 'line' is unknown"),
    ({"rope": 3, "inertia": 1.0}, "give a rope or its name"),
    ({"rope": "rope"}, "its winch needs inertia="),
    ({"rope": "drum", "inertia": 1.0}, "rope 'drum' begins on a drum"),
    ({"rope": "wound", "inertia": 1.0}, "rope 'wound' has a winch already"),
    ({"rope": "rope", "node": "a"}, "acts on nothing, or on several things")])
def test_refused_winches(arguments, said):
    model = hoist()
    model.node("hub", turned(-3, 0))
    model.rigid_body("barrel", "hub", 1.0, (1, 1, 1))
    model.sheave("reel", "hub", 0.1, axis=TURN[:, 2])
    model.rope("drum", ("reel", "a"), 1e5)
    model.rope("wound", ("p", "a"), 1e5, length=lambda t: -0.1 * t)
    with pytest.raises(InputError) as caught:
        model.actuator("motor", **arguments)
    assert said in str(caught.value)
    assert not model.loads and "motor" not in model.own_names


def test_refused_drives():
    model = hoist()
    model.node("hub", turned(-3, 0))
    model.rigid_body("barrel", "hub", 1.0, (1, 1, 1))
    model.revolute("hub", TURN[:, 2], name="axle")
    model.drive_angle("axle", lambda t: t, name="turning")
    for name, said in (("turning", "drive 'turning' turns: lead the rope onto a drum"),
                       ("ram", "drive 'ram' is unknown: rope 'other': the model has turning")):
        with pytest.raises(InputError, match=said):
            model.rope("other", ("p", "a"), 1e5, length=name)


def boomed(falls):
    """A flexible boom with a load; `falls` add what carries it."""
    section = rectangle(0.2, 0.1, youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
    model = Model()
    for name, point in (("root", (0, 0)), ("tip", (4, 0))):
        model.node(name, turned(*point))
    model.beam("boom", ("root", "tip"), section, elements=4, bodies=1, modes=2, up=TURN[:, 2])
    model.fix("root")
    model.node("hook", turned(4.3, -3.0), "translation")
    model.point_mass("load", "hook", 150.0)
    model.gravity(TURN @ (0, -G, 0))
    falls(model)
    model.force("hook", TURN @ (1, 0.4, 0.3), lambda t: 300.0 * np.sin(9.0 * t))
    return model


def test_three_falls_are_springs_side_by_side():
    """In a motion that swings: n falls of a rope of the length L are a spring of n^2 E A / L."""
    stiffness, damping, way = 3e5, 600.0, 3 * np.hypot(0.3, 3.0)
    length = way / (1.0 + 500.0 / stiffness)

    def by_rope(model):
        model.rope("rope", ("tip", "hook", "tip", "hook"), stiffness, damping, length=length)

    def by_spring(model):
        model.spring("tip", "hook", 9.0 * stiffness / length, 9.0 * damping / length,
                     length=length / 3, name="rope")
    rested = [equilibrium(boomed(falls)) for falls in (by_rope, by_spring)]
    rope, spring = (simulate(boomed(falls), 5e-4, 0.5, start=start)
                    for falls, start in zip((by_rope, by_spring), rested, strict=True))
    assert (rope["rope.tension"] > 100.0).all()
    for name in ("tip.position", "hook.position"):
        moved = np.ptp(spring[name], axis=0).max()
        assert moved > 1e-3
        assert np.abs(rope[name] - spring[name]).max() < 1e-6 * max(moved, 1.0)
    assert rested[0]["tip.position"][-1] == pytest.approx(rested[1]["tip.position"][-1], abs=1e-8)
