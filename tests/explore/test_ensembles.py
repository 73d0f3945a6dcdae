"""Many runs in threads: each equals the run of a model with the same numbers."""

import differentiated
import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation
from sebody.analysis import Ensemble, at_time, final, integral, maximum, minimum, rms
from sebody.explore.ensembles import member
from sebody.explore.ensembles.start_values import Image
from sebody.fem import Section, straight_beam
from sebody.parameters.table import handle
from sebody.reduction import craig_bampton
from sebody.reduction.scaling import scaled
from sebody.runs.outputs import forms

H, T_END = 1e-3, 0.03
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=5.1, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)


def beam_body(modes: int = 2, ratio: float = 0.02):
    """A damped beam from (3, -2, 1) along a direction in general position."""
    end = np.array([3.0, -2.0, 1.0]) + TURN @ (100.0, 0, 0)
    fe_model = straight_beam((3.0, -2.0, 1.0), end, SECTION, elements=6)
    return craig_bampton(fe_model, [(0, "full"), (6, "full")], modes=modes).damped(ratio)


def model(hinge: bool) -> Model:
    """A damped beam with a tip mass, a spring to the ground, a torque and gravity."""
    body, made = beam_body(), Model()
    base, tip = (made.node(name, point) for name, point in zip(("base", "tip"), body.coordinates,
                                                               strict=True))
    anchor = made.node("anchor", tip.point + (5.0, 12.0, -4.0))
    made.fix(anchor)
    made.superelement("beam", body, [base, tip])
    made.point_mass("weight", tip, 0.5)
    made.spring(tip, anchor, stiffness=40.0, damping=0.2, cubic=0.5, name="spring")
    made.gravity((0.0, -3.0, 9.0))
    if hinge:
        made.revolute(base, axis=TURN @ (0, 0, 1), name="hinge")
    made.torque(base, TURN @ (0, 0, 1), [(0, 0), (0.01, 6e4), (0.02, 1e4)], name="motor")
    return made


def single(made: Model, changes: dict) -> "Simulation":
    """The run of the model with some quantities set."""
    handles = [handle(made, name) for name in changes]
    for one, value in zip(handles, changes.values(), strict=True):
        one.set(value)
    try:
        return Simulation(made, H).run_to(T_END).result()
    finally:
        for one in handles:
            one.reset()


VARIED = {"motor.amplitude": 1.3, "motor.table": [0.0, 4e4, 2e4], "beam.stiffness": 0.7,
          "beam.mass": 1.4, "beam.damping": 2.5, "weight.mass": 2.0, "spring.stiffness": 70.0,
          "spring.damping": 0.0, "spring.length": 9.0, "gravity": [4.0, 1.0, -2.0],
          "tip.position": [1.0, 0.5, -0.5], "tip.velocity": [30.0, -20.0, 10.0],
          "tip.rotation": [0.01, 0.02, -0.03]}


@pytest.fixture(scope="module")
def free() -> Ensemble:
    return Ensemble(model(hinge=False), H)


@pytest.fixture(scope="module")
def hinged() -> Ensemble:
    return Ensemble(model(hinge=True), H)


@pytest.mark.parametrize("name", VARIED)
def test_a_run_equals_that_of_a_model_with_the_same_numbers(free, name):
    value = np.array(VARIED[name])
    if name == "tip.position":
        value = value + handle(free.model, name).base
    outputs = {"tip": "tip.position", "turn": "base.rotation", "force": "beam.tip.force"}
    found = free.run({name: np.stack([value, value])}, T_END, outputs)
    expected = single(free.model, {name: value})
    assert not found.failures
    for output, quantity in outputs.items():
        scale = np.abs(expected[quantity]).max()
        # two solvers for the first accelerations, whose rounding the motion carries on
        assert np.abs(found[output][1] - expected[quantity]).max() < 1e-10 * scale
    as_built = single(free.model, {})
    assert np.abs(as_built["tip.position"] - expected["tip.position"]).max() > 1e-6


def test_section_forces_know_the_gravity_of_their_run():
    """They contain the static response to weight and inertia of what the modes leave out."""
    made, quantity = differentiated.hinged(modes=2), "beam.node2.section_forces"
    value = np.array([4.0, 1.0, -2.0])
    found = Ensemble(made, 0.005).run({"gravity": value[None]}, 0.02, {"sections": quantity})
    made.gravity(value)
    expected = Simulation(made, 0.005).run_to(0.02).result()[quantity]
    assert np.abs(found["sections"][0] - expected).max() < 1e-9 * np.abs(expected).max()


def test_numbers_and_stiffness_change_by_copies_rotations_by_building(free):
    linear = [n for n in VARIED if Image(free._template, {n: handle(free.model, n)}).linear]
    assert set(VARIED) - set(linear) == {"tip.rotation"}


@pytest.mark.parametrize("joint, own", [("implicit", False), ("explicit", True), ("slider", True)])
def test_a_joint_with_the_ground_takes_its_body_along(joint, own):
    """A pendulum whose hinge is elsewhere swings there, in the same way."""
    made, shift = Model(), np.array([0.3, -0.2, 0.5])
    node = made.node("node", (1.0, 2.0, 3.0))
    made.rigid_body("bob", node, 2.0, np.diag((0.1, 0.2, 0.3)), TURN @ (0.7, 0.1, 0) + node.point)
    axis = TURN @ (0, 0.6, 0.8)
    if joint == "slider":
        made.slider(node, axis, name="hinge")
    else:
        made.revolute(node, axis, name="hinge", explicit=own)
    made.gravity((0.0, -3.0, 9.0))
    given = {"hinge.position": node.point + np.outer((0, 1), shift)}
    many = Ensemble(made, H)
    if own:     # a position of its own, which has to fit
        alone = many.run(given, T_END, {"way": "node.position"})
        assert "violates 'hinge' by" in alone.failures[1]
        given["node.position"] = given["hinge.position"]
    found = many.run(given, T_END, {"way": "node.position", "turn": "node.rotation"})
    assert not found.failures
    np.testing.assert_allclose(found["way"][1], found["way"][0] + shift, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found["turn"][1], found["turn"][0], rtol=0, atol=1e-12)
    assert np.abs(found["turn"][0][-1] - np.eye(3)).max() > 1e-4


def test_several_parameters_together_with_a_joint(hinged):
    rng = np.random.default_rng(3)
    parameters = {"motor.amplitude": rng.uniform(0.5, 1.5, 6),
                  "beam.stiffness": rng.uniform(0.8, 1.2, 6),
                  "beam.mass": rng.uniform(0.8, 1.2, 6), "gravity": rng.normal(0, 5, (6, 3))}
    found = hinged.run(parameters, T_END, {"tip": final("tip.position"), "hinge": "hinge.force"})
    for k in range(6):
        expected = single(hinged.model, {n: v[k] for n, v in parameters.items()})
        assert np.abs(found["tip"][k] - expected["tip.position"][-1]).max() < 1e-8
        scale = np.abs(expected["hinge.force"]).max()
        assert np.abs(found["hinge"][k] - expected["hinge.force"]).max() < 1e-8 * scale


def test_whole_bodies_of_one_layout(hinged):
    others = [beam_body(ratio=0.02), scaled(beam_body(ratio=0.1), stiffness=2.0)]
    found = hinged.run({"beam.reduced": others}, T_END, {"tip": final("tip.position")})
    for k, body in enumerate(others):
        expected = single(hinged.model, {"beam.reduced": body})
        assert np.array_equal(found["tip"][k], expected["tip.position"][-1])
    assert np.abs(found["tip"][0] - found["tip"][1]).max() > 1e-6
    with pytest.raises(InputError, match="beam.reduced: one has modes 1, the model's 2"):
        handle(hinged.model, "beam.reduced").set(beam_body(modes=1))
    assert list(hinged.model.bodies) == ["beam"]


def test_scaled_bodies_have_scaled_frequencies():
    body = beam_body()
    other = scaled(body, stiffness=2.0, mass=0.5, damping=3.0)
    assert np.allclose(other.stiffness, 2 * body.stiffness, rtol=1e-15)
    assert other.total_mass == pytest.approx(0.5 * body.total_mass, rel=1e-14)
    assert np.allclose(other.damping, 3 * body.damping, rtol=1e-15)


def test_threads_and_groups_change_no_bit(hinged):
    factors = np.linspace(0.6, 1.4, 9)
    runs = {"motor.amplitude": factors}
    outputs = {"tip": "tip.position", "work": final("energy.external_work"),
               "moment": maximum("hinge.moment", norm=True)}
    one = hinged.run(runs, T_END, outputs, threads=1)
    many = hinged.run(runs, T_END, outputs, threads=4)
    halves = [hinged.run({"motor.amplitude": part}, T_END, outputs) for part in
              (factors[:2], factors[2:])]
    for name in outputs:
        assert np.array_equal(one[name], many[name])
        assert np.array_equal(one[name], np.concatenate([half[name] for half in halves]))


@pytest.mark.parametrize("numbers", [10**9, 600])
def test_outputs_are_made_of_the_history(hinged, monkeypatch, numbers):
    monkeypatch.setattr(member, "MOST_NUMBERS", numbers)       # 600: stretches of a few states
    q = "tip.velocity"
    outputs = {"history": q, "max": maximum(q), "min": minimum(q), "rms": rms(q),
               "int": integral(q), "end": final(q), "at": at_time(q, 0.01037),
               "on": at_time(q, 0.004),
               "speed": maximum(q, norm=True)}
    found = hinged.run({"motor.amplitude": [0.9]}, T_END, outputs)
    v, t = found["history"][0], found.t
    assert np.array_equal(v, single(hinged.model, {"motor.amplitude": 0.9})[q]) or np.allclose(
        v, single(hinged.model, {"motor.amplitude": 0.9})[q], rtol=1e-9, atol=1e-9)
    area = ((v[1:] + v[:-1]) / 2 * np.diff(t)[:, None]).sum(axis=0)
    square = ((v[1:]**2 + v[:-1]**2) / 2 * np.diff(t)[:, None]).sum(axis=0)
    expected = {"max": v.max(axis=0), "min": v.min(axis=0), "int": area,
                "rms": np.sqrt(square / t[-1]), "end": v[-1],
                "on": v[4], "at": [np.interp(0.01037, t, v[:, k]) for k in range(3)],
                "speed": np.linalg.norm(v, axis=1).max()}
    for name, value in expected.items():
        assert np.allclose(found[name][0], value, rtol=1e-12, atol=1e-12 * np.abs(v).max()), name


@pytest.mark.parametrize("quantity, plain", [
    ("tip.position", True), ("tip.velocity.z", True), ("tip.rotation", None),
    ("tip.rotation.z", False), ("tip.velocity.norm", False), ("beam.modes", True),
    ("energy.external_work", None), ("energy.kinetic", False)])
def test_columns_of_recorded_rows_are_the_quantity(hinged, quantity, plain):
    """What is read as columns is what a result gives, in states with nothing in common."""
    run = Simulation(hinged.model, 1e-3)
    run.run_to(3e-3)
    found = forms(run, {"it": final(quantity)})[quantity]
    if plain is not None:
        assert (found.columns is not None) == plain
    if found.columns is not None:
        rows, expected = run.rows.all(), run.result()[quantity]
        assert found.shape == expected.shape[1:]
        assert np.array_equal(rows[:, found.columns].reshape(expected.shape), expected)


def test_outputs_of_every_shape_and_kind(free):
    """Columns of rows, matrices and what elements give: each kind from the history beside it."""
    kinds = {"max": maximum, "min": minimum, "rms": rms, "int": integral, "end": final}
    quantities = ("tip.rotation", "tip.position.y", "energy.kinetic", "tip.rotation.z")
    outputs = {f"{q} {kind}": make(q) for q in quantities for kind, make in kinds.items()}
    found = free.run({"beam.stiffness": np.linspace(0.8, 1.3, 11)}, T_END,
                     outputs | {q: q for q in quantities}, threads=2)
    for q in quantities:
        x, t = found[q], found.t
        expected = {"max": x.max(axis=1), "min": x.min(axis=1), "int": trapezoid(x, t, axis=1),
                    "rms": np.sqrt(trapezoid(x**2, t, axis=1) / T_END), "end": x[:, -1]}
        for kind, value in expected.items():
            assert np.allclose(found[f"{q} {kind}"], value, rtol=1e-12,
                               atol=1e-12 * np.abs(x).max()), (q, kind)


def test_initial_rotation_of_a_rigid_body():
    made = Model()
    made.node("body", (1.0, 2.0, 3.0))
    made.rigid_body("mass", "body", 2.0, (1.0, 2.0, 2.5))
    vectors = np.random.default_rng(1).normal(size=(3, 3))
    found = Ensemble(made, H).run({"body.rotation": vectors}, T_END, {"R": "body.rotation"})
    expected = Rotation.from_rotvec(vectors).as_matrix()
    # at rest without loads: it stays as it was put, to rounding
    assert np.abs(found["R"] - expected[:, None]).max() < 1e-14


def test_failed_runs_keep_their_reason_and_their_data(hinged):
    spins = [[0.0, 0.0, 0.0], [50.0, -80.0, 30.0], [0.0, 0.0, 0.0]]
    found = hinged.run({"base.angular_velocity": spins, "motor.amplitude": [1.0, 1.0, 1e9]}, T_END,
                       {"tip": "tip.position", "end": final("tip.position")})
    assert list(found.done) == [True, False, False]
    assert "contradicts joints, drives" in found.failures[1] and np.isnan(found["tip"][1]).all()
    assert found.failures[2].startswith("stopped at t = ")
    assert 0 <= found.reached[2] < T_END
    steps = round(found.reached[2] / H)
    assert np.isfinite(found["tip"][2, :steps]).all() and np.isnan(found["tip"][2, -1]).all()
    alone = hinged.run({"motor.amplitude": [1.0]}, T_END, {"tip": "tip.position"})
    assert np.allclose(found["tip"][0], alone["tip"][0], rtol=1e-9)


def test_ctrl_c_returns_what_is_done(hinged):
    def progress(part: float) -> None:
        if part > 0:
            raise KeyboardInterrupt
    found = hinged.run({"motor.amplitude": np.full(4000, 1.0)}, T_END,
                       {"end": final("tip.position")}, progress=progress)
    assert found.interrupted and 0 < found.done.sum() < 4000
    assert np.isfinite(found["end"][found.done]).all()
    assert found.failures[3999] == "interrupted before its end"


REFUSED = {
    "unknown": ({"motor.amplitud": [1.0]}, {}, "did you mean 'motor.amplitude'"),
    "nothing like it": ({"x": [1.0]}, {}, "parameter 'x' is unknown: the model has gravity"),
    "lengths": ({"motor.amplitude": [1.0, 2.0], "beam.mass": [1.0]}, {},
                "different numbers of values: motor.amplitude 2, beam.mass 1"),
    "negative mass": ({"beam.mass": [1.0, -0.5]}, {}, "beam.mass of run 1 is -0.5: it must be "
                                                      "above 0"),
    "negative damping": ({"spring.damping": [-1.0]}, {}, "it must be at least 0"),
    "shape": ({"gravity": [1.0, 2.0]}, {}, r"give an array \(runs, 3\)"),
    "nan": ({"beam.mass": [np.nan]}, {}, "beam.mass"),
    "no parameters": (3, {}, "give a dict of names and arrays"),
    "bodies": ({"beam.reduced": [3]}, {}, "give ReducedBody objects"),
    "quantity": ({"beam.mass": [1.0]}, {"outputs": {"x": "tip.place"}}, "'place' is unknown"),
    "outputs": ({"beam.mass": [1.0]}, {"outputs": []}, "give a dict of names and quantities"),
    "late": ({"beam.mass": [1.0]}, {"outputs": {"x": at_time("tip.position", 9.0)}},
             "asked for at t = 9"),
    "grid": ({"beam.mass": [1.0]}, {"t_end": 0.0015}, "not a multiple of the step"),
    "threads": ({"beam.mass": [1.0]}, {"threads": 0}, "threads"),
    "no damping": ({"weight.damping": [1.0]}, {}, "did you mean"),
    "a bar's drive": ({"hinge.position": [[0, 0]]}, {}, r"give an array \(runs, 3\)"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused_before_the_first_run(hinged, case):
    parameters, others, message = REFUSED[case]
    arguments = {"t_end": T_END, "outputs": {"end": final("tip.position")}} | others
    with pytest.raises(InputError, match=message):
        hinged.run(parameters, **arguments)


def test_stops_and_friction_have_no_amplitude():
    """Their axis is a constant of the same name as the direction of a force."""
    made = Model()
    made.rigid_body("bar", made.node("pin", (1.0, 2.0, 0.5)), 1.0, (0.1, 0.1, 0.1), (1.5, 2.0, 0.5))
    made.revolute("pin", axis=TURN @ (0, 0, 1), name="hinge")
    made.stop("hinge", upper=0.1, stiffness=1e4, name="buffer")
    made.friction("hinge", coefficient=0.1, radius=0.1, name="rub")
    made.force("pin", (1, 0, 0), 2.0, name="push")
    offered = [name for name in Ensemble(made, H).parameters if "amplitude" in name]
    assert offered == ["push.amplitude"]
    for name in ("buffer", "rub"):
        with pytest.raises(InputError, match=f"'{name}' is not a force or torque"):
            handle(made, f"{name}.amplitude")


def test_the_model_is_left_as_it_was(hinged):
    before = single(hinged.model, {})["tip.position"]
    hinged.run({name: [VARIED[name]] for name in ("beam.mass", "motor.table", "gravity")}, T_END,
               {"end": final("tip.position")})
    assert np.array_equal(single(hinged.model, {})["tip.position"], before)


def test_a_body_with_loads_of_its_own_is_not_exchanged():
    body, made = beam_body(), Model()
    loaded = craig_bampton(straight_beam((0, 0, 0), (100.0, 0, 0), SECTION, elements=6),
                           [(0, "full"), (6, "full")], modes=2,
                           loads={"weight": np.ones(42)})
    ends = [made.node(name, point) for name, point in zip("ab", loaded.coordinates, strict=True)]
    made.superelement("beam", loaded, ends)
    made.body_load("beam", "weight")
    with pytest.raises(InputError, match="'beam' has loads of its own.*build a model for each"):
        Ensemble(made, H).run({"beam.reduced": [body]}, T_END, {"end": final("b.position")})
