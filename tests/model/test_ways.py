"""What acts along paths: friction, stops, springs, actuators, wheels: closed forms and energy."""

import re

import numpy as np
import pytest
from model.test_paths import SHIFT, TURN

from sebody import InputError, LimitWarning, Model, Simulation, generalized_alpha, simulate
from sebody.analysis import (
    Ensemble,
    campbell,
    equilibrium,
    final,
    frequency_response,
    resume,
    save_state,
)
from sebody.control import state_feedback
from sebody.fem import rectangle
from sebody.model.profiles import rest_to_rest
from sebody.model.variants import keep_modes
from sebody.results import Result

G, MASS = 9.81, 2.0
SINE, COSINE = 0.6, 0.8     # of the slope


def slope(planar=True, gravity=G, **options):
    """A bead on a straight slope that goes down from the origin; nothing else."""
    model = Model(planar=planar)
    along = np.array([COSINE, -SINE]) if planar else np.array([0.48, 0.64, -SINE])
    bead = model.node("bead", 0 * along, "translation")
    model.point_mass("mass", bead, MASS)
    model.gravity((0, -gravity) if planar else (0, 0, -gravity))
    model.path("rail", points=[k * along for k in range(5)], ends="straight")
    model.path_joint(bead, "rail", name="runs", **options)
    return model


@pytest.mark.parametrize("planar", [True, False])
def test_friction_slides_and_sticks(planar):
    model = slope(planar)
    model.friction("runs", 0.3, name="rub")
    result = simulate(model, 1e-2, 1.0)
    acceleration = G * (SINE - 0.3 * COSINE)
    assert result["runs.way"] == pytest.approx(acceleration * result.t**2 / 2, abs=1e-9)
    assert result["runs.normal_force"] == pytest.approx(MASS * G * COSINE, rel=1e-9)
    assert result["runs.thrust"][1:] == pytest.approx(-0.3 * MASS * G * COSINE, rel=1e-9)
    for rests in ({"coefficient": 0.8}, {"coefficient": 0.0, "static": 0.5, "preload": 30.0,
                                         "reaction": False}):
        model = slope(planar)
        model.friction("runs", **rests)
        assert simulate(model, 1e-2, 1.0)["runs.way"] == pytest.approx(0.0, abs=1e-12)


def test_a_spring_and_its_damper():
    """An oscillator; its equilibrium, and the balance of energy."""
    k, c, rest = 100.0, 3.0, 0.2
    model = slope(inertia=1.0)
    model.spring("runs", stiffness=k, damping=c, length=rest, name="spring")
    result = simulate(model, 1e-3, 2.0)
    mass, place = MASS + 1.0, rest + MASS * G * SINE / k
    decay = c / (2 * mass)
    omega = np.sqrt(k / mass - decay**2)
    t = result.t
    exact = place * (1 - np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(
        omega * t)))
    assert result["runs.way"] == pytest.approx(exact, abs=5e-6)
    energy = sum(result[f"energy.{one}"] for one in ("kinetic", "strain", "potential"))
    assert energy - energy[0] == pytest.approx(result["spring.work"], abs=2e-5)
    assert equilibrium(model)["runs.way"][-1] == pytest.approx(place, rel=1e-9)
    model.path_joint(model.node("other", (0.8, -0.6), "translation"), "rail", name="stays")
    assert model.spring("stays", stiffness=1.0).constants["length"] == pytest.approx(1.0)


def test_a_stop_and_a_motor():
    """A buffer returns the speed times its restitution where gravity does nothing meanwhile."""
    model = slope(gravity=0.0, rate=3.0)
    model.stop("runs", upper=1.0, stiffness=1e5, restitution=0.6, at_speed=3.0, name="buffer")
    result = simulate(model, 1e-3, 0.6)
    assert result["runs.rate"][0] == pytest.approx(3.0)
    assert result["runs.rate"][-1] == pytest.approx(-0.6 * 3.0, rel=2e-3)
    model = slope()
    model.actuator("motor", joint="runs", start=5.0, inertia=0.01, ratio=10.0)
    moved = (50.0 + MASS * G * SINE) / (MASS + 1.0) / 2
    assert simulate(model, 1e-2, 1.0)["runs.way"][-1] == pytest.approx(moved, rel=1e-9)


@pytest.mark.parametrize("period", [None, 2e-3])
def test_a_controller_holds_a_way(period):
    """In the equations of motion, and by samples."""
    model = slope()
    model.actuator("motor", joint="runs")
    model.sensor("error", "runs.way", bias=-0.5)
    model.controller("servo", state_feedback([[400.0, 60.0]]), ["error", "runs.rate"], ["motor"],
                     period=period)
    held = 0.5 + MASS * G * SINE / 400.0
    assert simulate(model, 2e-3, 2.0)["runs.way"][-1] == pytest.approx(held, abs=1e-6)


def swinging(bodies=1, flat=True, turned=None, modes=4, coefficient=0.2, **rub):
    """An arm that falls on its hinge, with a slider on it that rubs."""
    turned = np.eye(3) if turned is None else turned

    def at(x):
        point = x * np.array([np.cos(0.5), np.sin(0.5), 0.0])
        return point[:2] if flat else turned @ point + SHIFT
    model = Model(planar=flat)
    base, tip = model.node("base", at(0.0)), model.node("tip", at(2.0))
    up = {} if flat else {"up": turned @ (-np.sin(0.5), np.cos(0.5), 0.0)}
    model.beam("arm", (base, tip), rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.0,
                                             density=2700.0), elements=20, bodies=bodies,
               modes=modes, **up)
    model.revolute(base, (0, 0, 1) if flat else turned[:, 2])
    car = model.node("car", at(1.2), "translation")
    model.point_mass("car mass", car, 0.3)
    field = np.array([0.0, -G, 0.0])
    model.gravity(field[:2] if flat else turned @ field)
    model.path("rail", on="arm", ends="straight")
    model.path_joint(car, "rail", name="runs")
    model.friction("runs", coefficient, name="rub", **rub)
    return model


def _internal(model):
    """Squares of the frequencies of the internal modes of the arm."""
    body = model.bodies["arm"].reduced
    own = slice(len(body.stiffness) - body.modes, None)
    return np.diag(body.stiffness)[own] / np.diag(body.mass)[own]


def _out_of_balance(coefficient, h, rho=0.9):
    """Energy of the swinging arm less its start and the work of friction."""
    model = swinging(coefficient=coefficient)
    result = simulate(model, h, 0.3, generalized_alpha(rho, index=2))
    energy = sum(result[f"energy.{one}"] for one in ("kinetic", "strain", "potential"))
    return energy - energy[0] - result["rub.work"]


@pytest.mark.filterwarnings("ignore")
def test_work_of_friction_is_energy_lost():
    """Of order 2 in the step; the same in general position, and along several bodies."""
    left = []
    for h in (2e-3, 1e-3):
        result = simulate(swinging(), h, 0.3)
        energy = sum(result[f"energy.{one}"] for one in ("kinetic", "strain", "potential"))
        left.append(np.abs(energy - energy[0] - result["rub.work"]).max())
    assert result["rub.work"][-1] < -0.01
    assert left[1] < 3e-5 and left[1] < left[0] / 3
    # what friction adds to what the scheme loses of the energy without it
    own = [_out_of_balance(coefficient, 5e-4) for coefficient in (0.2, 0.0)]
    assert np.abs(own[0] - own[1]).max() < 1e-5 * np.ptp(energy) < np.abs(own[1]).max()
    assert np.abs(_out_of_balance(0.2, 8e-5, 1.0)).max() < 1e-5 * np.ptp(energy)
    force, normal = result["runs.thrust"], result["runs.normal_force"]
    slides = np.abs(result["runs.rate"]) > 0.05
    assert slides.sum() > 100
    assert np.abs(force[slides]) == pytest.approx(0.2 * normal[slides], rel=2e-3)
    flat, space = swinging(modes=8), swinging(flat=False, turned=TURN, modes=12)
    both = [_internal(one) for one in (flat, space)]     # the same 8, and 4 across the plane
    assert both[0] == pytest.approx(both[1][[0, 1, 3, 4, 6, 7, 9, 11]], rel=1e-6)
    eight = simulate(flat, 1e-3, 0.3)["runs.way"]
    assert simulate(space, 1e-3, 0.3)["runs.way"] == pytest.approx(eight, abs=1e-6)
    four = simulate(swinging(bodies=4), 1e-3, 0.3)
    assert four["runs.way"] == pytest.approx(eight, abs=1e-4)
    fewer = simulate(keep_modes(swinging(modes=8), "arm", 4).model, 1e-3, 0.3)
    assert fewer["runs.way"][-1] == pytest.approx(result["runs.way"][-1], abs=1e-9)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("bodies", [1, 4])
def test_restarts(tmp_path, bodies):
    """Bit for bit; a start from a result finds accelerations anew, which is of order 2 in h."""
    def build():
        model = swinging(bodies)
        model.stop("runs", lower=1.17, stiffness=1e3, name="buffer")
        model.spring("runs", stiffness=3.0, damping=0.1)
        return model
    whole = Simulation(build(), 2e-3).run_to(0.2).result()
    assert whole["buffer.normal_force"][-1] > 0.0 and whole["buffer.normal_force"][50] == 0.0
    path = save_state(Simulation(build(), 2e-3).run_to(0.1), tmp_path / "half.npz")
    np.testing.assert_array_equal(resume(build(), path).run_to(0.2).result().rows, whole.rows)
    apart = []
    for h in (2e-3, 1e-3):
        later = simulate(swinging(bodies), h, 0.1, start=simulate(swinging(bodies), h, 0.1))
        apart.append(later["runs.way"][-1] - simulate(swinging(bodies), h, 0.2)["runs.way"][-1])
    assert abs(apart[0]) < 1e-6 and abs(apart[1]) < abs(apart[0]) / 3


def test_threads_do_not_share_steps_with_friction_along_a_path():
    """It reads what the path has just found."""
    with pytest.warns(LimitWarning, match="threads = 2 is not used: friction along a path reads"):
        assert Simulation(slope_with_friction(), 1e-2, threads=2).run_to(0.1)


def slope_with_friction():
    model = slope()
    model.friction("runs", 0.3, name="rub")
    return model


def test_a_drive_does_the_work_of_friction():
    model = slope_with_friction()
    model.drive_way("runs", rest_to_rest(1.0, 1.0), name="engine")
    result = simulate(model, 1e-2, 1.0)
    lifted = MASS * G * SINE
    assert result["engine.work"][-1] == pytest.approx(-lifted + 0.3 * MASS * G * COSINE, rel=2e-3)


def test_ends_that_are_stops(tmp_path):
    """A buffer at one end or at both: the same as stops that are given, and told of."""
    law = {"stiffness": 1e5, "restitution": 0.6, "at_speed": 3.0}

    def thrown(ends, rate, **options):
        model = Model(planar=True)
        model.point_mass("mass", model.node("bead", (0.0, 0.0), "translation"), MASS)
        model.path("rail", points=[(0.0, 0.0), (0.8, -0.6)], ends=ends, **options)
        model.path_joint("bead", "rail", rate=rate, name="runs")
        return model
    both = simulate(thrown("stop", 3.0, **law), 1e-3, 1.0)
    given = thrown("straight", 3.0)
    given.stop("runs", lower=0.0, upper=1.0, name="ends of runs", **law)
    np.testing.assert_array_equal(both.rows, simulate(given, 1e-3, 1.0).rows)
    assert -0.05 < both["runs.way"].min() and 1.0 < both["runs.way"].max() < 1.05
    assert both["runs.rate"][600] == pytest.approx(-0.6 * 3.0, rel=2e-3)
    kinetic = both["energy.kinetic"]
    # of order 2: off by 0.011, 0.0024 and 0.0006 an impact with steps of 1, 1/2 and 1/4 ms
    assert both["ends of runs.work"][-1] == pytest.approx(kinetic[-1] - kinetic[0], abs=0.03)
    both.save(tmp_path / "run.npz")
    read = Result.load(tmp_path / "run.npz")
    pushed = both["ends of runs.normal_force"]
    assert read["ends of runs.normal_force"].max() == pushed.max() > 500.0
    model = thrown(("straight", "stop"), -1.0, **law)
    assert simulate(model, 1e-3, 1.0)["runs.way"][-1] == pytest.approx(-1.0)
    model.drive_way("runs", rest_to_rest(1.0, 1.0), name="engine")
    assert {"straight, stop", "drive of the way", "engine"} <= set(
        re.split(r"  +|\n", model.summary()))


def equipped():
    """The swinging arm with everything that acts along a path."""
    model = swinging()
    model.spring("runs", stiffness=20.0, damping=1.0, name="spring")
    model.stop("runs", lower=0.1, upper=1.9, stiffness=1e4, name="buffer")
    model.actuator("motor", joint="runs", inertia=0.01)
    return model


@pytest.mark.filterwarnings("ignore")
def test_numbers_of_what_acts_along_paths_are_varied():
    """Ensembles run as models that are built with these numbers; wrong ones are refused."""
    values = {"rub.coefficient": np.array([0.1, 0.2]), "buffer.lower": np.array([0.2, 0.1]),
              "spring.stiffness": np.array([10.0, 20.0])}
    found = Ensemble(equipped(), 2e-3).run(values, 0.05, {"s": final("runs.way")})["s"]
    assert found[1] == simulate(equipped(), 2e-3, 0.05)["runs.way"][-1] != found[0]
    for name, value, said in (
            ("rub.coefficient", -0.1, "coefficient of run 0 is -0.1"),
            ("rub.preload", -1.0, "preload of run 0 is -1"),
            ("buffer.lower", 1.5, "'buffer': it starts at 1.2, beyond the limits 1.5 and 1.9")):
        try:
            wrong = Ensemble(equipped(), 2e-3).run({name: np.array([value])}, 0.05,
                                                   {"s": final("runs.way")})
            heard = str(wrong.failures)
        except InputError as error:
            heard = str(error)
        assert said in heard


@pytest.mark.filterwarnings("ignore")
def test_small_motions_and_rotations_of_what_is_on_paths():
    """Ways do not turn with a spin; inputs move the way as a force on it does."""
    model = Model(planar=True)      # a bead in a turning slot on a spring: s = k r / (k - m w^2)
    hub = model.node("hub", (0.0, 0.0))
    model.rigid_body("disc", hub, 1.0, 1.0)
    model.revolute(hub, name="axle")
    bead = model.node("bead", (0.5, 0.0), "translation")
    model.point_mass("mass", bead, MASS)
    model.path("slot", on=hub, points=[(0.0, 0.0), (3.0, 0.0)])
    model.path_joint(bead, "slot", name="runs")
    model.spring("runs", stiffness=100.0)
    model.actuator("motor", joint="runs")
    rest = equilibrium(model, spin=3.0)
    assert rest["runs.way"][-1] == pytest.approx(0.5 * 100.0 / (100.0 - MASS * 9.0), rel=1e-9)
    shown = campbell(model, [0.0, 1.0], count=3)
    assert len(shown.speeds) == 2
    answer = frequency_response(equilibrium(model), "motor", ["runs.way"], [2.0])
    # the disc is free and the bead has no weight on it: a free mass on a spring
    assert abs(answer["runs.way"][0]) == pytest.approx(1 / (100.0 - MASS * 4.0), rel=1e-6)


def carriage(half):
    """A carriage on two wheels on an arm that falls, its centre beside the path."""
    model, c = Model(planar=True), np.array([np.cos(0.5), np.sin(0.5)])
    base, tip = model.node("base", 0 * c), model.node("tip", 2 * c)
    model.beam("arm", (base, tip), rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.0,
                                             density=2700.0), elements=20, bodies=1, modes=4)
    model.revolute(base)
    car = model.node("car", 1.2 * c)
    model.rigid_body("carriage", car, 0.3, 0.02, centre=(0.0, 0.15))
    model.gravity((0.0, -G))
    model.path("rail", on="arm")
    for name, place in (("rear", 1.2 - half), ("front", 1.2 + half)):
        model.path_joint(model.attach(name, place * c, car), "rail", name=name)
    return model


@pytest.mark.filterwarnings("ignore")
def test_two_wheels_keep_the_orientation_of_a_carriage():
    """With a short base as a joint that keeps the tangent of the deformed path.

    That gave a way of 0.977405 and an angle of -0.288214, as written down with the equations of
    such a joint; the base adds errors of its square.
    """
    found = []
    for half in (0.1, 0.05):
        result = simulate(carriage(half), 1e-3, 0.3)
        found.append([(result["rear.way"] + result["front.way"])[-1] / 2,
                      result["car.rotation"][-1]])
    coarse, fine = np.array(found)
    short = fine + (fine - coarse) / 3
    assert short == pytest.approx([0.977405, -0.288214], abs=3e-5)
    assert np.abs(fine - short).max() < np.abs(coarse - short).max() / 3
