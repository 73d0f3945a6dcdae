"""Warnings of runs, equilibria and linearisations whose results are bad, and none of good ones."""

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sebody import (
    LimitWarning,
    Model,
    Result,
    Simulation,
    Tolerance,
    generalized_alpha,
    ramp,
    simulate,
)
from sebody.analysis import equilibrium, linearize
from sebody.cli.entry import main
from sebody.fem import Section, planar_beam
from sebody.reduction import craig_bampton
from sebody.results import energy_balance as balances
from sebody.results.audit import audit
from sebody.results.energy_balance import LIMIT, energy_balance
from sebody.runs.limits import quality
from sebody.scenes import four_bar, hinged_beam, squeezer

SLENDER = Section(area=1.0, inertia_y=1e-4, inertia_z=1e-4, torsion=1e-4, youngs_modulus=3e4,
                  poisson_ratio=0.3, density=1.0)


def oscillator(steps_a_period, unit=1.0, tilt=0.0):
    """A mass on a spring that is struck, in some unit of length; the step is part of its period."""
    omega, along = 50.0, np.array([np.cos(tilt), np.sin(tilt)])
    model = Model(planar=True)
    model.node("wall", (0.0, 0.0), keeps="translation")
    model.node("mass", unit * along, keeps="translation")
    model.point_mass("mass", "mass", 2.0)
    model.spring("wall", "mass", stiffness=2.0 * omega**2)
    model.spring("mass", "wall", stiffness=2.0 * omega**2, name="second")
    model.fix("wall", "position")
    model.initial_velocity("mass", 0.1 * unit * omega * along)
    h = 2 * np.pi / (steps_a_period * np.sqrt(2.0) * omega)
    return simulate(model, h, 100 * h, generalized_alpha(1.0))


def carried_along(stiffer=1.0):
    """A bar that is far too stiff for the step, but nothing makes it vibrate."""
    model = Model(planar=True)
    section = replace(SLENDER, youngs_modulus=stiffer * SLENDER.youngs_modulus)
    body = craig_bampton(planar_beam((0, 0), (1, 0), section, 4), [(0, "full"), (4, "full")], 2)
    model.superelement("bar", body, [model.node("a", (0.0, 0.0)), model.node("b", (1.0, 0.0))])
    model.move("a", (0.0, 1.0), [(0.0, 0.0), (1.0, 0.1), (2.0, 0.4), (3.0, 0.9)])
    model.fix("a", "rotation")
    return simulate(model, 0.05, 3.0)


def said(run):
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        run()
    return [str(w.message) for w in found if issubclass(w.category, LimitWarning)]


@pytest.mark.parametrize("unit, tilt", [(1.0, 0.0), (1e3, 0.7), (1e-3, 2.0)])
def test_vibrations_that_the_step_does_not_resolve(unit, tilt):
    message, = said(lambda: oscillator(4.0, unit, tilt))
    assert message.startswith("vibrations of 70.7")         # 50 sqrt(2), nearly along the spring
    assert "have 4 steps per period (limit 6): take a step of 0.0049" in message
    assert said(lambda: oscillator(8.0, unit, tilt)) == []


def test_a_mass_that_is_not_positive_spoils_no_result(monkeypatch):
    """Bent far out of the linear range bodies may have one; the run is over and is kept."""
    matrix = quality.matrix
    monkeypatch.setattr(quality, "matrix", lambda *state, mass, **weights: matrix(
        *state, mass=-mass, **weights))
    assert said(lambda: oscillator(4.0)) == []


def test_bodies_that_are_carried_along_do_not_vibrate():
    assert said(carried_along) == []


def test_a_step_that_is_too_long_is_told_on_standard_error(capsys):
    said(lambda: simulate(squeezer.build().model, 1e-3, 1e-3).summary())   # compiled before
    capsys.readouterr()
    assert main(["run", "squeezer", "--step", "0.001"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert lines and all(line.startswith("warning: ") for line in lines)
    assert any("of the energy exchanged (limit 0.05)" in line for line in lines)
    assert any("rejected steps, " in line and "take a smaller step" in line for line in lines)


def test_a_warning_is_given_once_and_kept():
    run = Simulation(hinged_beam.build().model, 1.0)
    found = said(lambda: (run.run_to(15.0).result(), run.run_to(30.0).result()))
    kept = run.result().warnings
    assert len(kept) == len(found) == len(set(found))
    assert f"energy balance {run.result().energy_balance():.2g} of" in kept[0]  # of the whole run


def test_constraints_that_do_not_hold():
    loose = generalized_alpha(0.9, tolerance=0.5)
    found = said(lambda: simulate(four_bar.build().model, 0.02, 1.0, loose))
    assert any(m.startswith("the largest constraint residual is") and "smaller tolerance" in m
               for m in found)


def test_a_model_at_rest_has_no_balance_to_keep():
    """A weight on a spring that bears it from the start, high above the origin."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    for name, height in (("weight", 1e3), ("beam", 1e3 + 1.0)):
        model.node(name, (0.0, height), keeps="translation")
    model.fix("beam", "position")
    model.point_mass("weight", "weight", 10.0)
    model.spring("weight", "beam", stiffness=1e4, length=1.0 - 98.1 / 1e4)
    found = []
    assert said(lambda: found.append(simulate(model, 0.01, 1.0))) == []
    assert found[0].energy_balance() < 0.05


def test_the_balance_is_relative_to_what_is_exchanged():
    none, t = np.zeros(5), np.linspace(0.0, 1.0, 5)
    assert energy_balance(none, none, 1e6 + 1e-9 * t, none) == 0.0          # rounding
    assert energy_balance(2.0 + 0.1 * t, none, none, none) == pytest.approx(0.1 / 2.1, rel=1e-8)
    # the strain that is always there is not exchanged
    assert energy_balance(none, 7.0 + t, none, 0.9 * t) == pytest.approx(0.1, rel=1e-8)
    assert energy_balance(t, none, 5.0 - 10.0 * t, -9.5 * t) == pytest.approx(0.05, rel=1e-8)
    # of work that is done and taken back all counts, also where it is shared by two
    work = np.array([0.0, 4.0, -4.0, 2.0, 0.0])
    assert energy_balance(work / 2 + 2.0 + 0.1 * t, none, work / 2, work) == pytest.approx(
        0.1 / 20.0, rel=1e-8)


def test_what_is_driven_for_many_turns_is_judged_by_a_turn():
    """Drift of a crank in 100 turns is that of 20 turns, five times, and so is the work."""
    def way(x, y):
        return np.array([np.cos(0.7) * x - np.sin(0.7) * y, np.sin(0.7) * x + np.cos(0.7) * y])

    model = Model(planar=True)
    model.gravity(way(0.0, -9.81))
    model.rigid_body("crank", model.node("crank", way(0.0, 0.0)), 1.0, 0.1, centre=way(0.5, 0.0))
    model.revolute("crank", name="shaft")
    model.drive_angle("shaft", ramp(2 * np.pi))
    end = model.attach("end", way(1.0, 0.0), "crank")
    model.rigid_body("rod", model.node("pin", way(1.0, 0.0), at=end), 1.0, 0.4,
                     centre=way(2.2, 0.1))
    model.slider(model.attach("block", way(3.5, 0.2), "pin"), way(1.0, 0.0))
    run = Simulation(model, 0.02, generalized_alpha(0.9))
    few, many = (run.run_to(turns).result() for turns in (20.0, 100.0))
    drifts = [np.ptp(sum(r[f"energy.{name}"] for name in ("kinetic", "potential"))
                     - r["energy.external_work"]) for r in (few, many)]
    assert drifts[1] > 3.0 * drifts[0]
    assert many.energy_balance() == pytest.approx(few.energy_balance(), rel=0.05)
    assert many.warnings == ()


def stopped(h, t_end, **options):
    """A ball that falls on a stiff stop, which it leaves a few steps later."""
    def stop(t, x, v, force, stiffness=4e5):
        if x[1] < 0.0:
            force[1] = -stiffness * x[1]

    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (0.0, 1.0), keeps="translation"), 1.0)
    model.initial_velocity("ball", (0.0, -1.0))
    model.user_force("stop", ["ball"], stop)
    return simulate(model, h, t_end, **options)


def balance_of(result):
    """What the summary, the report and the warnings say of the energy."""
    line, = (line for line in result.summary().splitlines() if line.startswith("energy balance"))
    finding, = (one for one in audit(result) if one.what == "energy")
    return float(line.split()[2]), finding.verdict, [
        m for m in result.warnings if m.startswith("energy balance")]


def test_there_is_one_judgement_of_the_energy_from_all_states(tmp_path, monkeypatch):
    """A few states of two thousand are worst; the ball has its energy again after them."""
    limit = 5e-4
    monkeypatch.setattr(balances, "LIMIT", limit)
    found = []
    messages = said(lambda: found.append(stopped(1e-3, 2.0)))
    result, = found
    lost = np.abs(sum(result[f"energy.{name}"] for name in ("kinetic", "strain", "potential"))
                  - result["energy.external_work"] - 0.5)
    lost /= np.abs(np.diff(result["energy.external_work"])).sum()       # twice 0.5
    few = lost > limit
    assert 0 < few.sum() < 10 and lost[-1] < limit      # LOOKED_AT states may miss them all
    value, verdict, warned = balance_of(result)
    assert value == pytest.approx(lost.max(), rel=0.1)      # of a ball that is a bit faster then
    assert verdict == "bad" and len(warned) == 1 and warned == messages
    assert balance_of(Result.load(result.save(tmp_path / "ball.npz"))) == (value, verdict, warned)
    value, verdict, warned = balance_of(stopped(1e-5, 2.0, output_every=10))
    assert value < limit and verdict != "bad" and not warned


def test_runs_within_a_tolerance_are_judged_too():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        for allowed in (Tolerance(1e-1), Tolerance(1e-5)):
            value, verdict, warned = balance_of(stopped(1e-2, 2.0, tolerance=allowed))
            assert (value > LIMIT) == (verdict == "bad") == bool(warned)


def test_a_balance_that_is_bad_at_first_may_be_good_at_the_end():
    """A stiff spring loses its energy in two steps; then a load does much more work."""
    model = Model(planar=True)
    for name, x in (("wall", 0.0), ("weight", 1.0), ("ball", 2.0)):
        model.node(name, (x, 0.0), keeps="translation")
    model.fix("wall", "position")
    model.spring("weight", "wall", stiffness=1e6, length=1.0 - 1e-5)
    for name in ("weight", "ball"):
        model.point_mass(name, name, 2.0)
    model.force("ball", (1.0, 0.0), lambda t: 2.0 * max(t - 0.3, 0.0))
    run = Simulation(model, 0.1, generalized_alpha(0.0))
    messages = said(lambda: (run.run_to(0.2).result(), run.result()))
    balance = [one for one in messages if one.startswith("energy balance 1 of")]
    assert len(balance) == 1 and len(messages) == 2         # the other one is of the fast vibration
    assert balance_of(run.result())[1:] == ("bad", balance)
    found = []
    assert said(lambda: found.append(run.run_to(4.0).result())) == []
    assert balance_of(found[0])[1:] == ("good", [])


def bent(force, **options):
    """A cantilever of one body."""
    model = Model(planar=True)
    body = craig_bampton(planar_beam((0, 0), (1, 0), SLENDER, 4), [(0, "full"), (4, "full")], 0)
    model.superelement("bar", body, [model.node("a", (0.0, 0.0)), model.node("b", (1.0, 0.0))],
                       **options)
    model.fix("a")
    model.force("b", (0.0, force))
    return model


@pytest.mark.parametrize("force, count", [(0.5, 0), (12.0, 1)])
def test_equilibria_and_what_is_linearised_about_them_are_looked_at(force, count):
    found = []
    assert len(said(lambda: found.append(equilibrium(bent(force))))) == count
    messages = said(lambda: linearize(found[0]))
    assert len(messages) == count == len(found[0].warnings)
    assert all("local rotation" in m and "divide the body" in m for m in messages)


def test_an_equilibrium_that_spins_too_fast():
    message, = said(lambda: equilibrium(bent(0.0, inertia="material"), spin=12.0))
    assert message.startswith("spin 12 rad/s is above the limit")
    assert "divide the body in two" in message


@pytest.mark.parametrize("run", [lambda: oscillator(8.0), lambda: carried_along(1e6)])
def test_energy_that_grows_in_what_is_rigid_is_no_matter_of_bent_bodies(monkeypatch, run):
    """A mass on a spring has nothing to divide, and a bar that hardly bends is not the cause."""
    monkeypatch.setattr(quality, "increase", lambda *energies, **options: 1e9)
    message, = said(run)
    assert message.startswith("energy grows by ")
    assert message.endswith("the steps do not resolve the fastest motion of its rigid parts; take "
                            "a smaller step, or rho below 1")


def test_energy_that_grows_after_it_has_fallen_is_told():
    """By numbers: from 1 it falls to 0.2 and grows to 0.5, which is below the first."""
    energy = np.array([1.0, 0.6, 0.2, 0.35, 0.5, 0.45])
    part = SimpleNamespace(model=SimpleNamespace(bodies={}))
    none = np.zeros(6)
    told = quality._grown(part, 0.01, energy, none, none, none)["growth"]
    assert told.startswith("energy grows by 0.3 of its maximum although no work is done")
