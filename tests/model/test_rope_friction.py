"""Friction of ropes on sheaves against the formula of the capstan and reduced equations."""

import numpy as np
import pytest
from hanging import TURN, G, heights, hung, turned
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sebody import InputError, Model, Simulation, SimulationError, generalized_alpha, simulate
from sebody.analysis import Ensemble, equilibrium, final, gradient
from sebody.model.variants import planar
from sebody.runs.restart import resume, save_state

RADIUS, ABOVE, BELOW = 0.2, 1.0, 4.0
EA = 3e4


def machine(masses=(3.0, 1.2), mu=0.1, inertia=0.0, form="space", stiffness=EA, **rope):
    """Weights on both sides of a sheave with friction, the first one on its left."""
    flat = form == "plane"
    model = hung({"p": (0, 0), "a": (-RADIUS, -ABOVE), "b": (RADIUS, -BELOW)},
                 dict(zip("ab", masses, strict=True)), flat=flat)
    model.sheave("wheel", "p", RADIUS, inertia=inertia, friction=mu,
                 **({} if flat else {"axis": TURN[:, 2]}))
    model.rope("rope", ("a", "wheel", "b"), stiffness, wrap="-", **rope)
    return planar(model).model if form == "planar form" else model


def ratios(result, mu):
    """The larger tension over the smaller one, relative to what slipping has."""
    low, high = np.sort(result["rope.tension"], axis=1).T
    return high / low / np.exp(mu * result["rope.wraps"][:, 0])


def sunk(t, masses, mu, pull):
    """Ways of both weights of an elastic rope, by DOP853: it sticks at first and slips then.

    What is on the sheave has no strain, so each side has the way and the material that it lacks.
    """
    ratio, free = np.exp(mu * np.pi), 1.0 / (1.0 + pull / EA)
    one, other = ABOVE * free, BELOW * free

    def tensions(x, y, given=0.0):
        return (EA * ((ABOVE + x) / (one + given) - 1.0),
                EA * ((BELOW + y) / (other - given) - 1.0))

    def beyond(given, x, y):
        left, right = tensions(x, y, given)
        return left - ratio * right

    def rate(_, state, slips):
        x, y, vx, vy = state
        given = brentq(beyond, -0.9 * one, 0.9 * other, (x, y), xtol=1e-15) if slips else 0.0
        left, right = tensions(x, y, given)
        return vx, vy, G - left / masses[0], G - right / masses[1]

    def breaks_away(_, state, slips):
        return beyond(0.0, *state[:2])
    breaks_away.terminal = True
    accuracy = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
    sticks = solve_ivp(rate, (0.0, t[-1]), np.zeros(4), t_eval=t, events=breaks_away,
                       args=(False,), **accuracy)
    at, state = sticks.t_events[0][0], sticks.y_events[0][0]
    slips = solve_ivp(rate, (at, t[-1]), state, t_eval=t[t > at], args=(True,), **accuracy)
    return np.hstack([sticks.y[:2, sticks.t <= at], slips.y[:2]])


@pytest.mark.parametrize("form", ["space", "plane", "planar form"])
def test_a_rope_that_slips_has_the_ratio_of_the_capstan(form):
    """Whose loss never falls, and is the work of the tensions on what slips."""
    result = simulate(machine(form=form, damping=30.0, pretension=18.0), 1e-3, 0.4)
    slides = np.flatnonzero(result["friction of rope on wheel.sticks"] == 0.0)
    assert slides.size > 350 and (np.diff(slides) == 1).all()
    assert ratios(result, 0.1)[slides] == pytest.approx(1.0, abs=1e-10)
    assert (ratios(result, 0.1) < 1.0 + 1e-10).all()
    lost, slip = result["friction of rope on wheel.dissipation"], -result["rope.slip"][:, 0]
    assert (np.diff(lost) >= -1e-12 * lost[-1]).all() and lost[-1] > 0.5
    passed = np.diff(result["rope.tension"], axis=1)[:, 0]      # strains of 1e-3 besides
    assert lost[-1] == pytest.approx(np.trapezoid(-passed, slip), rel=2e-3)
    assert result.energy_balance() < 1e-5


def test_elastic_machine_of_atwood_is_that_of_its_equations():
    """Between the first and second order: it breaks away within a step."""
    masses, mu = (3.0, 1.2), 0.1
    errors = []
    for h in (1e-3, 2.5e-4):
        result = simulate(machine(masses, mu, pretension=18.0), h, 0.3)
        ways = [-heights(result.model, result, name) - start
                for name, start in (("a", ABOVE), ("b", BELOW))]
        errors.append(np.abs(ways - sunk(result.t, masses, mu, 18.0)).max())
        assert ways[0][-1] > 0.1
    assert errors[0] < 5e-6 and errors[1] < errors[0] / 6


@pytest.mark.parametrize("form", ["space", "plane", "planar form"])
def test_a_rope_that_sticks_moves_with_the_sheave(form):
    """As on one that no rope slips on, but for the order of the scheme."""
    how = {"form": form, "inertia": 0.05, "damping": 30.0, "pretension": 18.0}
    apart = []
    for h in (1e-3, 5e-4):
        found, held = (simulate(machine(mu=mu, **how), h, 0.2) for mu in (0.3, 0.0))
        assert (found["friction of rope on wheel.sticks"] == 1.0).all()
        assert np.abs(found["rope.slip"]).max() < 1e-12
        assert np.abs(found["friction of rope on wheel.work"]).max() < 1e-12
        apart.append(np.abs(found["wheel.angle"] - held["wheel.angle"]).max())
    assert apart[0] < 1e-7 and apart[1] < apart[0] / 3.5


@pytest.mark.parametrize("form", ["space", "plane"])
def test_a_rope_slips_on_a_heavy_sheave(form):
    """Which turns by the tensions; with a stiff rope all of them are constant."""
    (m, M), mu, J = (3.0, 1.2), 0.1, 0.5
    ratio = np.exp(mu * np.pi)
    rate = (m - M * ratio) * G / (m + M * ratio)
    low = M * (G + rate)
    turned_by = (ratio - 1.0) * low * RADIUS / J
    assert turned_by * RADIUS < rate
    result = simulate(machine((m, M), mu, J, form, 1e7, damping=1e5, pretension=low), 1e-3, 0.4)
    assert result["rope.tension"][-1] == pytest.approx([ratio * low, low], rel=1e-5)
    late = result.t > 0.1
    for name, expected in (("wheel.rate", turned_by), ("b.velocity", rate)):
        course = result[name][late]
        course = course if course.ndim == 1 else np.linalg.norm(course, axis=1)
        assert np.polyfit(result.t[late], course, 1)[0] == pytest.approx(expected, rel=1e-5)
    slip = np.diff(result["rope.slip"][late, 0]) / 1e-3
    assert -np.diff(slip) / 1e-3 == pytest.approx(rate - turned_by * RADIUS, rel=1e-3)


def braked(sense, mu=0.25, planar_form=False):
    """A drum that spins in a band, which is anchored on one side and pulled by a weight."""
    model = Model()
    model.node("hub", turned(0, 0))
    model.rigid_body("drum", "hub", 8.0, TURN @ np.diag((0.3, 0.3, 0.4)) @ TURN.T)
    model.revolute("hub", TURN[:, 2], name="axle")
    model.initial_velocity("hub", angular=sense * 9.0 * TURN[:, 2])
    for name, point in (("anchor", (-0.3, -0.8)), ("weight", (0.3, -0.8))):
        model.node(name, turned(*point), "translation")
    model.fix("anchor", "position")
    model.point_mass("mass", "weight", 4.0)
    model.gravity(TURN @ (0, -G, 0))
    model.sheave("rim", "hub", 0.3, axis=TURN[:, 2], friction=mu)
    model.rope("band", ("anchor", "rim", "weight"), 1e6, damping=400.0, pretension=4.0 * G,
               wrap="-")
    return planar(model).model if planar_form else model


@pytest.mark.parametrize("planar_form", [False, True])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_band_brake(sense, planar_form):
    """The weight gives the tension of its side, and the sense of the spin that of the other."""
    mu, weight = 0.25, 4.0 * G
    result = simulate(braked(sense, mu, planar_form), 2e-4, 0.2)
    anchored, pulled = result["band.tension"].T
    slides = result.t > 1e-3
    ratio = np.exp(-sense * mu * result["band.wraps"][slides, 0])
    assert anchored[slides] / pulled[slides] == pytest.approx(ratio, rel=1e-10)
    assert pulled[-200:].mean() == pytest.approx(weight, rel=0.02)      # it swings on its band
    late = result.t > 0.01
    rate = sense * np.abs(result["axle.rate"][late])    # signs of a plane are its own
    assert 0.4 * (rate[-1] - rate[0]) == pytest.approx(
        0.3 * np.trapezoid((anchored - pulled)[late], result.t[late]), rel=2e-4)   # and strain
    lost = result["friction of band on rim.dissipation"]
    assert (np.diff(lost) > -1e-12 * lost[-1]).all()
    spun = 0.4 * (9.0**2 - result["axle.rate"][-1]**2) / 2
    assert lost[-1] == pytest.approx(spun, rel=1e-2)        # of which the band takes some


def test_a_brake_holds_the_drum_that_it_has_stopped():
    result = simulate(braked(-1.0, 0.5), 1e-3, 0.3)
    sticks = result["friction of band on rim.sticks"]
    assert sticks[0] == sticks[10] == 0.0 and sticks[-1] == 1.0
    still = result.t > 0.25
    assert np.ptp(result["band.slip"][still]) < 1e-9
    low, high = np.sort(result["band.tension"][-1])
    assert high / low < np.exp(0.5 * result["band.wraps"][-1, 0])


def test_a_rope_on_a_sheave_with_friction_is_slack_on_both_sides():
    """The weights fall freely until the rope is taut, and it has the ratio from then on."""
    model = machine((3.0, 1.2), damping=30.0, length=ABOVE + BELOW + RADIUS * np.pi + 0.1)
    result = simulate(model, 5e-4, 0.2)
    slack = result["rope.elongation"] < 0
    assert slack[0] and not result["rope.tension"][slack].any()
    assert result.t[np.argmin(slack)] == pytest.approx(np.sqrt(0.1 / G), abs=1e-3)
    taut = (result["rope.tension"] > 1e-3).all(axis=1)
    assert taut.sum() > 30 and (result["rope.tension"][~taut] < 1e-2).all()
    low, high = np.sort(result["rope.tension"][taut], axis=1).T
    assert (high < low * np.exp(0.1 * result["rope.wraps"][taut, 0]) * (1.0 + 1e-10)).all()


def test_equilibrium_of_a_rope_that_sticks():
    """Weights that differ by less than the ratio hang still; others do not."""
    found = equilibrium(machine((3.0, 2.5), 0.1, pretension=25.0))
    assert found["rope.tension"][-1] == pytest.approx([3.0 * G, 2.5 * G], rel=1e-7)
    assert found["rope.slip"][-1] == pytest.approx([0.0], abs=1e-12)
    with pytest.raises(SimulationError, match="friction of rope on wheel"):
        equilibrium(machine((3.0, 1.2), 0.1, form="plane", pretension=25.0))


def test_a_run_with_friction_goes_on_from_a_file(tmp_path):
    def built():
        return machine(inertia=0.5, damping=30.0, pretension=18.0)
    whole, half = simulate(built(), 1e-3, 0.1), Simulation(built(), 1e-3)
    half.run_to(0.05)
    other = resume(built(), save_state(half, tmp_path / "state.npz"))
    other.run_to(0.1)
    for name in ("a.position", "rope.tension", "rope.slip", "friction of rope on wheel.work"):
        assert np.array_equal(other.result()[name][-1], whole[name][-1])


def test_coefficients_in_an_ensemble():
    name = "friction of rope on wheel.coefficient"
    found = Ensemble(machine(pretension=18.0), 1e-3).run(
        {name: [0.05, 0.2]}, 0.05, outputs={"x": "a.position"})["x"]
    for k, mu in enumerate((0.05, 0.2)):
        assert found[k] == pytest.approx(
            simulate(machine(mu=mu, pretension=18.0), 1e-3, 0.05)["a.position"], abs=1e-9)


def test_gradients_are_refused():
    with pytest.raises(InputError, match="'friction of rope on wheel' lets rope 'rope' slip, a "
                                         "motion without mass, which is not differentiated"):
        gradient(machine(pretension=18.0), 1e-3, 0.1, {"x": final("a.position.y")}, ["gravity.y"],
                 scheme=generalized_alpha(index=3))
