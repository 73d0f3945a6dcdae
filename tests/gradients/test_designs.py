"""Bodies that are functions of numbers: sections of beams against runs of models built anew."""

import differentiated as scenes
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.analysis import Design, final, gradient, sections
from sebody.fem import rectangle

EXACT = generalized_alpha(tolerance=1e-13)
MATERIAL = 2e9, 0.3, 1200.0


def rod(height, width=0.02, bodies=1, modes=2):
    """A beam on a turned hinge under gravity and a torque."""
    m = Model()
    m.gravity(-9.81 * scenes.Y)
    a, b = m.node("a", scenes.place(0, 0, 0)), m.node("b", scenes.place(1, 0, 0))
    m.beam("rod", (a, b), rectangle(height, width, *MATERIAL), 4, bodies, modes)
    m.revolute(a, axis=scenes.Z)
    m.torque(a, 3 * scenes.Z, [(0, 0), (0.1, 1)], name="torque")
    return m


@pytest.mark.parametrize("bodies", [1, 2])
def test_two_numbers_of_a_section(bodies):
    """Against differences of runs of models that are built with other sections."""
    m = rod(0.03, bodies=bodies)
    section = sections(m, "rod", [0.03, 0.02], lambda x: rectangle(*x, *MATERIAL),
                       held_modes=False)
    found = gradient(m, 0.005, 0.1, {"b": final("b.position")}, [section, "gravity.y"],
                     scheme=EXACT)
    assert found.columns == ("rod.section[0]", "rod.section[1]", "gravity.y")
    step = 1e-4
    for k in range(2):
        ends = np.array([simulate(rod(*(np.array([0.03, 0.02]) + at * step * np.eye(2)[k]), bodies),
                                  0.005, 0.1, scheme=EXACT)["b.position"][-1]
                         for at in scenes.STEPS])
        expected = scenes.WEIGHTS @ ends / step
        assert np.abs(found.matrix[:, k] - expected).max() < 1e-6 * np.abs(expected).max()


def test_equal_frequencies_are_refused():
    """Of a square section modes of both planes change places: differences would be nonsense."""
    m = rod(0.02)
    section = sections(m, "rod", 0.02, lambda x: rectangle(float(x), 0.02, *MATERIAL),
                       held_modes=False)
    with pytest.raises(InputError, match=(
            r"rod.section: .* not smooth.*frequencies .* and .* of body 'rod'.* are equal")):
        gradient(m, 0.005, 0.05, {"b": final("b.position")}, [section])


def test_a_design_that_jumps_is_refused_without_a_word_of_frequencies():
    """Of a body without internal modes, and of one whose frequencies differ."""
    def jumps(x):
        return rectangle(0.03 if x < 0.03 else 0.04, 0.02, *MATERIAL)
    for modes in (0, 1):
        m = rod(0.03, modes=modes)
        section = sections(m, "rod", 0.03, jumps, held_modes=False)
        with pytest.raises(InputError, match="not smooth.*: differences of forces") as raised:
            gradient(m, 0.005, 0.05, {"b": final("b.position")}, [section])
        assert "are equal" not in str(raised.value)
        assert ("modes of the bodies" if modes else "begins or ends") in str(raised.value)


def turned_spin():
    """A body that spins about one of its principal axes without any force."""
    m = Model()
    node = m.node("a", (1.0, 2.0, 3.0))
    turn = Rotation.from_rotvec([0.3, -0.4, 0.5]).as_matrix()
    m.rigid_body("body", node, 1.3, turn @ np.diag([0.1, 0.2, 0.3]) @ turn.T)
    m.initial_velocity(node, (0.1, 0.2, 0.3), angular=turn @ [0.0, 0.0, 3.0])
    return m


def pendulum(planar):
    """One that falls."""
    m = Model(planar=planar)
    m.gravity((0.0, -9.81) if planar else (0.0, -9.81, 0.0))
    a = m.node("a", (1.0, 2.0) if planar else (1.0, 2.0, 3.0))
    m.rigid_body("body", a, 1.3, 0.1 if planar else np.diag([0.1, 0.2, 0.3]),
                 centre=(1.5, 2.1) if planar else (1.5, 2.1, 3.0))
    if planar:
        m.fix(a, "position")
    else:
        m.revolute(a, (0.0, 0.0, 1.0))
    return m


@pytest.mark.parametrize("build", [lambda: pendulum(True), lambda: pendulum(False), turned_spin],
                         ids=["planar", "on a hinge", "spin"])
@pytest.mark.parametrize("tolerance", [1e-8, 1e-14])
def test_what_the_mass_of_a_rigid_body_does_not_change(build, tolerance):
    """The mass of a pendulum, whose residuals by it are nothing but rounding."""
    found = gradient(build(), 0.001, 0.1, {"turn": final("a.rotation")}, ["body.mass"],
                     scheme=generalized_alpha(0.9, tolerance=tolerance))
    assert np.abs(found.matrix).max() < 1e-10


@pytest.mark.parametrize("height, bodies", [(0.02, 1), (0.03, 2)], ids=["square", "two bodies"])
def test_held_modes(height, bodies):
    """Against differences of runs with the same held modes; near the change by modes made anew."""
    m = rod(height, bodies=bodies)
    design = sections(m, "rod", height, lambda x: rectangle(float(x), 0.02, *MATERIAL))
    found = gradient(m, 0.005, 0.1, {"b": final("b.position")}, [design], scheme=EXACT).matrix[:, 0]
    of, step, ends = design.handle(m), 1e-4, {True: [], False: []}
    for at in scenes.STEPS:
        of.set(np.array(height + at * step))
        ends[True].append(simulate(m, 0.005, 0.1, scheme=EXACT)["b.position"][-1])
        of.reset()
        ends[False].append(simulate(rod(height + at * step, bodies=bodies), 0.005, 0.1,
                                    scheme=EXACT)["b.position"][-1])
    held, anew = (scenes.WEIGHTS @ np.array(ends[key]) / step for key in (True, False))
    assert np.abs(found - held).max() < 1e-6 * np.abs(held).max()
    assert np.abs(found - anew).max() < 1e-2 * np.abs(anew).max() or height == 0.02


def test_wrong_designs():
    m = rod(0.03)
    with pytest.raises(InputError, match="no beam 'bar'.*'rod'"):
        sections(m, "bar", 0.03, lambda x: rectangle(x, 0.02, *MATERIAL))
    with pytest.raises(InputError, match="sections: section is Section.*: give a function of the "
                                         "numbers, such as lambda x: rectangle"):
        sections(m, "rod", 0.03, rectangle(0.03, 0.02, *MATERIAL))
    with pytest.raises(InputError, match="no superelement 'bar'.*rod"):
        gradient(m, 0.005, 0.05, {"b": final("b.position")},
                 [Design("d", [1.0], ["bar"], lambda x: [m.bodies["rod"].reduced])])
    with pytest.raises(InputError, match="ReducedBody"):
        gradient(m, 0.005, 0.05, {"b": final("b.position")},
                 [Design("d", [1.0], ["rod"], lambda x: [3.0])])
    with pytest.raises(InputError, match="'d': its function made 0 bodies for 1 superelements"):
        gradient(m, 0.005, 0.05, {"b": final("b.position")},
                 [Design("d", [1.0], ["rod"], lambda x: [])])
    with pytest.raises(InputError, match="make of 'd' is None: give a function"):
        gradient(m, 0.005, 0.05, {"b": final("b.position")}, [Design("d", [1.0], ["rod"], None)])
