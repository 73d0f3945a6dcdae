"""Everyday mechanisms with redundant joints and slender bodies, in general position.

Motions are compared with equations of their own, turned models in other units with plain ones.
"""

from functools import cache

import numpy as np
import pytest
from everyday import GRAVITY, MODELS, Place, door, double_pendulum, hung, rockers, rod
from helpers import order
from scipy.integrate import solve_ivp

from sebody import (
    InputError,
    SimulationError,
    Tolerance,
    generalized_alpha,
    simulate,
    simulate_within,
)
from sebody.analysis import equilibrium
from sebody.verify.outside import bricard

H, T_END = 0.01, 2.0
THIRTY = np.deg2rad(30.0)
ABOUT_X = np.array([[1, 0, 0], [0, np.cos(THIRTY), -np.sin(THIRTY)],
                    [0, np.sin(THIRTY), np.cos(THIRTY)]])
PLACES = {"about x": Place(ABOUT_X), "turned": Place.at_random(1),
          "mm, t, backwards": Place.at_random(2, length=1e3, mass=1e-3, backwards=True)}
FLAT = {"four-bar": 0.68, "parallelogram": 0.68}  # bars lie on one line soon after
EVERYDAY = pytest.mark.parametrize("name", MODELS)


@cache
def plain(name, h=H):
    return simulate(MODELS[name][0](Place()), h, T_END, output_every=round(H / h))


def followed(name, place, result):
    return place.back(result[f"{MODELS[name][1]}.position"])


def solved(rate, start, t):
    run = solve_ivp(rate, (0.0, t[-1]), start, t_eval=t, method="DOP853", rtol=1e-11, atol=1e-11)
    return run.y


def leaf(t):
    """A pendulum of inertia m b^2 / 3 about its hinge, which leans by 0.2 rad."""
    pull = 20.0 * GRAVITY * np.sin(0.2) * 0.4 / (20.0 * 0.8**2 / 3.0)
    angle = solved(lambda _, y: [y[1], -pull * np.cos(y[0])], (0.0, 0.0), t)[0]
    return np.column_stack([0.75 * np.cos(angle), 0.75 * np.sin(angle), np.ones(t.size)])


def sliding(t):
    return np.column_stack([0.5 * GRAVITY * np.sin(0.1) * t**2, 0.0 * t, 0.5 + 0.0 * t])


def rocking(count, start=np.pi / 2):
    """Rockers of mass 1 and length 1 that carry a coupler of mass 1 without turning it."""
    def place(t):
        pull = (count / 2 + 1) * GRAVITY / (count / 3 + 1)
        angle = solved(lambda _, y: [y[1], -pull * np.cos(y[0])], (start, -1.0), t)[0]
        return np.column_stack([np.cos(angle), np.sin(angle), 0.0 * t])
    return place


def swinging(t):
    """A square of four rods about a corner: inertia 10/3, mass 4, its centre half a side away."""
    angle = solved(lambda _, y: [y[1], -0.6 * GRAVITY * (np.cos(y[0]) + np.sin(y[0]))],
                   (0.0, 0.0), t)[0]
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c + s, s - c, 0.0 * t])


def two_rods(t):
    """Two slender rods, by the angles of both against the horizontal."""
    def rate(_, y):
        d = y[0] - y[1]
        mass = [[4 / 3, np.cos(d) / 2], [np.cos(d) / 2, 1 / 3]]
        force = [-np.sin(d) / 2 * y[3]**2 - 1.5 * GRAVITY * np.cos(y[0]),
                 np.sin(d) / 2 * y[2]**2 - 0.5 * GRAVITY * np.cos(y[1])]
        return [y[2], y[3], *np.linalg.solve(mass, force)]
    a, b, *_ = solved(rate, np.zeros(4), t)
    return np.column_stack([np.cos(a) + np.cos(b), np.sin(a) + np.sin(b), 0.0 * t])


MOTIONS = {"door": leaf, "gate": leaf, "carriage": sliding, "four-bar": rocking(2),
           "parallelogram": rocking(3), "bricard": bricard.path, "box": swinging,
           "double pendulum": two_rods}


@EVERYDAY
def test_motion_and_balance(name):
    """Both errors are of second order; a motion of constant acceleration has none."""
    coarse, fine = plain(name), plain(name, H / 2)
    exact = MOTIONS[name](coarse.t)
    errors = [np.abs(followed(name, Place(), r) - exact).max() for r in (coarse, fine)]
    balances = [r.energy_balance() for r in (coarse, fine)]
    if name == "carriage":
        assert max(errors) < 1e-9 and max(balances) < 1e-9
        return
    # a whole swing of 2 s in 200 steps: (W h)^2 / 12 of the angle with W below 6
    assert errors[0] < 4e-3 and 1.8 < order((2, 1), errors) < 2.2
    assert 1.8 < order((2, 1), balances) < 2.2


@EVERYDAY
@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_general_position(name, place):
    """Newton's tolerance, 1e-8 of an increment, is all that orientation and units change."""
    one, result = plain(name), simulate(MODELS[name][0](place), H, T_END)
    assert bool(result.start.redundant) == (name != "double pendulum")
    apart = np.abs(followed(name, place, result) - followed(name, Place(), one)).max(axis=1)
    assert apart[result.t < FLAT.get(name, T_END)].max() < 1e-6     # a hundred times that tolerance
    # where all bars of a loop lie on one line, rounding is divided by a strength that passes zero:
    # what is left is below the error of the step, which `test_motion_and_balance` bounds
    assert apart.max() < 1e-3
    # there rounding also decides how well the iteration converges: a step may be rejected
    cuts, iterations = (2, 5.0) if name in FLAT else (0, 4.0)
    assert result.cuts <= cuts and result.iterations_per_step <= iterations
    assert result["constraints.position"].max() < 1e-9 * place.length
    assert result.energy_balance() == pytest.approx(one.energy_balance(), rel=0.05, abs=1e-9)


@EVERYDAY
def test_velocities_hold_as_well(name):
    """The stabilised form, turned: second order for both, to the tolerance for velocities."""
    place = PLACES["turned"]
    result = simulate(MODELS[name][0](place), H, T_END, generalized_alpha(index=2))
    assert np.abs(followed(name, place, result) - MOTIONS[name](result.t)).max() < 4e-3
    assert result["constraints.velocity"].max() < 1e-6


@pytest.mark.parametrize("name", ["door", "four-bar"])
def test_within_a_tolerance(name):
    """As many steps as a loop without redundant joints takes, some hundreds."""
    place = PLACES["turned"]
    result = simulate_within(MODELS[name][0](place), H, 1.0, Tolerance(1e-5))
    error = followed(name, place, result) - MOTIONS[name](result.t)
    assert result.steps < 1000 and np.sqrt((error**2).mean(axis=0)).max() < 2e-5


@pytest.mark.parametrize("index", [3, 2])
@pytest.mark.parametrize("count", [2, 3, 12])
def test_a_loop_that_starts_with_all_bars_on_one_line(count, index):
    """There the joints leave a second motion free, at the start only: rates decide."""
    place = PLACES["turned"]
    model = rockers(place, count, (1.0, 0.0, 0.0))
    for k in range(count):
        model.initial_velocity(f"ground {k}", angular=place.turned((0.0, 0.0, -1.0)))
    model.initial_velocity("coupler", angular=np.zeros(3))
    result = simulate(model, H, 1.0, generalized_alpha(index=index))
    error = place.back(result["B0.position"]) - rocking(count, 0.0)(result.t)
    assert np.abs(error).max() < 2e-3 and result.cuts == 0      # as for the other motions
    assert result["constraints.position"].max() < 1e-9


def test_multipliers_stay_those_of_least_norm():
    """Two equal hinges beside each other bear the same all the time."""
    model = door(PLACES["turned"], (0.3, 1.8))
    axis = PLACES["turned"].turned((0.0, 0.0, 1.0))
    model.revolute("hinge 1", axis=axis, explicit=True, name="again")
    result = simulate(model, H, T_END)
    first, second = (result[f"{joint}.multipliers"] for joint in ("revolute at hinge 1", "again"))
    # they change by the motion since the last new matrix, by steps of 1/200 of the whole
    assert np.abs(first - second).max() < 1e-2 * np.abs(first).max()


def driven(motions):
    place = PLACES["turned"]
    model = door(place)
    for k, motion in enumerate(motions):
        model.drive_angle("hinge 0", motion, axis=place.turned((0.0, 0.0, 1.0)), name=f"drive {k}")
    return model


TABLES = [[(0.0, 0.0), (0.5, 0.2), (1.0, angle)] for angle in (0.5, 0.6)]


def test_drives_that_agree_are_redundant():
    result = simulate(driven([TABLES[0], TABLES[0]]), H, 1.0)
    turned = PLACES["turned"].back(result["handle.position"])[-1]
    # to the tolerance of positions
    assert turned == pytest.approx([0.75 * np.cos(0.5), 0.75 * np.sin(0.5), 1.0], abs=1e-8)


def test_drives_that_contradict_each_other_are_named():
    with pytest.raises((InputError, SimulationError), match="constraints of drive 0, drive 1 "
                                                           "contradict each other"):
        simulate(driven(TABLES), H, 1.0)


def test_no_inertia_about_an_axis_is_the_limit_of_little():
    """In the double pendulum hinges hold the rods' axes: nothing depends on that inertia."""
    none, little = (simulate(double_pendulum(PLACES["turned"], axial), H, T_END)["tip.position"]
                    for axial in (0.0, 1e-10))
    assert np.abs(none - little).max() < 1e-7       # 1e-10 of 1/3 in a motion that is not chaotic


def test_no_inertia_about_a_free_axis_is_refused():
    def hanging(axial):
        model = hung(PLACES["turned"])
        model.node("a", np.zeros(3))
        rod(model, PLACES["turned"], "rod", "a", np.zeros(3), (1.0, 0.0, 0.0), axial)
        model.fix("a", "position")
        return model
    with pytest.raises(InputError, match=r"mass matrix is singular: a.rotation\[.\] moves no mass"):
        simulate(hanging(0.0), H, T_END)
    simulate(hanging(1e-10), H, 0.1)


def test_redundant_hinges_in_equilibrium():
    """The moments of a spring and of the weight, to the tolerance of rotations."""
    place = PLACES["turned"]
    model = door(place)
    model.torsion_spring("hinge 0", stiffness=50.0, axis=place.turned((0.0, 0.0, 1.0)))
    x, y, _ = place.back(equilibrium(model)["handle.position"])[-1]
    angle = np.arctan2(y, x)
    weight = 20.0 * GRAVITY * np.sin(0.2) * 0.4
    assert 50.0 * angle == pytest.approx(-weight * np.cos(angle), rel=1e-8)
