"""Springs and dampers by tables and functions against SciPy's integrals, and their energy."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.analysis import Ensemble, equilibrium, final, gradient, resume, save_state, vibrations
from sebody.fem import rectangle
from sebody.model.variants import planar

TURN = Rotation.from_rotvec((0.3, 1.1, -0.4)).as_matrix()
PLACE = np.array([0.4, -2.0, 1.0])
X, Y, Z = TURN.T
EXACT = generalized_alpha(1.0, index=2, tolerance=1e-12)
ROWS = [(-0.5, -30.0), (-0.2, -8.0), (0.0, 0.0), (0.15, 4.0), (0.4, 20.0), (0.6, 60.0)]
DAMPER = [(-2.0, -0.5), (-0.5, -0.4), (0.0, 0.0), (0.5, 1.0), (2.0, 1.5)]
MASS, LENGTH, START, SPEED = 2.0, 1.0, 0.3, 1.5


def mass_on(space=True, **given):
    """A mass on a slider, stretched and moving, on a spring to the ground."""
    model = Model(planar=not space)
    along, place = (X, PLACE) if space else (np.array([0.6, 0.8]), PLACE[:2])
    model.node("base", place)
    model.fix("base")
    model.node("mass", place + (LENGTH + START) * along)
    model.rigid_body("body", "mass", MASS, (0.1, 0.1, 0.1) if space else 0.1)
    model.prismatic("mass", along, name="guide")
    model.initial_velocity("mass", SPEED * along)
    model.spring("mass", "base", length=LENGTH, name="spring", **given)
    return model


def table(rows):
    """A monotone cubic with straight ends."""
    u, f = np.array(rows).T
    inside = PchipInterpolator(u, f)
    slopes = inside.derivative()(u)

    def at(x):
        held = np.clip(x, u[0], u[-1])
        return inside(held) + (x - held) * np.where(x < u[0], slopes[0], slopes[-1])
    return at


def motion(force, damper, times):
    found = solve_ivp(lambda t, y: (y[1], -(force(y[0]) + damper(y[1])) / MASS), (0, times[-1]),
                      (START, SPEED), "DOP853", times, rtol=1e-12, atol=1e-13, max_step=2e-3)
    return found.y[0]


def extrapolated(model_of, h, t_end):
    """Displacement from runs of two steps, without their error of the second order."""
    one, other = (simulate(model_of(), step, t_end, scheme=EXACT) for step in (h, h / 2))
    places = [run["guide.displacement"] for run in (one, other)]
    return one.t, (4.0 * places[1][::2] - places[0]) / 3.0


@pytest.mark.parametrize("space", [True, False])
def test_a_table_against_scipy(space):
    """Beyond both ends of the table, too."""
    def model():
        return mass_on(space, force=ROWS, damping=DAMPER)
    t, found = extrapolated(model, 2e-4, 1.0)
    exact = motion(table(ROWS), table(DAMPER), t) - START
    assert (exact + START).min() < -0.2 and (exact + START).max() > 0.4
    np.testing.assert_allclose(found, exact, atol=1e-8)


def test_energy_is_the_integral_of_the_table():
    """Strain energy, and the balance of a run without a damper."""
    result = simulate(mass_on(force=ROWS), 1e-3, 2.0)
    stretch = LENGTH + START + result["guide.displacement"] - LENGTH
    for k in (0, 300, 1100):
        wanted = quad(table(ROWS), 0.0, stretch[k], epsabs=1e-12, limit=200,
                      points=[u for u, _ in ROWS if 0 < u < stretch[k]] or None)[0]
        assert result["energy.strain"][k] == pytest.approx(wanted, rel=1e-9)
    total = result["energy.strain"] + result["energy.kinetic"]
    np.testing.assert_allclose(total, total[0], rtol=1e-4)


def test_damper_work():
    """What a damper takes is the integral of force times rate."""
    result = simulate(mass_on(force=ROWS, damping=DAMPER), 1e-3, 1.0)
    total = result["energy.strain"] + result["energy.kinetic"] - result["spring.work"]
    np.testing.assert_allclose(total, total[0], rtol=1e-4)
    power = table(DAMPER)(result["guide.speed"]) * result["guide.speed"]
    np.testing.assert_allclose(result["spring.power"], -power, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("given, law", [
    ({"stiffness": 80.0, "gap": 0.1}, lambda u: 80.0 * np.sign(u) * max(abs(u) - 0.1, 0.0)),
    ({"stiffness": 80.0, "tension_only": True}, lambda u: 80.0 * max(u, 0.0)),
    ({"stiffness": 80.0, "preload": 4.0}, lambda u: 80.0 * u + 4.0),
    ({"stiffness": 80.0, "preload": 4.0, "gap": 0.1, "tension_only": True}, lambda u: max(
        80.0 * np.sign(u) * max(abs(u) - 0.1, 0.0) + 4.0, 0.0)),
    ({"force": ROWS, "gap": 0.1}, lambda u: float(table(ROWS)(
        np.sign(u) * max(abs(u) - 0.1, 0.0)))),
    ({"force": lambda u: 30.0 * np.sinh(3.0 * u), "between": (-0.8, 0.8)},
     lambda u: 30.0 * np.sinh(3.0 * u))])
def test_forces_of_laws(given, law):
    """At the places of a run, and the forces on the mass."""
    result = simulate(mass_on(**given), 1e-3, 1.0)
    stretch = START + result["guide.displacement"]
    wanted = np.array([law(u) for u in stretch])
    assert np.ptp(stretch) > 0.3
    np.testing.assert_allclose(result["spring.force"] @ X, -wanted, atol=2e-6)


def hinged(axis=1.0, **given):
    """A wheel on a hinge with a spring of several turns."""
    model = Model()
    model.node("wheel", PLACE)
    model.rigid_body("body", "wheel", 1.0, TURN @ np.diag([0.3, 0.3, 0.4]) @ TURN.T)
    model.revolute("wheel", axis * Z, name="hinge")
    model.initial_velocity("wheel", angular=30.0 * Z)
    model.torsion_spring("hinge", name="coil", **given)
    return model


TURNS = [(-9.0, -40.0), (-3.0, -6.0), (0.0, 0.0), (4.0, 5.0), (9.0, 50.0)]


def test_a_torsion_spring_over_several_turns():
    """Angles count turns; the planar form about an axis against the normal is mirrored."""
    result = simulate(hinged(force=TURNS), 2e-3, 2.0)
    assert result["hinge.angle"].max() > 2.0 * np.pi
    moment = result["coil.moment"] @ Z
    np.testing.assert_allclose(moment, -table(TURNS)(result["hinge.angle"]), atol=1e-8)
    turned = hinged(-1.0, force=TURNS)
    flat, full = (simulate(one, 2e-3, 1.0) for one in (planar(turned)[0], turned))
    np.testing.assert_allclose(np.abs(flat["wheel.rotation"]), np.abs(full["hinge.angle"]),
                               atol=1e-7)


def test_equilibrium_and_vibrations():
    """Under a weight, and about it by the slope of the table."""
    model = mass_on(force=ROWS)
    model.initial_velocity("mass", 0.0 * X)
    model.gravity(9.0 * X)
    found = equilibrium(model)
    stretch = START + found["guide.displacement"][-1]
    assert table(ROWS)(stretch) == pytest.approx(18.0, rel=1e-8)
    slope = (table(ROWS)(stretch + 1e-6) - table(ROWS)(stretch - 1e-6)) / 2e-6
    assert vibrations(found, 1).omega[0] == pytest.approx(np.sqrt(slope / MASS), rel=1e-6)


def test_gradients_and_ensembles():
    """By its length and the mass: adjoint, forward and differences of an ensemble."""
    model, names = mass_on(force=ROWS, damping=DAMPER), ["spring.length", "body.mass"]
    outputs = {"x": final("guide.displacement")}
    one, other = (gradient(model, 1e-3, 0.3, outputs, names, mode) for mode in (
        "adjoint", "forward"))
    np.testing.assert_allclose(one.matrix, other.matrix, rtol=1e-9)
    for k, (name, base) in enumerate((("spring.length", LENGTH), ("body.mass", 1.0))):
        d = 1e-5
        found = Ensemble(model, 1e-3).run({name: [base - d, base + d]}, 0.3, outputs)["x"]
        assert (found[1] - found[0]) / (2 * d) == pytest.approx(one.matrix[0, k], rel=1e-5)


def test_a_flexible_body_and_a_saved_run(tmp_path):
    """Runs go on from a saved state bit for bit."""
    def model():
        made = Model()
        ends = [made.node(name, PLACE + s * X) for name, s in (("root", 0.0), ("tip", 1.0))]
        made.beam("beam", ends, rectangle(0.02, 0.03, 2e9, 0.3, 2000.0), 4, 1, 3)
        made.weld("root")
        made.node("wall", PLACE + X + 0.4 * Y)
        made.fix("wall")
        made.spring("tip", "wall", force=[(0.0, 0.0), (0.1, 5.0), (0.3, 40.0)], gap=0.02,
                    tension_only=True, damping=DAMPER, name="stay")
        made.force("tip", -Y, 8.0)
        return made
    whole, half = Simulation(model(), 1e-3), Simulation(model(), 1e-3)
    whole.run_to(0.2)
    half.run_to(0.1)
    save_state(half, tmp_path / "state.npz")
    rest = resume(model(), tmp_path / "state.npz").run_to(0.2).result()
    assert np.array_equal(rest.rows[-1], whole.result().rows[-1])
    assert np.abs(whole.result()["stay.force"]).max() > 0.5


def test_refused(tmp_path):
    """Tables, functions and combinations that are wrong, in words."""
    (tmp_path / "wrong.csv").write_text("u, f\n0, 1\n1, x\n")
    for given, said in (
            ({"force": [(0.0, 0.0)]}, "force has shape (1, 2): give 2 to 65 rows"),
            ({"force": [(0.0, 0.0), (0.0, 1.0)]}, "elongations must ascend, and behind 0 comes 0"),
            ({"force": [(0.0, 0.0), (1.0, np.nan)]}, "contains NaN or infinite entries"),
            ({"force": "nowhere.csv"}, "nowhere.csv"),
            ({"force": tmp_path / "wrong.csv"}, "has the row '1, x', which has no number"),
            ({"force": lambda u: u}, "give between=(least, largest)"),
            ({"force": ROWS, "between": (0, 1)}, "is a table, so leave between= out"),
            ({"force": lambda u: u, "between": (1, 0)}, "between is 1 to 0: give the least first"),
            ({"force": lambda u: np.sqrt(u) if u > 0 else np.nan, "between": (-1, 1)},
             "is not finite at -0.99"),
            ({"force": lambda u: 1 // 0, "between": (-1, 1)}, "cannot be evaluated (integer div"),
            ({"force": ROWS, "stiffness": 1.0}, "has a stiffness and a force: give one of them"),
            ({"force": ROWS, "cubic": 1.0}, "put the cubic in force="),
            ({"force": ROWS, "gap": -1.0}, "gap"), ({"force": ROWS, "gap": "1"}, "gap"),
            ({"force": ROWS, "preload": None}, "preload"),
            ({"force": ROWS, "tension_only": "yes"}, "tension_only"),
            ({"force": [(-1.0, 1.0), (1.0, 3.0)], "gap": 0.1}, "without elongation the force is 2"),
            ({"force": [(0.0, -2.0), (1.0, -3.0)], "tension_only": True}, "never pulls"),
            ({"damping": [(-1.0, 1.0), (1.0, 1.0)]}, "drives the rate"),
            ({"damping": lambda v: v}, "damping is a function: give a table")):
        with pytest.raises(InputError) as caught:
            mass_on(**given)
        assert said in str(caught.value), said


@pytest.mark.parametrize("named, given", [
    ("force", {"force": ROWS}), ("gap", {"stiffness": 1.0, "gap": 0.1}),
    ("stiffness", {"stiffness": ROWS}), ("stiffness", {"stiffness": (ROWS, 1.0, 1.0)}),
    ("damping", {"damping": (1.0, lambda rate: rate**3, 1.0)}),
    ("turning_stiffness", {"turning_stiffness": "law.csv"})])
def test_laws_of_bushings_are_refused(named, given):
    """Laws of their axes are not."""
    model = Model()
    model.node("a", PLACE)
    with pytest.raises(InputError, match=rf"bushing at 'a' has a law by {named}=.*"
                       r"give it to an axis, laws=\{"):
        model.bushing("a", **given)
    assert not model.loads
