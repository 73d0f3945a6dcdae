"""Runs that start from a state of another model: dropped payloads, ropes that become taut."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Tolerance, generalized_alpha, simulate
from sebody.control import state_feedback
from sebody.fem import Section, planar_beam, straight_beam
from sebody.reduction import craig_bampton
from sebody.results.result import Result

TURN = Rotation.from_rotvec((0.4, -0.7, 1.1))
AXIS, ACROSS, DOWN = (TURN.apply(e) for e in ((0, 0, 1), (1, 0, 0), (0, -9.81, 0)))
FOOT, WAY, H, DROP, END = np.array([3.0, -1.0, 0.5]), np.array([0.8, 0.6]), 2e-3, 0.1, 0.2
BEAM = Section(area=1e-4, inertia_y=8e-10, inertia_z=6e-10, torsion=1.4e-9, youngs_modulus=7e10,
               poisson_ratio=0.3, density=2.7e3)
SPACES = pytest.mark.parametrize("planar", [False, True], ids=["space", "plane"])
HOW = pytest.mark.parametrize("how", [
    {}, {"scheme": generalized_alpha(index=2)}, {"tolerance": Tolerance(1e-6)}],
    ids=["3", "2", "variable"])


@cache
def arm(planar):
    """A reduced beam from the foot."""
    fe = (planar_beam(FOOT[:2], FOOT[:2] + WAY, BEAM, 4) if planar else
          straight_beam(FOOT, FOOT + ACROSS, BEAM, 4))
    return craig_bampton(fe, [(0, "full"), (4, "full")], modes=3)


def crane(planar, carries, turned=False, extra=False):
    """A flexible arm that swings, with a payload at its tip, a controller and a spring."""
    model = Model(planar=planar)
    foot = FOOT[:2] if planar else FOOT
    tip = foot + (WAY if planar else ACROSS)
    names = ["foot", "tip", "hook"]
    for name in reversed(names) if turned else names:
        model.node(name, foot if name == "foot" else tip)
    parts = [lambda: model.rigid_body("payload", "hook", 0.2,
                                      2e-3 if planar else np.diag([1e-3, 2e-3, 3e-3])),
             lambda: model.superelement("arm", arm(planar), ["foot", "tip"])]
    for part in parts if turned else parts[::-1]:
        part()
    hinge = {} if planar else {"axis": AXIS}
    model.revolute("foot", **hinge, name="hinge")
    if carries:
        model.weld("hook", to="tip", explicit=True, name="grip")
    if extra:
        model.node("loose", foot + 3.0)
        model.rigid_body("ball", "loose", 1.0, 1.0 if planar else np.eye(3))
    model.torsion_spring("hinge", 3.0, 0.1, name="coil")
    model.actuator("motor", joint="hinge")
    model.controller("law", state_feedback([[0.4]]), ["hinge.rate"], ["motor"])
    model.gravity((0.0, -9.81) if planar else DOWN)
    return model


@cache
def carried(planar):
    return simulate(crane(planar, True), H, DROP)


@SPACES
@HOW
def test_a_dropped_payload_flies(planar, how):
    """On a parabola and without a moment, from the state at which it is let go; the arm, too."""
    before = carried(planar)
    after = simulate(crane(planar, False), H, END - DROP, start=before, **how)
    x, v = (before[f"hook.{name}"][-1] for name in ("position", "velocity"))
    down = np.array([0.0, -9.81]) if planar else DOWN
    t = after.t[:, None]
    np.testing.assert_allclose(after["hook.position"], x + v * t + down * t**2 / 2, atol=1e-10)
    spin = after["hook.angular_velocity"]
    assert np.abs(spin[0] - before["hook.angular_velocity"][-1]).max() < 1e-12
    assert after.start.untaken == ("joint, load or rigid body grip (of the start alone)",)
    assert abs(after.start.lost) < 1e-9
    assert "not taken over       joint, load or rigid body grip" in after.summary()
    for name in ("tip.position", "tip.velocity", "arm.modes", "hinge.angle", "energy.strain"):
        np.testing.assert_allclose(after[name][0], before[name][-1], rtol=1e-9, atol=1e-9)
    assert np.abs(after["arm.modes"][0]).max() > 1e-6 and abs(after["hinge.angle"][0]) > 1e-2


@SPACES
def test_order_of_creation_is_nothing(planar):
    """The same parts built in another order, and a part that the start does not have."""
    before = carried(planar)
    one = simulate(crane(planar, True), H, END - DROP, start=before)
    other = simulate(crane(planar, True, turned=True), H, END - DROP, start=before)
    more = simulate(crane(planar, True, extra=True), H, END - DROP, start=before)
    assert one.start.untaken == other.start.untaken == ()
    assert more.start.untaken == ("node loose (not in the start)",
                                  "joint, load or rigid body ball (not in the start)")
    for name in ("tip.position", "hook.velocity", "arm.modes", "hinge.angle"):
        np.testing.assert_allclose(other[name], one[name], rtol=1e-7, atol=1e-7)
        np.testing.assert_allclose(more[name], one[name], rtol=1e-7, atol=1e-7)


PLACES = np.array([[1.0, 2.0, -0.5], [2.2, 1.4, 0.3]])
MASSES, SPEED = (0.7, 1.9), np.array([0.3, -0.2, 0.5])


def pair(planar, roped, meet):
    """Two masses that fly freely, and are as far apart at the time `meet` as at the start.

    Their relative velocity w has r . w = - meet w^2 / 2, with their distance r at the start.
    """
    D = 2 if planar else 3
    model = Model(planar=planar)
    r = (PLACES[1] - PLACES[0])[:D]
    across = np.array([r[1], -r[0], 0.0][:D]) / np.hypot(*r[:2])
    w = across * 1.5 - r * (1.0 - np.sqrt(1.0 - (1.5 * meet)**2 / (r @ r))) / meet
    for k, name in enumerate("ab"):
        node = model.node(name, PLACES[k][:D], keeps="translation")
        model.point_mass(f"mass {name}", node, MASSES[k])
        if not roped:
            model.initial_velocity(name, SPEED[:D] + k * w)
    if roped:
        model.distance("a", "b", name="rope")
    return model


@SPACES
@HOW
def test_a_rope_becomes_taut(planar, how):
    """Plastic impact along the line of the masses: impulse m (w . n), momenta as they were."""
    meet = 0.25
    before = simulate(pair(planar, False, meet), 0.01, meet)
    after = simulate(pair(planar, True, meet), 0.01, 0.1, start=before, **how)
    (xa, xb), (va, vb) = ([before[f"{n}.{q}"][-1] for n in "ab"] for q in ("position", "velocity"))
    n = (xb - xa) / np.linalg.norm(xb - xa)
    w, reduced = vb - va, MASSES[0] * MASSES[1] / sum(MASSES)
    assert w @ n > 0.1                      # it would stretch
    impulse = reduced * (w @ n) * n
    np.testing.assert_allclose(after["a.velocity"][0], va + impulse / MASSES[0], atol=1e-10)
    np.testing.assert_allclose(after["b.velocity"][0], vb - impulse / MASSES[1], atol=1e-10)
    for name in ("momentum", "angular_momentum"):
        np.testing.assert_allclose(after[name][0], before[name][-1], atol=1e-12)
    assert after.start.lost == pytest.approx(reduced * (w @ n)**2 / 2, rel=1e-9)
    assert f"energy lost          {after.start.lost:.6g} at the start" in after.summary()


def test_results_of_files_serve(tmp_path):
    """As a start, and what was not taken over is in the file of the next one."""
    before = carried(False)
    read = Result.load(before.save(tmp_path / "before.npz"))
    one, other = (simulate(crane(False, False), H, 0.02, start=s) for s in (before, read))
    np.testing.assert_array_equal(one["tip.position"], other["tip.position"])
    kept = Result.load(other.save(tmp_path / "after.npz"))
    assert kept.start == other.start and kept.start.untaken
    assert "grip (of the start alone)" in kept.summary()


def moved():
    model = crane(False, False)
    model.nodes["hook"].point = model.nodes["hook"].point + 0.1
    return model


def strange():
    model = Model()
    model.node("else", (0.0, 0.0, 0.0))
    model.rigid_body("ball", "else", 1.0, np.eye(3))
    return model


def wrong_way():
    """A node that has moved is fixed where it was built."""
    model = crane(False, False)
    model.fix("tip", "position")
    return model


@pytest.mark.parametrize("make, said", [
    (moved, r"start is a state of another model, whose node 'hook' is built in another place, "
            r"\(.*\) in place of \(.*\): give the Result of a model with nodes and bodies"),
    (strange, "start is a state of another model, with no node in common: give the Result of a "),
    (lambda: crane(True, False), "of which one is planar and one in space: give the Result of"),
    (wrong_way, "start: tip.position is not where the model holds or moves it at t = 0")],
    ids=["moved", "strange", "planar", "fixed"])
def test_refused(make, said):
    with pytest.raises(InputError, match=said):
        simulate(make(), H, 0.1, start=carried(False))
