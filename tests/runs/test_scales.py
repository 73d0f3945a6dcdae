"""Scales come from the size of a model: where it is, its units and its axes do not matter."""

import warnings
from functools import cache

import numpy as np
import pytest

from sebody import LimitWarning, Model, Simulation, Tolerance, harmonic, ramp, simulate
from sebody.fem import Section, straight_beam
from sebody.model.extent import extent
from sebody.reduction import craig_bampton

STEEL = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7.8e3}


def pushed(place, length=1.0, inertia=True):
    """A body at a place, with a force sin 3t that moves it by some of its own lengths."""
    model = Model()
    node = model.node("weight", np.asarray(place) * length)
    if inertia:
        model.rigid_body("weight", node, 2.0, np.array([0.1, 0.2, 0.25]) * length**2)
    else:
        model.point_mass("weight", node, 2.0)
        model.fix(node, "rotation")
    model.force(node, (0.6 * length, 0.0, 0.8 * length), harmonic(1.0, 3.0))
    return model


@pytest.mark.parametrize("axis", np.random.default_rng(7).normal(size=(40, 3)))
def test_a_hinge_at_the_origin(axis):
    """Where no coordinate has a size, rounding of the axes is compared with one."""
    model = Model()
    model.rigid_body("body", model.node("hinge", (0.0, 0.0, 0.0)), 1.0, (0.1, 0.2, 0.15))
    model.revolute("hinge", axis, explicit=True)
    model.torque("hinge", axis)
    size = np.linalg.norm(axis)
    J = (axis / size)**2 @ [0.1, 0.2, 0.15]
    spin = Simulation(model, 0.01).result()["hinge.angular_acceleration"][0]
    assert spin == pytest.approx(axis / J, rel=1e-12)


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (3.0, -1.0, 2.0), (1e4, 0.0, 0.0)])
@pytest.mark.parametrize("length", [1.0, 1e3])
def test_variable_steps_at_the_origin_and_far_from_it(place, length):
    """The same steps, with the error the tolerance allows: its length is the radius of gyration."""
    model = pushed(place, length)
    assert extent(model) == pytest.approx(np.sqrt(0.25 / 2.0) * length)
    result = simulate(model, 0.5, 10.0, tolerance=Tolerance(1e-5))
    assert result.steps == simulate(pushed((1.0, 0.0, 0.0)), 0.5, 10.0,
                                    tolerance=Tolerance(1e-5)).steps > 300
    t = result.t
    moved = (result["weight.position"] - np.asarray(place) * length) @ [0.6, 0.0, 0.8] / length
    assert np.abs(moved - (t / 6.0 - np.sin(3.0 * t) / 18.0)).max() < 2e-3


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (5.0, 0.0, 0.0)])
def test_nothing_has_a_length(place):
    """A point without anything: one unit of length, which is said; an absolute error is better."""
    model = pushed(place, inertia=False)
    with pytest.warns(LimitWarning, match="the model has no characteristic length: errors of "
                      r"positions are relative to one unit of length; .* "
                      r"Tolerance\(1e-3, position=1e-6\)"):
        result = simulate(model, 0.5, 10.0, tolerance=Tolerance(1e-5))
    t = result.t
    moved = (result["weight.position"] - np.asarray(place)) @ [0.6, 0.0, 0.8]
    assert result.steps > 200 and np.abs(moved - (t / 6.0 - np.sin(3.0 * t) / 18.0)).max() < 2e-3
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        finer = simulate(model, 0.5, 10.0, tolerance=Tolerance(1e-5, position=3.5e-7))
        assert finer.steps > 1.5 * result.steps
        assert simulate(model, 0.01, 0.1).steps == 10       # fixed steps need none


def test_extents():
    """Nodes, ground points, bodies, springs: whichever is largest."""
    model = Model()
    model.rigid_body("a", model.node("a", (1.0, 1.0, 1.0)), 2.0, (0.5, 0.5, 0.5))
    assert extent(model) == pytest.approx(0.5)
    model.rigid_body("b", model.node("b", (1.0, 4.0, 5.0)), 2.0, (0.5, 0.5, 0.5))
    assert extent(model) == pytest.approx(5.0)
    model.spring("a", "b", 3.0, length=8.0)
    assert extent(model) == pytest.approx(8.0)


# drives that start with speed

DISC, SPEED = 50.0, 100.0


@cache
def shaft(diameter, start, end, modes):
    moment = np.pi * diameter**4 / 64
    section = Section(area=np.pi * diameter**2 / 4, inertia_y=moment, inertia_z=moment,
                      torsion=2.0 * moment, **STEEL)
    return craig_bampton(straight_beam(start, end, section, elements=4),
                         [(0, "full"), (4, "full")], modes=modes)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (1.0, 2.0, -0.5)])
@pytest.mark.parametrize("diameter, parts, modes", [
    (0.03, 1, 4), (0.01, 3, 4), (1e-3, 1, 4), (1e-3, 3, 0), (1e-4, 3, 4)])
def test_light_shafts_carry_what_hangs_on_them(diameter, parts, modes, axis):
    """A disc of 50 at the end of a shaft with 0.1 to 1e-6 of its mass, 1e-15 of its inertia."""
    e = np.array(axis) / np.linalg.norm(axis)
    model, place = Model(), np.array([0.2, 0.3, -0.1])
    nodes = [model.node(f"n{k}", place + k / parts * e) for k in range(parts + 1)]
    for k in range(parts):
        body = shaft(diameter, tuple(nodes[k].point), tuple(nodes[k + 1].point), modes)
        model.superelement(f"shaft {k}", body, nodes[k:k + 2])
    model.rigid_body("disc", nodes[-1], DISC, (2.0, 2.0, 2.0), centre=nodes[-1].point + 0.1 * e)
    # a light lid on a hinge of its own that rests: it may, and does
    lid = model.node("lid", nodes[-1].point)
    model.rigid_body("lid", lid, 1e-3, (1e-6, 1e-6, 1e-6))
    model.revolute(lid, e, to=nodes[-1], explicit=True)
    model.revolute(nodes[0], e, explicit=True)
    model.drive_angle(nodes[0], ramp(SPEED), e)
    result = Simulation(model, 1e-4).result()
    for k in range(parts + 1):
        assert result[f"n{k}.angular_velocity"][0] @ e == pytest.approx(SPEED, rel=1e-9)
    assert abs(result["lid.angular_velocity"][0] @ e) < 1e-6 * SPEED
    assert np.abs(result["constraints.velocity"]).max() < 1e-9 * SPEED
    assert result.start.changed["n1.rotation"] == pytest.approx(SPEED * np.abs(e).max(),
                                                                rel=1e-9)     # of a coordinate


def test_what_has_to_deform_deforms():
    """Both ends of a bar given: it stretches evenly, and what is given stays."""
    model = Model()
    nodes = [model.node(f"n{k}", (float(k), 0.2, 0.1)) for k in range(3)]
    for k in range(2):
        body = shaft(0.01, tuple(nodes[k].point), tuple(nodes[k + 1].point), 0)
        model.superelement(f"bar {k}", body, nodes[k:k + 2])
    model.initial_velocity(nodes[2], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    model.move(nodes[0], (1.0, 0.0, 0.0), ramp(1.0))
    model.fix(nodes[0], "rotation")
    result = Simulation(model, 1e-4).result()
    assert result["n2.velocity"][0] == pytest.approx(np.zeros(3), abs=1e-6)
    assert result["n1.velocity"][0] == pytest.approx([0.5, 0.0, 0.0], abs=1e-4)


@pytest.mark.parametrize("mass", [1e-15, 1e15])
def test_masses_of_any_unit_beside_joint_equations(mass):
    """Below 1e-13 a body on a slide was taken for one without mass: wrong by 5 % in silence."""
    def end(mass):
        model = Model()
        model.rigid_body("body", model.node("a", (0, 0, 0)), mass,
                         mass * np.array([0.1, 0.12, 0.15]))
        model.prismatic("a", axis=(1.0, 0.2, 0.3))
        model.force("a", (1, 2, 3), [(0, mass), (1, 2 * mass)])
        return simulate(model, 1e-3, 0.02)["a.position"][-1]
    assert end(mass) == pytest.approx(end(1.0), rel=1e-12)


def test_small_bodies_beside_modal_masses_of_one():
    """A beam of ten micrometres in metres was taken for one without mass, 6e-6 off in silence."""
    def end(length, mass):
        model = Model()
        ends = [model.node(name, np.array(place) * length)
                for name, place in (("a", (0.0, 0.0, 0.0)), ("b", (0.8, 0.5, 0.3)))]
        section = Section(area=0.01 * length**2, inertia_y=1e-5 * length**4,
                          inertia_z=2e-5 * length**4, torsion=2e-5 * length**4,
                          youngs_modulus=2e9 * mass / length, poisson_ratio=0.3,
                          density=7.8e3 * mass / length**3)
        model.beam("beam", ends, section, 6, 1, 3, stiffening=False)
        model.cylindrical("a", axis=(1.0, 0.2, 0.3))
        model.gravity(np.array([1.0, -9.0, 3.0]) * length)
        return simulate(model, 1e-3, 0.02)["b.position"][-1] / length
    assert end(1e-5, 1e-18) == pytest.approx(end(1.0, 1.0), rel=1e-12)
