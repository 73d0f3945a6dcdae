"""Whirls, critical speeds and steady responses to unbalance."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rotor_models import AXIS, TURNED, about_shaft, disc, two_discs

from sebody import InputError, Model, simulate
from sebody.analysis import campbell, critical_speeds, synchronous_response
from sebody.model.shafts import shaft_axes
from sebody.small_motion.rotation.whirls import Ellipses

ACROSS = shaft_axes(AXIS)[:, :2]


def tilting(polar=2e-3, stiffness=(1e5, 1e4, 1.44e4), damping=(0.0, 4.0, 4.0)):
    """A disc across and about whose shaft everything is known."""
    model = Model()
    for name in "od":
        model.node(name, (0, 0, 0))
    model.fix("o")
    model.rigid_body("disc", "d", 1.0, about_shaft(polar, 1e-3))
    model.bushing("o", to="d", stiffness=stiffness, damping=damping, rotation=TURNED,
                  turning_stiffness=(0.0, 1e3, 1e3), name="bearing")
    return model


def test_ellipses_are_what_points_run_through():
    """Half axes and sense by the points of a period, for general amplitudes."""
    random = np.random.default_rng(2)
    motion = random.normal(size=(20, 3)) + 1j * random.normal(size=(20, 3))
    found = Ellipses.of(motion, ACROSS)
    t = np.linspace(0.0, 2 * np.pi, 20001)
    for one, major, minor, inclination, phase, whirl in zip(motion, *found, found.whirl,
                                                           strict=True):
        places = np.real(np.exp(1j * t)[:, None] * (one @ ACROSS))
        distance = np.hypot(*places.T)
        assert major == pytest.approx(distance.max(), rel=1e-6)
        assert abs(minor) == pytest.approx(distance.min(), rel=1e-4, abs=1e-4)
        area = np.sum(places[:-1, 0] * np.diff(places[:, 1])
                      - places[:-1, 1] * np.diff(places[:, 0])) / 2
        assert area == pytest.approx(np.pi * major * minor, rel=1e-3)
        assert whirl == ("forward" if area > 0 else "backward")
        end = np.real(np.exp(1j * phase) * (one @ ACROSS))
        assert_allclose(end, major * np.array([np.cos(inclination), np.sin(inclination)])
                        * np.sign(end @ [np.cos(inclination), np.sin(inclination)]), atol=1e-9)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_whirls_of_a_disc_have_names(sense):
    """Tilts: ``w = p W / 2 +- sqrt((p W / 2)^2 + kt / J)``, the higher one forward; others plane.
    """
    speed = 300.0
    found = campbell(tilting(), [0.0, speed], sense * AXIS, 7, 1)
    exact = np.sqrt(speed**2 + 1e6) + np.array([-speed, speed])
    for omega, name in zip(exact, ("backward", "forward"), strict=True):
        k = int(np.argmin(np.abs(found.omega[1] - omega)))
        assert found.omega[1, k] == pytest.approx(omega, rel=1e-9)
        assert found.whirl[1, k] == name
    plain = np.abs(found.omega[1][:, None] - np.sqrt([1e4 - 4, 1.44e4 - 4, 1e5])).min(axis=1) < 1e-6
    assert plain.sum() == 3 and set(found.whirl[1, plain]) == {"none"}
    assert "backward" in repr(found)


def test_both_whirls_between_unequal_bearings_are_mixed():
    """Discs far apart in bearings of opposite anisotropy run in opposite senses at some speed."""
    model = two_discs(np.diag([1e6, 0.3e6]))
    names = campbell(model, np.linspace(20.0, 470.0, 8), count=12, steps=1).whirl
    assert {"forward", "backward", "mixed"} <= set(names.ravel())


def test_critical_speeds_of_a_disc():
    """``w = n W``: across ``w / n``; of tilts ``sqrt(kt / (J n (n - p)))`` forward, n + p backward.

    A disc with p = Jp / Jt = 1.6 has no forward critical speed of order one.
    """
    found = critical_speeds(tilting(1.6e-3), orders=(1.0, 3.0), count=6)
    exact = [(np.sqrt(k - 4.0) / n, n, "none") for k in (1e4, 1.44e4) for n in (1.0, 3.0)]
    exact += [(np.sqrt(1e5) / n, n, "none") for n in (1.0, 3.0)]
    exact += [(np.sqrt(1e6 / (n * (n + 1.6))), n, "backward") for n in (1.0, 3.0)]
    exact += [(np.sqrt(1e6 / 4.2), 3.0, "forward")]
    assert len(found) == len(exact)
    for (speed, order, name), *row in zip(sorted(exact), found.speeds, found.orders, found.whirl,
                                          strict=True):
        assert row[0] == pytest.approx(speed, rel=1e-9)
        assert row[1] == order and row[2] == name
    assert_allclose(found.omega, found.orders * found.speeds, rtol=1e-9)
    assert_allclose(found.damping[:1], 2.0 / np.sqrt(1e4), rtol=1e-9)
    shown = repr(found)
    assert "backward" in shown and f"{len(exact)} critical speeds" in shown


def test_a_diagram_has_its_crossings():
    """Interpolated ones are near exact ones, which do not depend on unbalances."""
    model = two_discs(np.diag([1e6, 0.8e6]), 300.0)
    model.unbalance("n2", 1e-3)
    exact = critical_speeds(model, fastest=470.0, count=8)
    diagram = campbell(model, np.linspace(0.0, 470.0, 12), count=10, steps=1)
    near = diagram.crossings()
    assert len(exact) == len(near) >= 4
    assert_allclose(near.speeds, exact.speeds, rtol=2e-3)
    assert list(near.whirl) == list(exact.whirl)
    with pytest.raises(InputError, match="orders .*: give multiples of the speed, all positive"):
        diagram.crossings((1.0, -2.0))
    lug = tilting(stiffness=(1e5, 1e4, 1e4))
    lug.rigid_body("lug", "d", 0.1, TURNED @ np.diag([1e-3, 5e-4, 8e-4]) @ TURNED.T)
    with pytest.raises(InputError, match="critical speeds are where a frequency in them is zero"):
        critical_speeds(lug)


def exact_response(model, speeds):
    """``m r W^2 / (k - m W^2 + i c W)`` across, whose second direction is a quarter turn behind."""
    first = model.rigid_bodies["unbalance at d"].vector("mc") @ TURNED
    amplitude = speeds[:, None]**2 * (first - 1j * np.cross((1.0, 0.0, 0.0), first))
    k = np.array([1e5, 1e4, 1.44e4])
    return amplitude / (k - speeds[:, None]**2 + 1j * speeds[:, None] * np.array([0, 4.0, 4.0]))


def test_a_disc_out_of_balance_in_unequal_bearings():
    """Forward below and above both critical speeds, backward between them; any quantity."""
    model = tilting()
    model.unbalance("d", 2e-4, 0.7)
    speeds = np.array([40.0, 80.0, 104.0, 110.0, 116.0, 140.0, 500.0])
    found = synchronous_response(model, speeds, ["d.position", "d.velocity", "bearing.force"])
    exact = exact_response(model, speeds)
    assert_allclose(found["d.position"] @ TURNED, exact, atol=1e-12 * np.abs(exact).max())
    assert_allclose(found["d.velocity"] @ TURNED, 1j * speeds[:, None] * exact, rtol=1e-9,
                    atol=1e-12)
    size = np.array([1e5, 1e4, 1.44e4]) + 1j * speeds[:, None] * np.array([0.0, 4.0, 4.0])
    assert_allclose(np.abs(found["bearing.force"] @ TURNED), np.abs(size * exact), rtol=1e-8,
                    atol=1e-9)
    assert list(found.orbit("d.position").whirl) == ["forward"] * 2 + ["backward"] * 3 + [
        "forward"] * 2
    assert "d.position" in repr(found)


def test_a_steady_orbit_is_what_a_run_comes_to():
    """Two unbalances of a flexible shaft, with the same phase in time, driven at 300 rad/s."""
    speed = 300.0
    model = two_discs(np.diag([1e6, 0.8e6]), 4e3, elements=3)
    model.unbalance("n1", 1e-4, 0.3)
    model.unbalance("n2", 2e-4, -2.0)
    found = synchronous_response(model, [speed])["n1.position"][0]
    model.drive_angle("n0", (lambda t: speed * t, lambda t: speed, lambda t: 0.0), AXIS)
    model.rigid_velocity((0, 0, 0), speed * AXIS)
    h = 2.0 * np.pi / speed / 60
    result = simulate(model, h, 60 * 40 * h)
    t, y = result.t[-60:], (result["n1.position"] - model.nodes["n1"].point)[-60:]
    amplitude = 2.0 * np.mean(np.exp(-1j * speed * t)[:, None] * y, axis=0)
    # damping has left e^-4 of vibrations; the step is worth (w h)^2 / 12 of the period
    assert np.linalg.norm(amplitude - found) < 0.02 * np.linalg.norm(found)


def test_a_rotor_that_is_not_round_in_turning_axes():
    """Its static deflection, that runs round: ``kx`` and ``ky`` of a shaft that is not round."""
    model, own = tilting(stiffness=(1e5, 0.0, 0.0), damping=0.0), (7e3, 9e3)
    model.node("hub", (0, 0, 0))
    model.fix("hub", "position")
    model.rigid_body("hub", "hub", 0.1, about_shaft(1e-3, 1e-3))
    model.bushing("o", to="hub", turning_stiffness=(0.0, 1e3, 1e3), rotation=TURNED, name="guide")
    model.bushing("hub", to="d", stiffness=(0.0, *own), rotation=TURNED, name="shaft",
                  turning_stiffness=(100.0, 0.0, 0.0))
    made = model.unbalance("d", 3e-4, 1.1, AXIS)
    speeds = np.array([30.0, 120.0])
    found = synchronous_response(model, speeds)
    assert found.frame == "turning"
    still = made.vector("mc") @ TURNED * speeds[:, None]**2
    still[:, 1:] /= np.array(own) - speeds[:, None]**2
    still[:, 0] = 0.0
    exact = still - 1j * np.cross((1.0, 0.0, 0.0), still)
    assert_allclose(found["d.position"] @ TURNED, exact, rtol=1e-8, atol=1e-15)
    assert set(found.orbit("d.position").whirl) == {"forward"}


def test_a_wheel_in_a_plane():
    model = Model(planar=True)
    for name in "od":
        model.node(name, (0.0, 0.0))
    model.fix("o")
    model.rigid_body("wheel", "d", 2.0, 0.1)
    model.bushing("o", to="d", stiffness=(2e4, 3e4), damping=8.0)
    model.unbalance("d", 1e-3, 0.4)
    speeds = np.array([50.0, 110.0, 200.0])
    push = 1e-3 * speeds[:, None]**2 * np.exp(0.4j) * np.array([1.0, -1j])
    exact = push / (np.array([2e4, 3e4]) - 2.0 * speeds[:, None]**2 + 8j * speeds[:, None])
    assert_allclose(synchronous_response(model, speeds)["d.position"], exact, rtol=1e-9)
    assert_allclose(critical_speeds(model).speeds, np.sqrt([1e4 - 4.0, 1.5e4 - 4.0]), rtol=1e-9)


def test_what_synchronous_responses_refuse(tmp_path):
    model = tilting()
    with pytest.raises(InputError, match="the model has no unbalance: add one by model.unbalance"):
        synchronous_response(model, [10.0])
    model.unbalance("o", 1e-3)
    with pytest.raises(InputError, match="'unbalance at o' does not turn: name as hub="):
        synchronous_response(model, [10.0])
    model = disc((1e5, 1e4, 1e4))
    model.unbalance("d", 1e-3)
    for speeds, names, said in ((0.0, None, "speeds .*: give at least one, all positive"),
                                (10.0, "energy.kinetic", "'energy.kinetic' is no vector"),
                                (10.0, "d.position.y", "'d.position.y' is no vector"),
                                (10.0, "x.position", "'x.position' is unknown")):
        with pytest.raises(InputError, match=said):
            synchronous_response(model, [speeds], names)
    with pytest.raises(InputError, match="needs standing or turning axes .* floquet"):
        synchronous_response(model, [10.0], frame="floquet")
    pytest.importorskip("matplotlib")
    found = synchronous_response(model, np.linspace(10.0, 200.0, 12))
    for made in (found.save_picture(tmp_path / "a.png"), found.save_orbits(tmp_path / "b.png", 90)):
        assert made.stat().st_size > 10_000
