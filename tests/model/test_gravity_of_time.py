"""Gravity as a function of time: motion, energy, and everything that reads it."""

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, Tolerance, generalized_alpha, ramp, simulate
from sebody.analysis import (
    Ensemble,
    equilibrium,
    final,
    gradient,
    linearize,
    modes,
    resume,
    save_state,
)
from sebody.fem import Section, planar_beam
from sebody.model.gravity_fields import gravity_at
from sebody.reduction import craig_bampton

SECTION = Section(area=0.2, inertia_y=0.02, inertia_z=0.02, torsion=0.04, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
ARM = craig_bampton(planar_beam((0.0, 0.0), (20.0, 0.0), SECTION, 4), [(0, "full"), (4, "full")], 3)
DOWN = np.array([30.0, -981.0])
G, W = 9.81, 3.0


def amplitude(t: float) -> float:
    """Factor of gravity."""
    return 1.0 + 0.5 * np.sin(7.0 * t)


def rock(planar: bool = True) -> Model:
    """A rigid body that falls."""
    model = Model(planar=planar)
    node = model.node("a", (0.3, 0.2) if planar else (0.3, 0.2, -0.4))
    model.rigid_body("rock", node, 2.5, 0.1 if planar else np.diag([0.1, 0.2, 0.3]),
                     centre=(0.1, 0.3) if planar else (0.1, 0.3, 0.2))     # a point of space
    return model


def pendulum(moved: bool = False, field=None, factor=amplitude) -> Model:
    """A flexible arm with a weight; moved at its base in place of gravity over time."""
    model = Model(planar=True)
    base, tip = model.node("base", (0.0, 0.0)), model.node("tip", (20.0, 0.0))
    model.superelement("arm", ARM, (base, tip))
    model.point_mass("bob", tip, 0.02)
    if moved:
        model.gravity((0.0, -981.0))
        model.move(base, (1.0, 0.5), acceleration=lambda t: -300.0 * np.sin(7.0 * t))
        return model
    model.fix(base, "position")
    model.gravity(DOWN if field is None else field, factor)
    return model


def falling(t):
    """Way under gravity ``-G sin(W t)``."""
    return G * (np.sin(W * t) / W**2 - t / W)


@pytest.mark.filterwarnings("ignore:body 'rock' is not connected")
@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("way", ["amplitude", "function", "components", "table", "file"])
def test_a_body_falls_as_gravity_says(planar, way, tmp_path):
    model, rest = rock(planar), () if planar else (0.0,)
    t = np.linspace(0.0, 1.0, 51)
    rows = np.column_stack([t, 0.0 * t, -G * np.sin(W * t), *(0.0 * t for _ in rest)])
    np.savetxt(tmp_path / "g.csv", rows, delimiter=",", fmt="%.17g")
    given = {"amplitude": lambda: model.gravity("-y", lambda t: G * np.sin(W * t)),
             "function": lambda: model.gravity(
                 (lambda t: (0.0, -G * np.sin(W * t))) if planar else
                 (lambda t: (0.0, -G * np.sin(W * t), 0.0))),
             "components": lambda: model.gravity([0.0, lambda t: -G * np.sin(W * t), *rest]),
             "table": lambda: model.gravity(rows),
             "file": lambda: model.gravity(tmp_path / "g.csv")}
    given[way]()
    errors = []
    for h in (0.02, 0.01):
        result = simulate(model, h, 1.0)
        errors.append(np.abs(result["a.position"][:, 1] - 0.2 - falling(result.t)).max())
        assert result.energy_balance() < 0.1 * h**2
    if way in ("table", "file"):    # linear between rows, as exact as these
        assert errors[1] < G * W**2 * 0.02**2 / 12
    else:
        assert 3.9 < errors[0] / errors[1] < 4.1 and errors[1] < 3e-4
    supplied = [name for name in result.numbering.port_names if result[f"{name}.work"].any()]
    assert len(supplied) == 1 and supplied[0].startswith("gravity")
    power = 2.5 * G * W * np.cos(W * result.t) * (result["a.position"][:, 1] + 0.1)
    # at the rows of a table the slope is that of the piece behind it
    off = G * W**2 * 0.01 * 2.5 * 3.0 if way in ("table", "file") else 0.05
    assert np.abs(result[f"{supplied[0]}.power"] - power)[:-1].max() < off


@pytest.mark.filterwarnings("ignore:body 'rock' is not connected")
@pytest.mark.parametrize("at", [0.5, 0.503])
@pytest.mark.parametrize("tolerance", [None, Tolerance(1e-6)])
def test_gravity_jumps(at, tolerance):
    """Exactly, and the energy of the jump is that which the potential gains."""
    model = rock()
    model.gravity((0.0, -G), [(0.0, 1.0), (at, 1.0), (at, -0.3), (1.0, -0.3)])
    result = simulate(model, 0.01, 1.0, tolerance=tolerance)
    late = np.maximum(result.t - at, 0.0)
    way = -G * result.t**2 / 2 + 1.3 * G * late**2 / 2
    assert np.abs(result["a.position"][:, 1] - 0.2 - way).max() < 1e-13
    assert result.energy_balance() < 1e-13
    gained = 2.5 * G * -1.3 * (0.3 - G * at**2 / 2)
    assert result["gravity.work"][-1] == pytest.approx(gained, rel=1e-13)


def test_a_base_that_moves_is_gravity_the_other_way():
    """Order 2: what either model has of the scheme's error differs."""
    apart = []
    for h in (2e-3, 1e-3):
        own, other = (simulate(one, h, 0.5) for one in (
            pendulum(field=(lambda t: 300.0 * np.sin(7.0 * t),
                            lambda t: -981.0 + 150.0 * np.sin(7.0 * t)), factor=None),
            pendulum(moved=True)))
        way = other["tip.position"] - other["base.position"]
        apart.append(np.abs(own["tip.position"] - way).max())
        assert own.energy_balance() < 30.0 * h**2
    assert 3.9 < apart[0] / apart[1] < 4.1
    assert apart[1] < 4e-6 * np.ptp(way[:, 0])


def test_runs_go_on_and_steps_are_chosen(tmp_path):
    model = pendulum()
    whole = simulate(model, 1e-3, 0.2)
    run = Simulation(model, 1e-3)
    run.run_to(0.1)
    assert run.read("energy.potential") == run.result()["energy.potential"][-1]
    assert run.read("gravity.power") == pytest.approx(run.result()["gravity.power"][-1], rel=1e-12)
    save_state(run, tmp_path / "state.npz")
    again = resume(model, tmp_path / "state.npz")
    again.run_to(0.2)
    for name in ("tip.position", "gravity.work"):
        np.testing.assert_array_equal(again.result()[name][-1], whole[name][-1])
    chosen = simulate(model, 0.01, 0.2, tolerance=Tolerance(1e-7))
    assert chosen.energy_balance() < 1e-6
    assert np.abs(chosen["tip.position"] - whole["tip.position"][::10]).max() < 1e-3


def test_equilibria_and_frequencies_are_those_of_a_time():
    model, still = pendulum(), pendulum(factor=None)
    still.gravity(amplitude(0.1) * DOWN)
    assert gravity_at(model, 0.1) == pytest.approx(still.gravity_field, rel=1e-12)
    own, other = equilibrium(model, t=0.1), equilibrium(still)
    assert own["tip.position"][-1] == pytest.approx(other["tip.position"][-1], rel=1e-9)
    assert modes(own).omega == pytest.approx(modes(other).omega, rel=1e-7)
    assert linearize(own).stiffness == pytest.approx(linearize(other).stiffness, rel=1e-6, abs=1e-2)


def test_gradients_are_those_of_differences():
    scheme, names = generalized_alpha(0.9, tolerance=1e-10), ("potential", "kinetic", "strain")
    kept = {"tip": final("tip.position")} | {n: final(f"energy.{n}") for n in names}
    found = gradient(pendulum(), 1e-3, 0.1, kept, ["gravity"])

    def end(field):
        result = simulate(pendulum(field=field), 1e-3, 0.1, scheme)
        return np.append(result["tip.position"][-1], [result[f"energy.{n}"][-1] for n in names])
    steps = 0.05 * np.eye(2)
    expected = np.stack([(end(DOWN + d) - end(DOWN - d)) / 0.1 for d in steps], axis=1)
    size = np.abs(expected).max(axis=1, keepdims=True)
    assert np.abs(found.matrix - expected).max() < 1e-5 * size.max()
    assert (np.abs(found.matrix - expected) / size)[:4].max() < 1e-6
    with pytest.raises(InputError, match="gravity has components that are functions of time.*give "
                       "model.gravity a field and its amplitude"):
        gradient(pendulum(field=lambda t: (t, -981.0), factor=None), 1e-3, 0.01,
                 {"tip": final("tip.position")}, ["gravity.y"])


def test_members_of_ensembles_have_their_own_gravity(monkeypatch):
    monkeypatch.setattr("sebody.explore.ensembles.ensemble.WORTH_IT", 0)
    fields = DOWN + np.random.default_rng(3).uniform(-100.0, 100.0, (9, 2))
    kept = {"end": final("tip.position"), "work": final("gravity.work"),
            "potential": final("energy.potential")}
    found = Ensemble(pendulum(), 1e-3).run({"gravity": fields}, 0.05, kept)
    assert not found.failures
    for k, field in enumerate(fields):
        one = simulate(pendulum(field=field), 1e-3, 0.05)
        for name, quantity in kept.items():
            assert found.values[name][k] == pytest.approx(one[quantity.quantity][-1], rel=1e-9)


@pytest.mark.parametrize(("given", "message"), [
    (([(0.0, 0.0, 0.0), (1.0, 0.0, -9.0)], lambda t: t), "components over time and an amplitude"),
    ((lambda t: (0.0, 0.0, t),), "returns .*: let it return 2 numbers"),
    ((lambda t: t.x,), "fails at t = 0.*give a function of time that returns 2 numbers"),
    (([(0.0, -9.81), (1.0, 0.0)],), "table of 2 columns: give rows of a time and 2 numbers"),
    ((ramp(1.0),), "one profile: give a constant field and the profile as its amplitude="),
    (("gravity.csv",), "gravity.csv"),
    (((0.0, -9.81), "factor.csv"), "gravity: amplitude.*factor.csv"),
    (([0.0, [(1.0, 0.0), (0.0, 1.0)]],), "times"),
])
def test_bad_gravity_of_time_is_refused(given, message):
    model = Model(planar=True)
    with pytest.raises(InputError, match=message):
        model.gravity(*given)
    assert not model.gravity_field.any() and not model.gravity_courses
