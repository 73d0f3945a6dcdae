"""Wheels that stand for gears: they touch, and roll on each other with the rates of the gear."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.pictures.contact_surfaces import vertices_of
from sebody.pictures.gear_wheels import belt, gearing
from sebody.pictures.scene import scenery

TURN = Rotation.from_rotvec([0.5, -0.8, 0.4]).as_matrix()
SHIFT = np.array([3.0, -2.0, 1.0])
SIZE = 2.0
Z = np.array([0.0, 0.0, 1.0])
MET = np.array([0.3, 0.6, 0.5]) / np.linalg.norm([0.3, 0.6, 0.5])
# points, axes and ratio, in axes that are turned and shifted
ROLLING = {
    "beside": ([(0, 0, 0.3), (1, 0.5, 0)], (Z, Z), -1.7),
    "beside, axes opposed": ([(0, 0, 0.3), (1, 0.5, 0)], (Z, -Z), 1.7),
    "second in a ring": ([(0, 0, 0), (0.4, 0.1, 0)], (Z, Z), 0.4),
    "first in a ring": ([(0, 0, 0), (0.4, 0.1, 0)], (Z, -Z), -2.5),
    "cones": ([0.7 * Z, 1.1 * MET], (Z, MET), -1.6),
    "cones, axes opposed": ([0.7 * Z, 1.1 * MET], (Z, -MET), 0.8),
    "inside of a cone": ([0.9 * Z, 1.1 * MET], (Z, MET), 2.5)}


def made(points, axes, ratio):
    return gearing(np.array(points, dtype=float) @ TURN.T + SHIFT, np.array(axes) @ TURN.T, ratio,
                   SIZE)


@pytest.mark.parametrize("case", ROLLING)
def test_wheels_touch_and_roll_on_each_other(case):
    points, axes, ratio = ROLLING[case]
    found = made(points, axes, ratio)
    one, other = found.wheels
    places = [wheel.centre + wheel.radius * wheel.towards for wheel in found.wheels]
    assert places[0] == pytest.approx(places[1], abs=1e-12)
    speeds = [rate * np.cross(wheel.axis, wheel.radius * wheel.towards)
              for rate, wheel in zip((ratio, 1.0), found.wheels, strict=True)]
    assert speeds[0] == pytest.approx(speeds[1], abs=1e-12) and np.linalg.norm(speeds[0]) > 0.1
    for wheel, point, axis in zip(found.wheels, points, axes, strict=True):     # on its shaft
        away = wheel.centre - SHIFT - TURN @ point
        assert np.cross(away, TURN @ axis) == pytest.approx(0.0, abs=1e-12)
        assert wheel.towards @ wheel.axis == pytest.approx(0.0, abs=1e-12)
    rings = [wheel.ring for wheel in found.wheels]
    assert any(rings) == ("ring" in case) and not found.belt
    if any(rings):
        assert rings[0] == (one.radius > other.radius)


def test_a_belt_joins_wheels_of_one_sense_that_would_be_large():
    found = made([(0, 0, 0), (1, 0.5, 0)], (Z, Z), 0.9)
    one, other = found.wheels
    assert found.belt and other.radius == pytest.approx(0.9 * one.radius)
    for a, b in belt(one, other).points.reshape(2, 2, 3):       # touch both, at right angles
        for end, wheel in ((a, one), (b, other)):
            assert np.linalg.norm(end - wheel.centre) == pytest.approx(wheel.radius)
            assert (end - wheel.centre) @ (b - a) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("points, axes", [
    ([(0, 0, 0), (0, 0, 1)], (Z, Z)), ([(0, 0, 0), (0, 0, 0)], (Z, MET)),
    ([(0, 0, 0), (1, 0.5, 0)], (Z, MET))], ids=["coaxial", "one place", "crossed"])
def test_wheels_are_drawn_whatever_the_shafts(points, axes):
    found = made(points, axes, -1.7)
    for wheel in found.wheels:
        assert np.isfinite(wheel.centre).all() and 0.0 < wheel.radius < SIZE


def test_wheels_turn_with_their_shafts():
    """Points of their rims go ways of one length."""
    model = Model(planar=True)
    for name, place in (("a", (0.3, -0.2)), ("b", (1.1, 0.1))):
        model.rigid_body(f"wheel {name}", model.node(name, place), 1.0, 0.1)
        model.revolute(name, name=f"shaft {name}")
    model.torque("a", 1.0, [(0, 0), (0.2, 1.0)])
    model.gear("shaft a", "shaft b", ratio=-2.0, backlash=1e-3, at_speed=10.0, name="teeth")
    result = simulate(model, 5e-3, 0.8)
    drawn = scenery(result, 3)
    wheels = [one for one in drawn.contacts if one.kind == "gear"]
    assert [one.node for one in wheels] == ["a", "b"] and wheels[0].name == "teeth"
    assert len(result.t) > 100 and abs(result["shaft a.angle"][-1]) > 1.0
    ways = []
    for one in wheels:
        tips = [vertices_of(one, drawn.nodes, k)[0] - drawn.nodes[one.node].position[k]
                for k in (0, -1)]
        start, end = (np.arctan2(tip[1], tip[0]) for tip in tips)
        turned = (end - start) % (2 * np.pi)
        ways.append(np.linalg.norm(tips[0]) * (turned if one.node == "a" else turned - 2 * np.pi))
    assert ways[0] == pytest.approx(-ways[1], abs=2e-3) and ways[0] > 0.2
