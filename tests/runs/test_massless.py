"""MacNeal's bodies move parts of themselves without mass: no axes and no units matter to that."""

from functools import partial

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import (
    InputError,
    Model,
    Simulation,
    SimulationError,
    Tolerance,
    generalized_alpha,
    harmonic,
    plane,
    ramp,
    simulate,
)
from sebody.fem import Section, straight_beam
from sebody.reduction import reduce

TURN = Rotation.from_rotvec((0.4, -1.1, 0.7)).as_matrix()
AXIS = np.array([0.3, 0.1, 1.0])
STEP = 1e-3
# units of length, mass and time, and a rotation of all: none of it changes what is compared
PLACES = {"turned": (1.0, 1.0, 1.0, TURN), "large": (1e4, 1e12, 1e4, np.eye(3)),
          "small": (1e-5, 1e-15, 1e-5, TURN)}


def bar(length, mass, time, turn, method="macneal"):
    """A model with a hanging bar, and its first end."""
    model = Model()
    points = turn @ (0.0, 0.0, 0.0), turn @ (0.8, 0.4, 0.3)
    ends = [model.node(name, length * x) for name, x in zip("ab", points, strict=True)]
    section = Section(area=1.6e-3 * length**2, inertia_y=2e-7 * length**4,
                      inertia_z=3e-7 * length**4, torsion=4e-7 * length**4,
                      youngs_modulus=2e9 * mass / length / time**2, poisson_ratio=0.3,
                      density=4e3 * mass / length**3)
    model.superelement("bar", reduce(straight_beam(
        *(end.point for end in ends), section, elements=5, up=turn @ (0.1, 0.3, 1.0)),
        [(0, "full"), (5, "full")], 2, method), ends, inertia="rigid_part", stiffening=False)
    model.gravity(turn @ (1.0, -9.0, 3.0) * length / time**2)
    return model, ends[0]


def pushed(length, mass, time, turn):
    """Clamped, with a load that jumps at its other end."""
    model, first = bar(length, mass, time, turn)
    model.fix(first)
    model.force("b", turn @ (3.0, 1.0, -2.0) * mass * length / time**2,
                np.array([(0.0, 0.3), (0.02, 1.0), (0.02, -1.0), (0.1, 0.5)]) * (time, 1.0))
    return model


def rubbing(length, mass, time, turn):
    """On a slide with friction, whose bristles are as stiff as a step resolves."""
    model, first = bar(length, mass, time, turn)
    model.prismatic(first, turn @ AXIS, name="slide")
    model.friction("slide", 0.3, 0.4, preload=3.0 * mass * length / time**2)
    return model


def driven(length, mass, time, turn, method="macneal"):
    """On a hinge that starts with a speed."""
    model, first = bar(length, mass, time, turn, method)
    model.revolute(first, turn @ AXIS, explicit=True)
    model.drive_angle(first, ramp(3.0 / time), turn @ AXIS)
    return model


def path(build, length=1.0, mass=1.0, time=1.0, turn=None):
    """Where the free end is, in the first axes and units."""
    turn = np.eye(3) if turn is None else turn
    result = simulate(build(length, mass, time, turn), STEP * time, 30 * STEP * time,
                      generalized_alpha(tolerance=1e-11))
    return result["b.position"] @ turn / length


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("build", [pushed, rubbing, driven])
@pytest.mark.filterwarnings("ignore:vibrations of")
def test_neither_axes_nor_units_matter(build, place):
    """Least norms depended on both: 1e-2 of the motion, or no accelerations at all."""
    expected = path(build)
    moved = np.abs(expected - expected[0]).max()
    assert np.abs(path(build, *PLACES[place]) - expected).max() < 1e-8 * moved


@pytest.mark.filterwarnings("ignore:vibrations of")
def test_friction_holds_what_has_no_mass():
    """It slides as Rubin's body does, whose small masses vibrate with the bristles."""
    def rubin(length, mass, time, turn):
        model, first = bar(length, mass, time, turn, "rubin")
        model.prismatic(first, turn @ AXIS, name="slide")
        model.friction("slide", 0.3, 0.4, preload=3.0 * mass * length / time**2)
        return model
    expected = path(rubin)
    moved = np.abs(expected - expected[0]).max()
    assert np.abs(path(rubbing) - expected).max() < 2e-2 * moved


@pytest.mark.filterwarnings("ignore:vibrations of")
def test_small_bodies_of_any_method_follow_drives():
    """In units in which modal masses exceed all others, positions did not follow."""
    build = partial(driven, method="craig-bampton")
    assert path(build, *PLACES["small"]) == pytest.approx(path(build), abs=1e-9)


def test_no_constraint_is_redundant_for_want_of_mass():
    """Pivots that were rounding made a hinge of its equations redundant; runs did not start."""
    for seed in range(4, 7):        # rounding decided: of these three the second one
        model = Model()
        point = np.append(np.random.default_rng(seed).normal(size=2), 0.0)
        ends = [model.node("a", (0.0, 0.0, 0.0)), model.node("b", point)]
        section = Section(area=1.6e-3, inertia_y=0.04**4 / 12, inertia_z=0.04**4 / 9,
                          torsion=0.04**4 / 7, youngs_modulus=2e9, poisson_ratio=0.3, density=4e3)
        model.superelement("bar", reduce(straight_beam(
            *(end.point for end in ends), section, elements=5, up=(0.0, 0.0, 1.0)),
            [(0, "full"), (5, "full")], 4, "macneal"), ends, inertia="rigid_part",
            stiffening=False)
        model.revolute("a", explicit=True)
        model.gravity((1.0, -9.0, 0.0))
        start = Simulation(model, STEP).start
        assert start.redundant == ()


def door(hinges, explicit):
    """On hinges about one axis, in whose first the end of the bar lies."""
    model, first = bar(1.0, 1.0, 1.0, TURN)
    axis = TURN @ AXIS / np.linalg.norm(AXIS)
    model.revolute(first, axis, explicit=explicit, name="hinge")
    for k in range(1, hinges):
        model.attach(f"hinge {k}", first.point + 0.2 * k * axis, first)
        model.revolute(f"hinge {k}", axis, explicit=True)
    model.rigid_velocity(np.zeros(3), 3.0 * axis, about=first.point)
    return model


@pytest.mark.parametrize("explicit", [True, False])
@pytest.mark.parametrize("hinges, how", [(3, {}), (2, {"scheme": generalized_alpha(index=2)}),
                                         (2, {"tolerance": Tolerance(1e-4)})])
def test_redundant_hinges_change_nothing(hinges, how, explicit):
    """They were refused as contradicting each other, or by a raw RuntimeError of SuperLU.

    One hinge of shared positions is no equation, so fixed steps differ by what Newton's iteration
    leaves, and chosen steps by their tolerance.
    """
    alone, run = (simulate(door(*built), 2e-3, 0.3, **how)
                  for built in ((1, False), (hinges, explicit)))
    assert "redundant" in run.summary()
    apart = np.abs(run["b.position"] - alone["b.position"]).max()
    assert apart < (1e-3 if "tolerance" in how else 1e-6)


def test_hinges_that_contradict_each_other_are_refused():
    """Also without mass: here by the accelerations that two drives ask for."""
    model = door(2, True)
    for amplitude in (0.5, 1.0):        # one rate at the start
        drive = harmonic(amplitude, 6.0, np.arccos(0.5 / amplitude))
        model.drive_angle("a", drive, TURN @ AXIS)
    with pytest.raises(InputError, match="of angle at a.* contradict each other.*the same motion"):
        simulate(model, 2e-3, 0.3)


def meeting(method="macneal"):
    """On a hinge, its end on a hard plane."""
    model, first = bar(1.0, 1.0, 1.0, np.eye(3), method)
    model.revolute(first, AXIS)
    up = np.array([0.1, 1.0, 0.2]) / np.linalg.norm([0.1, 1.0, 0.2])
    model.contact("b", on=plane(up, np.array([0.8, 0.4, 0.3]) - 0.049 * up), radius=0.05,
                  stiffness=3e6, at_speed=1.0)
    return model


def followed(method="macneal"):
    """Clamped, with a load that is there from the start and turns with the end."""
    model, first = bar(1.0, 1.0, 1.0, TURN, method)
    model.weld(first)
    model.force("b", (3.0, 1.0, -2.0), follower=True)
    return model


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")    # hard contact, at this step
@pytest.mark.parametrize("build, tolerance, other",
                         [(meeting, None, "another step"),
                          (followed, Tolerance(1e-6), "a larger tolerance")])
def test_what_jumps_without_mass_is_told_what_helps(build, tolerance, other):
    """A mass and another method do, and give one motion."""
    with pytest.raises(SimulationError, match="^stopped at .* give their nodes a mass by .*, "
                                              f"reduce .*, such as rubin, or use {other}$"):
        simulate(build(), STEP, 0.02, tolerance=tolerance)
    model = build()
    model.rigid_body("lump", "b", 1e-2, 1e-5 * np.eye(3))
    # four times finer, as contacts are too hard for the step above
    ends = [simulate(one, STEP / 4, 0.1, tolerance=tolerance)["b.position"]
            for one in (model, build("rubin"))]
    moved = np.abs(ends[0] - ends[0][0]).max()
    # they bounce or vibrate: a mass of 1 % of the bar changes that by some percent
    assert moved > 1e-3 and np.abs(ends[0] - ends[1]).max() < 0.1 * moved
