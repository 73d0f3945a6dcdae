"""Rotors in bearings that stand: what turns, and in which axes the analyses are told."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rotor_models import AXIS, RPM, TURNED, about_shaft, disc, turbine, two_discs

from sebody import InputError, Model, simulate
from sebody.analysis import campbell, equilibrium, frequency_response, modes, state_space
from sebody.basics.errors import LimitWarning
from sebody.fem import Section, circle


def at_speed(model, speed, frame="auto", **named):
    """Modes about a rotation at a speed about AXIS."""
    return modes(equilibrium(model, 1, spin=speed * AXIS), speed * AXIS, frame, **named)


def nearest(omega, wanted):
    """Which of some frequencies are the wanted ones; each is found once."""
    own = [int(np.argmin(np.abs(omega - one))) for one in wanted]
    assert len(set(own)) == len(own) or len(set(np.round(wanted, 6))) < len(own)
    return own


@pytest.mark.parametrize("across", [1e4, 1.44e4])
def test_a_disc_in_a_bearing_does_not_know_its_speed(across):
    """``m y'' + c y' + k y = 0`` across the shaft at every speed, stable on both sides of critical.
    """
    speeds = np.linspace(10.0, 400.0, 20)
    found = campbell(disc((1e5, 1e4, across)), speeds, AXIS, count=7, steps=1)
    assert found.frame == "standing" and "axisymmetric" in found.reason
    for stiffness in (1e4, across):
        exact = np.sqrt(stiffness - 4.0)
        columns = [k for k in range(7) if abs(found.omega[0, k] - exact) < 1e-6 * exact]
        assert columns
        assert_allclose(found.omega[:, columns], exact, rtol=1e-10)
        assert_allclose(found.growth[:, columns], -2.0, atol=1e-8)
    assert "in standing axes (what turns is axisymmetric)" in repr(found).splitlines()[0]


def test_tilts_of_a_disc_have_gyroscopic_moments():
    """``J a'' + kt a -+ i Jp W a' = 0``: forward and backward whirls part."""
    for speed in (50.0, 900.0):
        found = at_speed(disc((1e5, 1e4, 1e4), 0.0), speed)
        ratio = 2.0 * speed / 2.0
        root = np.sqrt(ratio**2 + 1e3 / 1e-3)
        for exact in (root - ratio, root + ratio):
            assert np.abs(found.omega - exact).min() < 1e-9 * exact


# printed by ROSS, docs/examples/example_05_09_02.rst of petrobras/ross, at 0 and 4000 rpm
ANISOTROPIC = {0.0: (82.65303734, 86.65811435, 254.52047828, 274.31285391, 679.48903239,
                     716.78631221),
               4000.0: (82.32547398, 86.86369902, 239.64228361, 287.24958074, 583.48782916,
                        806.8872843)}


@pytest.mark.parametrize("order", [1, -1])
def test_two_discs_in_anisotropic_bearings(order):
    found = campbell(two_discs(np.diag([1e6, 0.8e6]), order=order),
                     RPM * np.array(list(ANISOTROPIC)), AXIS, count=12, steps=1)
    assert found.frame == "standing"
    for omega, exact in zip(found.omega, ANISOTROPIC.values(), strict=True):
        assert_allclose(omega[nearest(omega, exact)], exact, rtol=1e-9)


def test_axes_tell_the_same_motion():
    """Whirls of an axisymmetric rotor in isotropic bearings: turning axes, less the speed."""
    speed = 300.0
    standing, turning = (at_speed(two_discs(1e6 * np.eye(2), 2e3), speed, frame)
                         for frame in ("standing", "turning"))
    assert (standing.frame, turning.frame) == ("standing", "turning")
    whirls = standing.values[(standing.omega > 20.0) & (standing.omega < 800.0)
                             & (standing.growth < -1e-3)]
    assert len(whirls) > 4
    for value in whirls:
        from_it = [value + 1j * sign * speed for sign in (-1, 1)]
        assert min(np.abs(turning.values - one).min() for one in (
            *from_it, *np.conj(from_it))) < 1e-6 * abs(value)


def internally_damped(inner, outer):
    """A disc on a shaft that turns with it, with damping in the shaft and outside."""
    model = Model()
    hub, own, ground = (model.node(name, (0, 0, 0)) for name in ("hub", "d", "o"))
    model.fix(ground)
    model.fix(hub, "position")
    model.rigid_body("hub mass", hub, 0.1, about_shaft(1e-3, 1e-3))
    model.rigid_body("disc", own, 2.0, about_shaft(2e-3, 1e-3))
    model.bushing(hub, to=own, stiffness=5e3, damping=inner, turning_stiffness=1e3)
    model.bushing(ground, to=own, damping=outer)
    model.bushing(ground, to=hub, turning_stiffness=(0, 1e3, 1e3), rotation=TURNED, name="guide")
    return model


@pytest.mark.parametrize("frame", ["standing", "turning"])
def test_damping_in_the_shaft_drives_whirls_above_a_threshold(frame):
    """``m y'' + (ci + ce) y' + (k - i W ci) y = 0`` is on the edge at ``W = w (1 + ce / ci)``."""
    inner, outer, omega = 6.0, 3.0, 50.0
    edge = omega * (1.0 + outer / inner)
    for factor in (0.98, 1.0, 1.02):
        found = at_speed(internally_damped(inner, outer), factor * edge, frame)
        exact = np.roots([2.0, inner + outer, 5e3 - 1j * factor * edge * inner])
        exact = exact[np.argmax(exact.real)]
        shift = 0.0 if frame == "standing" else factor * edge
        assert np.sign(np.round(exact.real, 9)) == np.sign(factor - 1.0)
        wanted = exact - 1j * shift
        assert min(np.abs(found.values - one).min() for one in (wanted, wanted.conjugate())) < 1e-8


def in_housing(flexible):
    """A disc in a bearing in a housing on unequal springs, or at the end of an unequal beam."""
    model = disc((1e5, 2e4, 2e4), 0.0)
    model.nodes["o"].position.fixed = model.nodes["o"].rotation.fixed = False
    if flexible:
        root = model.node("root", 0.8 * TURNED[:, 2])
        model.beam("post", (root, "o"), Section(1e-4, 1e-9, 3e-9, 2e-9, 7e10, 0.3, 2700.0), 4, 1, 3)
        model.fix(root)
    else:
        ground = model.node("ground", (0, 0, 0))
        model.fix(ground)
        model.rigid_body("housing", "o", 3.0, np.diag([0.1, 0.2, 0.3]))
        model.bushing(ground, to="o", stiffness=(3e4, 5e4, 9e4), damping=7.0,
                      turning_stiffness=(700.0, 600.0, 500.0), rotation=TURNED, name="feet")
    return model


def test_a_housing_on_springs_stands():
    """Across the shaft, disc and housing are two masses on two springs, at every speed."""
    found = at_speed(in_housing(False), 400.0)
    assert found.frame == "standing"
    for feet in (5e4, 9e4):
        M, C = np.diag([1.0, 3.0]), np.diag([0.0, 7.0])
        K = np.array([[2e4, -2e4], [-2e4, 2e4 + feet]])
        A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K),
                                                      -np.linalg.solve(M, C)]])
        for value in np.linalg.eigvals(A):
            if value.imag > 0.0:
                assert np.abs(found.values - value).min() < 1e-8 * abs(value)


def test_a_flexible_housing_stands():
    """Frequencies of motion without tilts of the disc are those at rest."""
    model = in_housing(True)
    still = modes(equilibrium(model, 1))
    found = at_speed(model, 300.0)
    assert found.frame == "standing"
    tilts = np.linalg.norm(still.shape("d.rotation"), axis=0)
    plain = (tilts < 1e-6) & (still.omega > 1.0)
    assert plain.sum() >= 1
    for omega in still.omega[plain]:
        assert np.abs(found.omega - omega).min() < 1e-8 * omega


def test_a_shaft_in_one_body_with_modes_is_axisymmetric():
    """How internal modes turn follows from the body: one body against six of one element."""
    omega = []
    for bodies, modes_of in ((1, 12), (12, 0)):
        model = Model()
        for name, at in (("a", 0.0), ("b", 1.0)):
            model.node(name, at * AXIS)
        model.beam("shaft", ("a", "b"), circle(0.02, 2e11, 0.3, 7800.0), 12, bodies, modes_of)
        for name, stiffness in (("a", (2e6, 1e6, 3e6)), ("b", (0.0, 2e6, 1e6))):
            ground = model.node(f"ground {name}", model.nodes[name].point)
            model.fix(ground)
            model.bushing(ground, to=name, stiffness=stiffness, rotation=TURNED)
        found = at_speed(model, 900.0)
        assert found.frame == "standing"
        omega.append(found.omega[found.omega > 50.0][:5])
    assert_allclose(omega[0], omega[1], rtol=2e-3)


@pytest.mark.parametrize("elastic", [True, False])
def test_gears_turn_the_second_shaft(elastic):
    """A disc geared to the first turns at its own speed: its tilts have that gyroscopic moment."""
    model = Model()
    first, second = model.node("first", (0, 0, 0)), model.node("second", 0.4 * TURNED[:, 1])
    frame = model.node("frame", 0.4 * TURNED[:, 1])
    model.fix(frame)
    wheel = model.node("wheel", 0.4 * TURNED[:, 1])
    joints = [model.revolute(node, AXIS) for node in (first, second)]
    for name in ("first", "second"):
        model.rigid_body(name, name, 1.0, about_shaft(2e-3, 2e-3))
    model.rigid_body("disc", wheel, 1.0, about_shaft(2e-3, 1e-3))
    model.bushing(wheel, to=second, stiffness=1e6, turning_stiffness=1e3)
    model.bushing(frame, to=wheel, turning_stiffness=(0.0, 500.0, 700.0), rotation=TURNED)
    ratio, speed = -2.5, 200.0
    if elastic:
        model.gear(*joints, ratio, stiffness=1e5)
    else:
        model.couple(*joints, ratio)
    found = at_speed(model, speed)
    assert found.frame == "standing"
    M, G = 1e-3 * np.eye(2), 2e-3 * speed / ratio * np.array([[0.0, 1.0], [-1.0, 0.0]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)],
                  [-np.diag([1500.0, 1700.0]) / 1e-3, -np.linalg.solve(M, G)]])
    for value in np.linalg.eigvals(A):
        assert np.abs(found.omega - abs(value.imag)).min() < 1e-6 * abs(value)


def test_what_is_not_axisymmetric_and_not_isotropic_is_refused():
    model = disc((1e5, 1e4, 1.44e4))
    model.rigid_body("lug", "d", 0.1, TURNED @ np.diag([1e-3, 5e-4, 8e-4]) @ TURNED.T)
    with pytest.raises(InputError, match="in turning axes they change by .* since what stands is "
                                         "not isotropic about the axis"):
        at_speed(model, 100.0, "turning")
    with pytest.raises(InputError, match="since what turns is not axisymmetric"):
        at_speed(model, 100.0, "standing")
    isotropic = disc((1e5, 1e4, 1e4))
    isotropic.rigid_body("lug", "d", 0.1, TURNED @ np.diag([1e-3, 5e-4, 8e-4]) @ TURNED.T)
    found = at_speed(isotropic, 100.0)
    assert found.frame == "turning" and "isotropic" in found.reason


def test_what_turns_as_a_whole_is_told_in_turning_axes():
    model = disc((1e5, 1e4, 1e4))
    model.bushing("o", to="d", turning_stiffness=10.0, name="held")
    found = at_speed(model, 100.0)
    assert found.frame == "turning" and "nothing turns by itself" in found.reason
    with pytest.raises(InputError, match="frame='standing': nothing turns by itself"):
        at_speed(model, 100.0, "standing")
    with pytest.raises(InputError, match="hub 'o' does not turn freely"):
        at_speed(disc((1e5, 1e4, 1e4)), 100.0, hub="o")
    with pytest.raises(InputError, match="frame='turning' is of a steady rotation: give spin="):
        modes(equilibrium(model, 1), frame="turning")


def test_a_load_that_stands_moves_a_spinning_disc_as_one_at_rest():
    """``F / (k - m w^2 + i c w)`` along the load's axis, none across; state spaces likewise."""
    model = disc((1e5, 1e4, 1.44e4))
    model.force("d", TURNED[:, 1], 0.0, name="push")
    speed, omega = 170.0 * AXIS, np.array([20.0, 99.0, 101.0, 300.0])
    state = equilibrium(model, 1, spin=speed)
    answer = frequency_response(state, "push", "d.position", omega, speed)["d.position"] @ TURNED
    exact = 1.0 / (1e4 - omega**2 + 4j * omega)
    assert_allclose(answer[:, 1], exact, rtol=1e-9)
    assert np.abs(answer[:, [0, 2]]).max() < 1e-9 * np.abs(exact).max()
    system = state_space(state, "push", "d.position", speed)
    assert_allclose(system.response(omega)[:, :, 0] @ TURNED[:, 1], exact, rtol=1e-8)


def test_multipliers_of_a_revolution_tell_what_standing_axes_do():
    """The same exponents from the product of steps, with the frequencies seen from the ground."""
    model = disc((1e5, 1e4, 1.44e4))
    standing, periodic = (at_speed(model, 170.0, frame) for frame in ("standing", "floquet"))
    assert periodic.frame == "floquet"
    own = [int(np.argmin(np.abs(periodic.values - one))) for one in standing.values[2:]]
    assert len(set(own)) == len(own)
    assert np.all(np.abs(periodic.values[own] - standing.values[2:])
                  <= 2.0 * periodic.rounding[own] + 1e-9 * np.abs(standing.values[2:]))
    assert periodic.rounding[own][:3].max() < 1e-6
    with pytest.raises(InputError, match="no axes make its matrices constant"):
        frequency_response(equilibrium(with_load(model), 1, spin=170.0 * AXIS), "push",
                           "d.position", [1.0], 170.0 * AXIS, "floquet")


def with_load(model):
    model.force("d", TURNED[:, 1], 0.0, name="push")
    return model


@pytest.mark.parametrize("blades, order", [(3, 1), (4, -1)])
def test_multi_blade_coordinates_of_equal_blades(blades, order):
    """Averages after the transformation against multipliers of a revolution, of another kind."""
    model = turbine(blades, order=order)
    state = equilibrium(model, 2, spin=6.0 * AXIS)
    averaged = modes(state, 6.0 * AXIS, hub="hub")
    periodic = modes(state, 6.0 * AXIS, "floquet", "hub")
    assert averaged.frame == "multiblade" and "alike" in averaged.reason
    low = averaged.values[(averaged.omega > 1.0) & (averaged.omega < 120.0)]
    assert len(low) >= 8
    for value in low:
        assert np.abs(periodic.values - value).min() < 1e-6 * abs(value)


def test_a_heavier_blade_is_periodic():
    model = turbine(heavier=0.02)
    state = equilibrium(model, 2, spin=6.0 * AXIS)
    found = modes(state, 6.0 * AXIS, hub="hub")
    assert found.frame == "floquet" and "not axisymmetric" in found.reason
    # with blades alike but for rounding the frequencies differ: collective and cyclic ones mix
    alike = modes(equilibrium(turbine(), 2, spin=6.0 * AXIS), 6.0 * AXIS, hub="hub")
    low = slice(2, 8)
    shift = np.abs(found.omega[low] / alike.omega[low] - 1.0)
    assert 1e-5 < shift.max() < 2e-3


def test_blades_that_are_none_are_refused():
    state = equilibrium(turbine(2), 2, spin=6.0 * AXIS)
    with pytest.raises(InputError, match="beyond hub 'hub' there are no three or more parts"):
        modes(state, 6.0 * AXIS, "multiblade", "hub")
    with pytest.raises(InputError, match="frame='multiblade' needs hub="):
        modes(state, 6.0 * AXIS, "multiblade")
    assert modes(state, 6.0 * AXIS, hub="hub").frame == "floquet"


def test_a_load_on_the_nacelle_moves_it_in_any_axes():
    """The response of a hub with blades whose axes are multi-blade ones, and its own resonance."""
    model = turbine()
    model.force("hub", TURNED[:, 1], 0.0, name="push")
    state = equilibrium(model, 2, spin=6.0 * AXIS)
    found = modes(state, 6.0 * AXIS, hub="hub")
    damped = found.values[(found.growth < -0.3) & (found.omega < 60.0)][0]
    omega = damped.imag + np.array([-3.0, 0.0, 3.0])
    answer = frequency_response(state, "push", "hub.position", omega, 6.0 * AXIS, hub="hub")
    size = np.abs(answer["hub.position"] @ TURNED[:, 1])
    assert size[1] > 3.0 * max(size[0], size[2])


@pytest.mark.parametrize("tilts", [False, True])
def test_cross_coupled_bearings_against_their_own_matrices(tilts):
    """Every entry of stiffness and damping, not symmetric, of a disc whose tilts are gyroscopic."""
    random = np.random.default_rng(5)
    size, speed = (4 if tilts else 2), 80.0
    scale = np.array([100.0, 100.0, 40.0, 40.0])[:size]
    K = np.outer(scale, scale) * (np.eye(size) + 0.2 * random.normal(size=(size, size)))
    C = np.outer(scale, scale) * 1e-4 * (3.0 * np.eye(size) + random.normal(size=(size, size)))
    model = Model()
    model.node("o", (0, 0, 0))
    model.fix("o")
    model.node("d", (0, 0, 0))
    model.rigid_body("disc", "d", 1.0, about_shaft(0.2, 0.1))
    across = TURNED[:, [1, 2, 0]]
    model.bushing("o", to="d", stiffness=K, damping=C, rotation=across, name="film")
    model.bushing("o", to="d", stiffness=(1e4, 0, 0), rotation=TURNED, name="thrust")
    if not tilts:
        model.bushing("o", to="d", turning_stiffness=(0, 1e3, 1e3), rotation=TURNED, name="tilts")
    M = np.diag([1.0, 1.0, 0.1, 0.1][:size])
    G = np.zeros((size, size))
    if tilts:
        G[2:, 2:] = 0.2 * speed * np.array([[0.0, 1.0], [-1.0, 0.0]])
    A = np.block([[np.zeros((size, size)), np.eye(size)],
                  [-np.linalg.solve(M, K), -np.linalg.solve(M, C + G)]])
    found = at_speed(model, speed)
    assert found.frame == "standing"
    for value in np.linalg.eigvals(A):
        if value.imag > 0.0:
            assert np.abs(found.values - value).min() < 1e-8 * abs(value)
    one = next(load for load in model.loads if load.name == "film")
    assert one.kind == "bearing"


def test_bearings_by_matrices_are_checked():
    for wrong, said in (
            ({"stiffness": np.eye(3)}, "stiffness is .*: give a matrix of finite numbers, 2 x 2"),
            ({"damping": -np.eye(2)}, "whose symmetric part is not negative"),
            ({"stiffness": np.eye(4), "turning_stiffness": 1.0}, "leave out turning_stiffness"),
            ({"axis": (0, 0, 0)}, "axis has no length: give the shaft's direction"),
            ({"axis": (0, 0, 1), "rotation": np.eye(3)}, "give axis= or rotation=, not both")):
        with pytest.raises(InputError, match=said):
            _bushing(**wrong)


def _bushing(**given):
    model = Model()
    model.node("a", (0, 0, 0))
    model.bushing("a", **given)


def test_a_heavier_blade_against_a_run():
    """Frequencies from the ground, and their neighbours two revolutions away, in a spectrum."""
    speed, step, count = 6.0, 2e-3, 28000
    found = at_speed(turbine(heavier=2.0), speed, hub="hub")
    assert found.frame == "floquet"
    model = turbine(heavier=2.0)
    model.rigid_velocity((0, 0, 0), speed * AXIS)
    model.force("hub", TURNED @ (0.0, 1.0, 0.3), [(0, 0), (0.02, 3e4), (0.04, 0)], name="push")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)   # of the blow, which ends between steps
        result = simulate(model, step, 60.0)
    swing = (result["hub.position"] @ TURNED[:, 1])[-count:]
    spectrum = np.abs(np.fft.rfft((swing - swing.mean()) * np.hanning(count), 8 * count))
    omega = 2 * np.pi * np.fft.rfftfreq(8 * count, step)
    width = 2 * np.pi / (count * step)      # of a bin
    low = found.omega[(found.omega > 7.0) & (found.omega < 60.0)]
    first, second, last = low[0], low[1], low[-1]
    for expected in (first, second, last, first + 2 * speed, second - 2 * speed):
        near = np.abs(omega - expected) < 4 * width
        near &= np.abs(omega - speed) > 4 * width   # of unbalance
        peak = omega[near][np.argmax(spectrum[near])]
        assert abs(peak - expected) < width


def test_an_axis_away_from_the_origin_goes_through_its_hub():
    """Equilibrium and modes of a rotor that stands elsewhere are those at the origin."""
    shift, speed, found = TURNED @ (0.3, 2.0, -1.0), 170.0, []
    for place in (np.zeros(3), shift):
        model = Model()
        for name in "od":
            model.node(name, place)
        model.fix("o")
        model.rigid_body("disc", "d", 1.0, about_shaft(2e-3, 1e-3))
        model.bushing("o", to="d", stiffness=(1e5, 1e4, 1.44e4), damping=4.0, rotation=TURNED,
                      turning_stiffness=(0.0, 1e3, 1e3))
        state = equilibrium(model, 1, spin=speed * AXIS, hub="d")
        assert_allclose(state["d.position"][-1], place, atol=1e-9)
        assert_allclose(state["d.velocity"][-1], 0.0, atol=1e-6)
        found.append(modes(state, speed * AXIS, hub="d").values)
    assert_allclose(found[0], found[1], rtol=1e-7, atol=1e-4)
    with pytest.raises(InputError, match="hub 'o' does not turn freely"):
        equilibrium(model, 1, spin=speed * AXIS, hub="o")
