"""The gallery: every scene says what to look at and has a test; physics of those with no other."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Result, simulate
from sebody.analysis import equilibrium
from sebody.assembly.numbering import number
from sebody.catalogue import builder, scenes
from sebody.quantities.names import split
from sebody.scenes import (
    ball_on_beam,
    blade,
    gripper,
    helical_spring,
    imported_link,
    journal_clearance,
    starter,
    stick_slip,
)

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def gallery():
    """The module that makes the pages."""
    sys.path.insert(0, str(ROOT / ".docs"))
    try:
        import gallery
        return gallery
    finally:
        sys.path.pop(0)


def run(scene, t_end=None) -> Result:
    return simulate(scene.model, scene.h, t_end or scene.t_end)


@pytest.mark.parametrize("name", scenes())
def test_a_scene_has_what_its_page_shows(gallery, name):
    scene = gallery.entry(name)
    assert scene.look and 1 <= len(scene.quantities) <= 4
    model = builder(name)().model
    parts = SimpleNamespace(model=model, numbering=number(model))
    assert all(split(parts, quantity) for quantity in scene.quantities)     # names that it has
    assert 10 <= len(scene.code.splitlines()) <= gallery.LONGEST
    assert gallery.tests_of(scene)


def test_a_ball_falls_and_a_plate_takes_it():
    """The time of free fall in closed form; contact and damping take energy, nothing gives any."""
    result = run(ball_on_beam.build())
    first = result.t[np.argmax(result["landing.normal_force"] > 0)]
    assert first == pytest.approx(np.sqrt(2 * 0.1 / 9.81), abs=1e-3)      # two steps
    energy = sum(result[f"energy.{kind}"] for kind in ("kinetic", "strain", "potential"))
    assert energy.max() - energy[0] < 1e-4 * np.ptp(result["energy.kinetic"])
    assert energy[-1] < energy[0] - 0.2 * np.ptp(result["energy.kinetic"])


def test_stick_slip_has_the_period_of_its_closed_form():
    """Sticking until k v t = mu_s m g, sliding about mu_d m g / k until the speeds are equal."""
    speed, static, dynamic, omega, weight = 0.1, 0.4, 0.3, 10.0, 10.0
    result = run(stick_slip.build(speed, static, dynamic))
    sticks = result["dry.sticks"] > 0.5
    ends = result.t[1:][sticks[:-1] & ~sticks[1:]]
    low, high = dynamic * weight / omega**2, static * weight / omega**2
    slides = (2 * np.pi - 2 * np.arctan2(omega * (high - low), speed)) / omega
    rides = 2 * (high - low) / speed
    assert ends[0] == pytest.approx(high / speed, abs=2e-3)
    assert np.diff(ends) == pytest.approx(slides + rides, abs=2e-3)         # two steps


def test_friction_holds_what_it_can():
    """Four contacts, of which each carries half of a jaw's force."""
    held, lost = run(gripper.build(0.5)), run(gripper.build(0.05))
    assert held["left low grip.normal_force"][-1] == pytest.approx(10.0, rel=1e-6)
    assert held["block.position.y"][-1] == pytest.approx(0.03 + 0.15, abs=2e-3)
    assert lost["block.position.y"][-1] < 0.031     # 4 x 0.05 x 10 N are less than its weight


def test_a_clearance_moves_the_slider_by_no_more_than_itself():
    """Beside the slider-crank without clearance, whose motion is known."""
    clearance, r, rod = 0.5e-3, journal_clearance.CRANK, journal_clearance.ROD
    result = run(journal_clearance.build(clearance))
    angle = journal_clearance.SPEED * result.t
    ideal = r * np.cos(angle) + np.sqrt(rod**2 - (r * np.sin(angle))**2)
    lean = np.sqrt(1 + (r / rod)**2 / (1 - (r / rod)**2))       # of the rod, at most
    away = np.abs(result["slider.position.x"] - ideal).max()
    assert 0.5 * clearance < away < 1.2 * lean * clearance      # and the bearing gives way
    assert -0.2 * clearance < result["clearance.gap"].min()


def test_an_imported_coupler_moves_as_the_linkage_of_rigid_bars():
    """Loop closure of the four-bar, but for what the coupler deforms."""
    result = run(imported_link.build())
    first, second = (result[f"interface {k}.position"] for k in (0, 1))
    crank, rocker = (result.model.nodes[name].point for name in ("crank", "rocker"))
    assert np.linalg.norm(first - second, axis=1) == pytest.approx(1.0, rel=1e-4)
    for pin, centre, length in ((first, crank, 0.3), (second, rocker, 0.6)):
        assert np.linalg.norm(pin - centre, axis=1) == pytest.approx(length, rel=1e-9)
    assert first[-1] == pytest.approx(first[0], abs=1e-6)       # one whole turn
    assert second[-1] == pytest.approx(second[0], abs=1e-3)


def test_the_starter_lifts_its_load():
    """Work of the motor, the push and the damping against the weight that was lifted."""
    result = run(starter.build())
    assert result["hinge.angle"][-1] == pytest.approx(np.pi / 2, abs=1e-6)
    beam = 0.8 * 0.006 * 0.03 * 2700.0
    lifted = 9.81 * (0.2 * 0.8 + beam * 0.4)
    assert result["energy.potential"][-1] - result["energy.potential"][0] == pytest.approx(
        lifted, rel=2e-3)
    assert result["motor.work"][-1] == pytest.approx(lifted, rel=0.03)      # it still vibrates


def test_a_helical_spring_has_the_stiffness_of_its_formula():
    """G d^4 / (8 D^3 n), with half the weight of the wire; unwinding as it is stretched."""
    scene = helical_spring.build()
    E, nu, density = helical_spring.STEEL
    d, D = 0.005, helical_spring.DIAMETER
    stiffness = E / (2 + 2 * nu) * d**4 / (8 * D**3 * 4)
    wire = np.pi / 4 * d**2 * density * helical_spring.helix(4.0).length
    rest = equilibrium(scene.model)
    fallen = scene.model.nodes["weight"].point - rest["weight.position"][-1]
    assert abs(fallen[2] / ((2.0 + wire / 2) * 9.81 / stiffness) - 1) < 0.01
    result = run(scene, 0.1)
    lowest = result["weight.position"][:, 2].min() - scene.model.nodes["weight"].point[2]
    assert abs(-lowest / (2 * fallen[2]) - 1) < 0.03        # some of it is damped
    assert rest["weight.rotation"][-1][1, 0] > 1e-3         # the helix turns about z, downwards


def test_four_bodies_of_a_blade_move_as_nonlinear_beams():
    """Within 1 % of how far the tip is bent from the place of a rigid blade."""
    tips = []
    for options in ({}, {"bodies": 32, "modes": 0}):
        scene = blade.build(**options)
        result = run(scene, 6.0)
        tips.append(result["tip.position"])
    turns = Rotation.from_rotvec(np.outer(result["hub.angle"], [1.0, 0, 0]))
    bent = np.abs(tips[1] - turns.apply(scene.model.nodes["tip"].point)).max()
    assert bent > 0.05
    assert np.abs(tips[0] - tips[1]).max() < 0.01 * bent
