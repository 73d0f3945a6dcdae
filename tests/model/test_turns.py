"""Turns of a torsion spring in space are counted, however a run is made; oriented bushings."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from sebody import (
    InputError,
    Model,
    Simulation,
    Tolerance,
    generalized_alpha,
    simulate,
)
from sebody.analysis import Ensemble, equilibrium, linearize, resume, save_state
from sebody.model.numbering import stretch
from sebody.model.variants import planar
from sebody.results import Result

AXIS = np.array([1.0, -2.0, 0.5]) / np.sqrt(5.25)
PLACE = np.array([0.3, -0.4, 0.7])
FINE = generalized_alpha(0.95, 1e-11)
SMALL = 1e-5                # a load under which bodies do not turn but in second order
K, C, REST, J = 2.0, 0.04, 0.4, (0.5, 0.7)     # inertia of both wheels about the axis


def wheels(speed=12.0, **spring):
    """Two wheels on one axis through the origin of space, a spring between them."""
    model = Model()
    turn = Rotation.align_vectors([AXIS], [[0.0, 0.0, 1.0]])[0].as_matrix()
    for name, inertia in zip("ab", J, strict=True):
        model.node(name, PLACE)
        model.rigid_body(name, name, 1.0, turn @ np.diag([1.0, 1.1, inertia]) @ turn.T)
        model.revolute(name, AXIS)
    options = {"stiffness": K, "damping": C, "rest": REST} | spring
    model.torsion_spring("a", axis=AXIS, to="b", name="spring", **options)
    model.initial_velocity("a", angular=speed * AXIS)
    model.initial_velocity("b", angular=0.5 * AXIS)
    return model


def relative(t, speed=12.0):
    """Angle of the first wheel against the second one, and its rate."""
    def rate(_, y):
        return [y[1], -(K * (y[0] - REST) + C * y[1]) * (1.0 / J[0] + 1.0 / J[1])]
    return solve_ivp(rate, (0.0, t[-1]), [0.0, speed - 0.5], t_eval=t, rtol=1e-11, atol=1e-12).y


def moment(result):
    return result["spring.moment"] @ AXIS


def test_turns_are_counted():
    """Four radians from rest and back again and again: the moment goes on."""
    result = simulate(wheels(), 2e-3, 6.0, FINE)
    angle, rate = relative(result.t)
    assert angle.max() > np.pi + 0.5
    assert moment(result) == pytest.approx(-(K * (angle - REST) + C * rate), abs=5e-4)
    assert result.energy_balance() < 1e-4
    strain = K / 2 * (angle - REST)**2
    assert result["energy.strain"] == pytest.approx(strain, abs=3e-4 * strain.max())


def test_many_turns_one_way():
    """A motor winds up the spring by twenty turns, at eight radians a step at most."""
    model = wheels(speed=0.5, damping=0.0, rest=0.0)
    model.torque("a", AXIS, [(0.0, 0.0), (4.0, 200.0), (30.0, 200.0)])
    model.torque("b", -AXIS, [(0.0, 0.0), (4.0, 200.0), (30.0, 200.0)])
    model.torsion_spring("a", damping=3.0, axis=AXIS, to="b")
    result = simulate(model, 5e-3, 30.0)
    assert moment(result)[-1] == pytest.approx(-200.0, rel=1e-6)
    assert result["energy.strain"][-1] == pytest.approx(200.0**2 / (2 * K), rel=1e-5)


@pytest.mark.parametrize("how", ["variable", "resumed", "index 2"])
def test_however_the_run_is_made(how, tmp_path):
    t_end, h = 3.0, 5e-3
    if how == "variable":
        run = Simulation(wheels(), 0.02, tolerance=Tolerance(1e-6)).run_to(t_end)
    elif how == "resumed":
        whole = Simulation(wheels(), h).run_to(t_end).result()
        first = Simulation(wheels(), h).run_to(0.7)
        run = resume(wheels(), save_state(first, tmp_path / "half.npz")).run_to(t_end)
        assert np.array_equal(run.result().rows, whole.rows)
    else:
        run = Simulation(wheels(), h, generalized_alpha(index=2)).run_to(t_end)
    result = run.result()
    angle, rate = relative(result.t)
    assert angle.max() > np.pi + 0.5
    assert moment(result) == pytest.approx(-(K * (angle - REST) + C * rate), abs=5e-3)
    loaded = Result.load(result.save(tmp_path / "run.npz"))
    assert np.array_equal(moment(loaded), moment(result))


def test_cut_steps_begin_with_the_turns_of_the_last_accepted_one():
    """A spring that hardens: some long steps fail and are cut. A step turns 3.0 rad at most."""
    h, cubic, cuts = 0.025, 8.0, 0
    for speed in (105.0, 110.0, 115.0, 120.0):      # rounding decides which of them are cut
        result = simulate(wheels(speed=speed, damping=0.0, cubic=cubic, rest=0.0), h, 200 * h)
        a, b = (result[f"{name}.rotation"] for name in "ab")
        turned = Rotation.from_matrix(np.swapaxes(b, 1, 2) @ a).as_rotvec() @ AXIS
        wound = np.array([brentq(lambda u, M=M: K * u + cubic * u**3 + M, -20.0, 20.0, xtol=1e-14)
                          for M in moment(result)])
        assert np.abs(wound).max() > np.pi + 1.0
        # what the moment belongs to is the angle of the wheels with whole turns, without jumps
        assert np.abs(np.angle(np.exp(1j * (wound - turned)))).max() < 1e-9
        assert np.abs(np.diff(wound)).max() < np.pi
        cuts += result.cuts
    assert cuts > 0


def test_ensembles_count_turns():
    speeds = np.array([3.0, 9.0, 14.0])
    found = Ensemble(wheels(), 5e-3).run(
        {"a.angular_velocity": speeds[:, None] * AXIS}, 1.0, {"moment": "spring.moment"})
    for speed, time_function in zip(speeds, found["moment"], strict=True):
        angle, rate = relative(np.linspace(0.0, 1.0, 201), speed)
        assert time_function @ AXIS == pytest.approx(-(K * (angle - REST) + C * rate), abs=5e-3)


@pytest.mark.parametrize("turn", [3.3, -9.0, 20.0])
def test_equilibria_beyond_half_a_turn(turn):
    """Torque k u at the angle u from rest; small motion about it has the spring's stiffness."""
    model = Model()
    model.node("a", PLACE)
    model.rigid_body("a", "a", 1.0, 0.5 * np.ones(3))
    model.revolute("a", AXIS)
    model.torsion_spring("a", K, axis=AXIS, rest=REST, name="spring")
    model.torque("a", K * (turn - REST) * AXIS)
    result = equilibrium(model, 16)
    assert moment(result)[-1] == pytest.approx(-K * (turn - REST), rel=1e-9)
    assert result["energy.strain"][-1] == pytest.approx(K / 2 * (turn - REST)**2, rel=1e-9)
    assert linearize(result).stiffness == pytest.approx(np.array([[K]]), rel=1e-9)


def bushed(rotation, planar_model=False):
    model = Model(planar=planar_model)
    d = 2 if planar_model else 3
    node = model.node("body", np.arange(1.0, 1.0 + d))
    model.rigid_body("body", node, 2.0, 0.3 if planar_model else (0.3, 0.4, 0.5))
    if planar_model:
        model.bushing(node, stiffness=(900.0, 40.0), turning_stiffness=700.0, rotation=rotation)
    else:
        model.bushing(node, stiffness=(900.0, 40.0, 300.0), damping=(0.0, 3.0, 1.0),
                      turning_stiffness=(700.0, 80.0, 500.0), turning_damping=(1.0, 0.0, 2.0),
                      rotation=rotation, name="rubber")
    return model


def test_bushings_along_any_axes():
    """Matrices of small motion are ``E diag(k) E^T``, and a force moves the body as these do."""
    E = Rotation.random(random_state=5).as_matrix()
    run = Simulation(bushed(E), 0.01)
    found, node = linearize(run), run.model.nodes["body"]
    at = [stretch(run.numbering, dof_block) for dof_block in (node.position, node.rotation)]
    stiffness = [E @ np.diag(k) @ E.T for k in ((900.0, 40.0, 300.0), (700.0, 80.0, 500.0))]
    damping = [E @ np.diag(c) @ E.T for c in ((0.0, 3.0, 1.0), (1.0, 0.0, 2.0))]
    for own, parts in ((found.stiffness, stiffness), (found.damping, damping)):
        exact = np.zeros((6, 6))
        exact[at[0], at[0]], exact[at[1], at[1]] = parts
        free = found.free.T @ exact @ found.free
        assert own == pytest.approx(free, abs=1e-9 * np.abs(free).max())
    load = SMALL * np.array([3.0, -2.0, 5.0])
    model = bushed(E)
    model.force("body", load)
    moved = equilibrium(model, 1)["body.position"]
    assert moved[-1] - moved[0] == pytest.approx(np.linalg.solve(stiffness[0], load), rel=1e-6)


def test_an_oriented_bushing_in_a_plane():
    E = Rotation.from_euler("z", 0.7).as_matrix()[:2, :2]
    model = bushed(E, planar_model=True)
    model.force("body", SMALL * np.array([3.0, -2.0]))
    moved = equilibrium(model, 1)["body.position"]
    exact = SMALL * E @ ((E.T @ (3.0, -2.0)) / (900.0, 40.0))
    assert moved[-1] - moved[0] == pytest.approx(exact, rel=1e-6)


def test_the_planar_variant_keeps_the_axes():
    """Two of the three lie in the plane of the model, in an order of their own."""
    E = Rotation.from_euler("z", 0.7).as_matrix()[:, [2, 0, 1]]
    model = Model()
    node = model.node("body", (1.0, 2.0, 0.0))
    model.rigid_body("body", node, 2.0, (0.3, 0.4, 0.5))
    model.bushing(node, stiffness=(300.0, 900.0, 40.0), turning_stiffness=(500.0, 7.0, 8.0),
                  rotation=E)
    model.force("body", (3.0, -2.0, 0.0))
    flat = planar(model).model
    ends = [equilibrium(m, 1)["body.position"][-1, :2] for m in (model, flat)]
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)


def test_bad_axes_of_a_bushing_are_refused():
    with pytest.raises(InputError, match="bushing at 'body': rotation"):
        bushed(np.diag([1.0, 1.0, -1.0]))
