"""Frequency responses and Campbell diagrams against closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Result, Simulation
from sebody.analysis import campbell, equilibrium, frequency_response
from sebody.fem import rectangle
from sebody.pictures import frequency_pictures

TURN = Rotation.from_rotvec((0.7, -1.1, 0.4)).as_matrix()
NONE = [(0.0, 0.0), (1.0, 0.0)]        # a load that does not act at rest
MASS, STIFFNESS, DAMPING = 2.0, 300.0, 4.0


def oscillator():
    """A mass on a spring with a damper along an axis, pulled by its weight."""
    model = Model()
    anchor = model.node("anchor", (1.0, 2.0, 3.0), keeps="translation")
    model.fix(anchor, "position")
    model.node("weight", (1.0, 2.0, 3.0) + TURN @ (2.0, 0, 0), keeps="translation")
    model.point_mass("mass", "weight", MASS)
    model.spring("weight", anchor, STIFFNESS, damping=DAMPING, name="spring")
    model.gravity(TURN @ (9.0, 0.0, 0.0))
    model.force("weight", TURN @ (1.0, 0, 0), NONE, name="push")
    return model


def test_a_damped_oscillator():
    omega = np.array([0.0, 3.0, np.sqrt(STIFFNESS / MASS), 40.0])
    found = frequency_response(equilibrium(oscillator(), 2), "push", [
        "weight.position", "weight.velocity", "weight.acceleration", "spring.force",
        "anchor.reaction", "energy.kinetic"], omega)
    along = TURN @ (1.0, 0, 0)
    answer = 1 / (STIFFNESS - MASS * omega**2 + 1j * omega * DAMPING)
    expected = {"weight.position": answer, "weight.velocity": 1j * omega * answer,
                "weight.acceleration": -omega**2 * answer,
                "spring.force": -(STIFFNESS + 1j * omega * DAMPING) * answer,
                "anchor.reaction": -(STIFFNESS + 1j * omega * DAMPING) * answer}
    for name, value in expected.items():
        # differences of states moved by 1e-5: rounding of 1e-11 and second order of 1e-10
        assert_allclose(found[name], value[:, None] * along, rtol=1e-7,
                        atol=1e-8 * np.abs(value).max(), err_msg=name)
    assert_allclose(found["energy.kinetic"], 0.0, atol=1e-12)       # at rest: of second order
    assert np.array_equal(found.omega, omega) and found.load == "push"


LENGTH, HEIGHT, E, RHO = 2.0, 0.02, 7e10, 2700.0


def cantilever(inertia="material"):
    """Without shear and almost without rotary inertia, in general position."""
    model = Model()
    root = np.array([1.0, -2.0, 0.5])
    model.node("root", root), model.node("tip", root + TURN @ (LENGTH, 0, 0))
    section = rectangle(HEIGHT, 0.05, E, 0.3, RHO)
    model.beam("beam", ("root", "tip"), section, 24, 1, 10, up=TURN @ (0, 1.0, 0),
               inertia=inertia)
    model.fix("root")
    model.force("tip", TURN @ (0, 1.0, 0), NONE, name="push")
    return model, section


def test_a_cantilever_beam():
    """Receptance of the tip and moment at the root of Euler and Bernoulli's beam."""
    model, section = cantilever()
    EI, mass = E * section.inertia_z, RHO * section.area
    k = np.array([0.6, 1.5, 2.4, 3.4, 5.2]) / LENGTH        # resonances: 1.875, 4.694
    omega = k**2 * np.sqrt(EI / mass)
    found = frequency_response(equilibrium(model, 1), "push", [
        "tip.position", "root.reaction_moment", "beam.node0.section_forces"], omega)
    c, s, ch, sh = np.cos(k * LENGTH), np.sin(k * LENGTH), np.cosh(k * LENGTH), np.sinh(k * LENGTH)
    receptance = (s * ch - c * sh) / (EI * k**3 * (1 + c * ch))
    # slenderness 100: shear and rotary inertia change frequencies by 2e-4, and near the second
    # resonance ten times as much of the answer
    assert_allclose(found["tip.position"], receptance[:, None] * (TURN @ (0, 1.0, 0)), rtol=5e-3,
                    atol=5e-3 * np.abs(receptance).min())
    moment = (s + sh) / (k * (1 + c * ch))
    assert_allclose(found["root.reaction_moment"], -moment[:, None] * (TURN @ (0, 0, 1.0)),
                    rtol=5e-3, atol=5e-3 * np.abs(moment).min())
    assert_allclose(found["beam.node0.section_forces"][:, 0, 5], moment, rtol=5e-3)


def test_a_load_on_a_support_is_carried_at_once():
    """Nothing moves, and the reaction is the load's own amplitude in phase with it."""
    (model, *_), across = cantilever(), TURN @ (0.6, 0.0, 0.8)
    model.force("root", across, NONE, name="on the support")
    found = frequency_response(equilibrium(model, 2), "on the support",
                               ["root.reaction", "tip.position"], [0.0, 3.0, 40.0])
    assert_allclose(found["root.reaction"], np.tile(-across, (3, 1)), atol=1e-9)
    assert_allclose(found["tip.position"], 0.0, atol=1e-12)


def test_responses_that_are_refused(tmp_path):
    rest = equilibrium(cantilever()[0], 1)
    omega = np.array([100.0])
    for call, message in (
            (lambda: frequency_response(rest, "pull", "tip.position", omega), "load 'pull' is unk"),
            (lambda: frequency_response(rest, "push", "tip.positon", omega), "mean 'tip.posi"),
            (lambda: frequency_response(rest, "push", "t", ["a"]), "omega is "),
            (lambda: frequency_response(1, "push", "t", omega), "run is 1: give a Simulation"),
            (lambda: frequency_response(Result.load(rest.save(tmp_path / "r.npz")), "push",
                                        "tip.position", omega), "read from a file")):
        with pytest.raises(InputError, match=message):
            call()
    free = Model()
    free.point_mass("mass", free.node("n", (0, 0, 0), keeps="translation"), 1.0)
    state = Simulation(free, 0.1)
    with pytest.raises(InputError, match="no force or torque whose amplitude could vary: add one"):
        frequency_response(state, "push", "n.position", omega)
    free.force("n", (1.0, 0, 0), NONE, name="push")
    with pytest.raises(InputError, match="response at omega = 0 is infinite: the undamped model"):
        frequency_response(Simulation(free, 0.1), "push", "n.position", [0.0])


def rotor(planar):
    """A mass at the middle of unequal springs that rotate with it, with a damper along one."""
    model = Model(planar=planar)
    turn = TURN[:2, :2] if planar else TURN
    turn = np.array([[0.6, -0.8], [0.8, 0.6]]) if planar else turn
    size = 2 if planar else 3
    model.node("middle", np.zeros(size), keeps="translation")
    model.point_mass("mass", "middle", MASS)
    for axis, stiffness in enumerate((150.0, 400.0, 250.0)[:size]):
        for sign in (-1.0, 1.0):
            end = model.node(f"end {axis} {sign}", turn @ (sign * np.eye(size)[axis]),
                             keeps="translation")
            model.fix(end, "position")
            model.spring("middle", end, stiffness / 2)
    return model, turn


@pytest.mark.parametrize("planar", [False, True])
def test_unequal_springs_that_rotate(planar):
    """``(kx / m - W^2 - w^2) (ky / m - W^2 - w^2) = 4 W^2 w^2``, and along the axis kz / m."""
    model, turn = rotor(planar)
    speeds = np.array([0.0, 2.0, 4.0, 7.0])
    found = campbell(model, speeds, None if planar else turn @ (0, 0, 3.0), 2 if planar else 3)
    a, b = 150.0 / MASS - speeds**2, 400.0 / MASS - speeds**2
    middle = (a + b + 4 * speeds**2) / 2
    root = np.sqrt(middle**2 - a * b)
    expected = [np.sqrt(middle - root), np.sqrt(middle + root)]
    if not planar:      # in the order at rest
        expected.insert(1, np.full(4, np.sqrt(250.0 / MASS)))
    assert_allclose(found.omega, np.stack(expected, axis=1), rtol=1e-9)
    assert_allclose(found.growth, 0.0, atol=1e-9)


def drawn(monkeypatch, draw):
    """The figure of a picture."""
    found = []
    monkeypatch.setattr(frequency_pictures, "write_picture",
                        lambda figure, *_: found.append(figure))
    draw()
    return found[0]


def test_a_campbell_diagram_tells_whirls_and_damping(monkeypatch):
    """Coloured by damping, red below zero, with marks of whirls, orders and crossings."""
    to_rgba = pytest.importorskip("matplotlib.colors").to_rgba
    speeds, count = np.linspace(0.0, 50.0, 6), 3
    omega = 10.0 * np.arange(1, count + 1) + 0.5 * speeds[:, None]
    damping = np.tile((0.1, 0.0, -0.02), (6, 1))
    whirl = np.tile(np.array(["forward", "none", "backward"]), (6, 1))
    figure = drawn(monkeypatch, lambda: frequency_pictures.save_campbell(
        "a.png", frequency_pictures.Diagram(speeds, omega, -damping * omega, damping, whirl,
                                            "standing"),
        np.array([1.0, 2.0]), np.array([[20.0, 20.0]])))
    upper, lower, bar = figure.axes
    names = [text.get_text() for text in upper.get_legend().get_texts()]
    assert names == ["forward whirl", "backward whirl"]
    lines = [one for one in upper.collections if len(one.get_array()) == 5]
    colours = [tuple(one.to_rgba(one.get_array()[:1])[0]) for one in lines]
    assert len(set(colours)) == count
    assert colours[2] == to_rgba(frequency_pictures.GROWING)
    assert {text.get_text() for text in upper.texts} == {"1 x speed", "2 x speed"}
    assert upper.get_title(loc="left") == "natural frequencies in standing axes"
    assert bar.get_ylabel() == "damping ratio"
    assert lower.get_ylabel() == "real part [1/s]"     # as of a model without units


def test_a_response_names_its_curves(monkeypatch):
    """Amplitudes of components that are not zero; a quantity that does not respond says so."""
    pytest.importorskip("matplotlib")
    omega = np.linspace(1, 5, 30)
    answers = {"tip.position": np.column_stack([1 / omega, 0 * omega, 2j / omega]),
               "energy.strain": 0 * omega}
    figure = drawn(monkeypatch, lambda: frequency_pictures.save_response(
        "a.png", "push", omega, answers))
    one, other, phase = figure.axes
    assert [text.get_text() for text in one.get_legend().get_texts()] == ["tip.position.x",
                                                                          "tip.position.z"]
    assert one.get_title(loc="left") == "tip.position under 'push' of amplitude 1"
    assert other.texts[0].get_text() == "no response" and other.get_legend() is None
    assert [line.get_ydata()[0] for line in phase.lines] == [0.0, 90.0]


def test_units_of_a_model_stand_in_tables_and_pictures(monkeypatch):
    """Frequencies by the model's unit of time, quantities by their own."""
    pytest.importorskip("matplotlib")
    model = oscillator()
    model.units = "mm kg ms kN"
    response = frequency_response(equilibrium(model, 1), "push", "weight.position",
                                  np.linspace(1, 30, 20))
    text = repr(response)
    assert "30 rad/ms" in text and "at [1/ms]" in text and "weight.position.x [mm]" in text
    axes = drawn(monkeypatch, lambda: response.save_picture("a.png")).axes
    assert axes[0].get_ylabel() == "amplitude [mm]"
    assert axes[-1].get_xlabel() == "angular frequency [rad/ms]"
    spun, _ = rotor(False)
    spun.units = "mm kg ms kN"
    diagram = campbell(spun, [0.0, 3.0], (0, 0, 1), 3)
    assert all(word in repr(diagram) for word in ("to 3 rad/ms", "[1/ms] at 3 rad/ms"))
    axes = drawn(monkeypatch, lambda: diagram.save_picture("a.png")).axes
    assert axes[0].get_ylabel() == "angular frequency [rad/ms]"
    assert axes[1].get_ylabel() == "real part [1/ms]"


def test_pictures_and_what_a_diagram_refuses(tmp_path):
    pytest.importorskip("matplotlib")
    model, _ = rotor(False)
    diagram = campbell(model, [0.0, 3.0], (0, 0, 1), 3)
    response = frequency_response(equilibrium(oscillator(), 1), "push",
                                  ["weight.position", "energy.strain"], np.linspace(1, 30, 20))
    for one, name in ((diagram, "campbell.png"), (response, "response.svg")):
        assert one.save_picture(tmp_path / name).stat().st_size > 10_000
        with pytest.raises(InputError, match="must end in .png"):
            one.save_picture(tmp_path / "picture.txt")
    with pytest.raises(InputError, match="quantity of the response 'tip' is unknown: use 'weight"):
        response["tip"]
    for arguments, message in ((([1.0], (0, 0, 1)), "speeds must ascend, at least two of them"),
                               (([0.0, 1.0],), "Campbell diagram: no hinge or bearing"),
                               (([0.0, 1.0], (0, 0, 0)), "axis has no length"),
                               (([0.0, 1.0], (0, 0, 1), 9), "count is 9, but there are 3 modes")):
        with pytest.raises(InputError, match=message):
            campbell(model, *arguments)


def test_a_load_in_rotating_axes():
    """``(k - m W^2 - m w^2) x - 2 i m W w z x x = f``: a mass on springs that rotate with it."""
    model, turn = rotor(False)
    model.force("middle", turn @ (1.0, 0, 0), NONE, name="push")
    speed, omega = 3.0, np.array([0.0, 2.0, 30.0])
    spin = turn @ (0, 0, speed)
    found = frequency_response(equilibrium(model, 2, spin=spin), "push", [
        "middle.position", "middle.velocity", "middle.acceleration"], omega, spin)
    W = speed * np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 0]])
    for k, w in enumerate(omega):
        A = np.diag([150.0, 400.0, 250.0]) + MASS * (W @ W - w**2 * np.eye(3) + 2j * w * W)
        x = np.linalg.solve(A, [1.0, 0, 0])
        for name, value in (("position", x), ("velocity", 1j * w * x + W @ x),
                            ("acceleration", -w**2 * x + 2j * w * W @ x + W @ W @ x)):
            assert_allclose(found[f"middle.{name}"][k], turn @ value, rtol=1e-6,
                            atol=1e-7 * np.abs(value).max())
