"""Random responses against closed forms, and against sums over modes by NumPy."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, simulate
from sebody.analysis import equilibrium, random_response, vibrations
from sebody.fem import hexahedral_block, rectangle, straight_beam
from sebody.reduction import RigidFace, craig_bampton, reduce

TURN = Rotation.from_rotvec((0.7, -1.1, 0.4)).as_matrix()
NONE = [(0.0, 0.0), (1.0, 0.0)]
ALONG, LOW, HIGH = TURN[:, 0], 1e-9, 1e9       # a band in which white noise is white
MASS, STIFFNESS = 2.0, 300.0
OMEGA = np.sqrt(STIFFNESS / MASS)


def oscillator(ratio, moved=False):
    """A mass that hangs on a spring with a damper; it swings, undamped, which nothing sees."""
    model = Model()
    anchor = model.node("anchor", (1.0, 2.0, 3.0), keeps="translation")
    if moved:
        model.move(anchor, ALONG, NONE, name="shaker")
    else:
        model.fix(anchor, "position")
    model.node("weight", (1.0, 2.0, 3.0) + 2.0 * ALONG, keeps="translation")
    model.point_mass("mass", "weight", MASS)
    model.spring("weight", anchor, STIFFNESS, damping=2 * ratio * OMEGA * MASS, name="spring")
    model.gravity(9.0 * ALONG)
    model.force("weight", ALONG, NONE, name="push")
    model.force("weight", TURN[:, 1], NONE, name="aside")
    return model


@pytest.mark.parametrize("ratio", [1e-5, 0.02, 0.7])
def test_white_noise_on_an_oscillator(ratio):
    density = 0.3
    found = random_response(equilibrium(oscillator(ratio), 2), {
        "push": [(LOW, density), (HIGH, density)]}, ["weight.position", "weight.velocity"])
    damping = 2 * ratio * OMEGA * MASS
    place, speed = (np.sqrt(density / (4 * damping * one)) for one in (STIFFNESS, MASS))
    for k, axis in enumerate("xyz"):
        position, velocity = f"weight.position.{axis}", f"weight.velocity.{axis}"
        assert found.rms[position] == pytest.approx(place * abs(ALONG[k]), rel=1e-7)
        assert found.rms[velocity] == pytest.approx(speed * abs(ALONG[k]), rel=1e-7)
        assert found.crossings[position] == pytest.approx(OMEGA / (2 * np.pi), rel=1e-7)
    assert "weight.position.x" in repr(found) and "<td>" in found._repr_html_()


@pytest.mark.parametrize("ratio", [1e-4, 0.05, 0.4])
def test_a_shaken_oscillator(ratio):
    """Miles's equation with the term that it leaves out: ``omega S (1 + 4 zeta^2) / (8 zeta)``."""
    # the base moves by 1 / omega^2, of which far below 1e-6 only rounding is left
    density, low = 2.5, 1e-6
    found = random_response(equilibrium(oscillator(ratio, True), 2), {
        "shaker": [(low, density), (HIGH, density)]}, ["weight.acceleration", "spring.force"])
    rms = np.sqrt(OMEGA * density * (1 + 4 * ratio**2) / (8 * ratio) - density * low)
    for k, axis in enumerate("xyz"):
        name = f"weight.acceleration.{axis}"
        assert found.rms[name] == pytest.approx(rms * abs(ALONG[k]), rel=1e-7)
        # which nothing but the spring and its damper make
        assert found.rms[f"spring.force.{axis}"] == pytest.approx(MASS * found.rms[name], rel=1e-7)


def test_tables_are_straight_in_logarithms():
    """The acceleration of a rigid mount is that of the base, whose integral is in closed form."""
    model = oscillator(0.05, True)
    found = random_response(equilibrium(model, 2), {
        "shaker": [(2.0, 0.5), (8.0, 4.0), (50.0, 4.0), (200.0, 0.02)]}, "anchor.acceleration")
    area = 0.0
    for (f, s), (g, r) in zip([(2.0, 0.5), (8.0, 4.0), (50.0, 4.0)],
                              [(8.0, 4.0), (50.0, 4.0), (200.0, 0.02)], strict=True):
        power = np.log(r / s) / np.log(g / f)
        area += s / f**power * (g**(power + 1) - f**(power + 1)) / (power + 1)
    for k, axis in enumerate("xyz"):
        name = f"anchor.acceleration.{axis}"
        assert found.rms[name] == pytest.approx(np.sqrt(area) * abs(ALONG[k]), rel=1e-9)
    at = np.searchsorted(found.frequency, 4.0)
    assert found.psd[name][at] == pytest.approx(
        0.5 * (found.frequency[at] / 2.0)**1.5 * ALONG[2]**2, rel=1e-9)


BETA = 2e-4         # damping by that of the stiffness


def shaken(driven):
    """A box on springs on a table that moves aslant, by a prescribed motion or by an equation."""
    model, way = Model(), TURN @ (0.6, 0.0, 0.8)
    table, box = model.node("table", (1.0, 2.0, 0.5)), model.node("box", (1.0, 2.0, 0.5))
    inertia = np.diag([0.1, 0.2, 0.25])
    model.rigid_body("weight", box, 2.0, inertia)
    model.bushing(box, table, (300.0, 400.0, 500.0), (3.0, 4.0, 5.0), 50.0, 0.5)
    if driven:
        model.rigid_body("top", table, 1.0, inertia)
        model.drive_slide(model.prismatic(table, axis=way), NONE, name="shaker")
    else:
        model.fix(table, "rotation")
        model.move(table, way, NONE, name="shaker")
    return equilibrium(model, 1)


@pytest.mark.filterwarnings("ignore:drive 'shaker'")
def test_a_shaker_by_an_equation_is_that_of_a_motion():
    rows = [(0.1, 1.0), (2.0, 4.0), (50.0, 0.1)]
    one, other = (random_response(shaken(driven), {"shaker": rows}, ["box.acceleration",
                                                                     "box.position"])
                  for driven in (False, True))
    assert min(one.rms.values()) > 0.01
    for name, value in one.rms.items():
        assert other.rms[name] == pytest.approx(value, rel=1e-7), name


def cantilever():
    """A bar of several modes, in general position."""
    bar = straight_beam((0, 0, 0), (2.0, 0, 0), rectangle(0.02, 0.05, 7e10, 0.3, 2700.0), 12)
    body = reduce(bar, {0: "full", 12: "full"}, 6).damped(stiffness=BETA)
    model, root = Model(), np.array([1.0, -2.0, 0.5])
    model.superelement("bar", body, [model.node("root", root),
                                     model.node("tip", root + 2.0 * ALONG)], rotation=TURN)
    model.fix("root")
    model.force("tip", TURN @ (0.0, 0.6, 0.8), NONE, name="push")
    model.force("tip", TURN @ (0.0, 0.8, -0.6), NONE, name="other")
    return equilibrium(model, 1)


def test_a_cantilever():
    """Two loads that do not depend on each other, about the resonances of both planes."""
    run = cantilever()
    tables = {"push": [(1.0, 2.0), (40.0, 5.0), (300.0, 0.1)], "other": [(3.0, 7.0), (90.0, 0.4)]}
    found = random_response(run, tables, "tip.position")
    own = vibrations(run)
    shape, total = own.shape("tip.position"), 0.0
    for name, way in (("push", (0.0, 0.6, 0.8)), ("other", (0.0, 0.8, -0.6))):
        for (f0, s0), (f1, s1) in zip(tables[name][:-1], tables[name][1:], strict=True):
            f = np.geomspace(f0, f1, 100_001)
            w, H = 2 * np.pi * f, 0.0
            for s, one in zip(shape.T, own.omega, strict=True):
                H = H + np.outer(s, s @ TURN @ way / (one**2 - w**2 + 1j * w * BETA * one**2))
            density = np.exp(np.interp(np.log(f), np.log([f0, f1]), np.log([s0, s1])))
            total = total + np.trapezoid(density * np.abs(H)**2, f)
    assert_allclose([found.rms[f"tip.position.{axis}"] for axis in "xyz"], np.sqrt(total),
                    rtol=1e-6)


def test_a_run_of_two_hundred_seconds():
    """A load of many sines with random phases, which repeats after these seconds."""
    model, period, h = oscillator(0.05), 200.0, 0.01
    table = [(0.5, 2.0), (2.0, 6.0), (6.0, 0.5)]
    f = np.arange(100, 1201) / period
    density = np.exp(np.interp(np.log(f), *np.log(table).T))
    density[[0, -1]] /= 2
    lines = np.zeros(int(period / h), dtype=complex)
    phases = np.random.default_rng(5).uniform(0.0, 2 * np.pi, len(f))
    lines[100:1201] = np.sqrt(2 * density / period) * np.exp(1j * phases)
    loads = np.tile(np.fft.fft(lines).real, 2)[:int(240.0 / h) + 1]
    model.force("weight", ALONG, np.column_stack([h * np.arange(len(loads)), loads]), name="noise")
    found = random_response(equilibrium(oscillator(0.05), 2), {"push": table}, "weight.velocity")
    result = simulate(model, h, 240.0)
    speeds = result["weight.velocity"][4000:24000] @ ALONG      # after a fall of exp(-24)
    assert np.std(speeds) == pytest.approx(found.rms["weight.velocity.x"] / abs(ALONG[0]), rel=0.01)


def test_stresses_in_a_block():
    """Far below the resonances: the stress of an equilibrium under a small load, in proportion."""
    size, ends = (12.0, 1.0, 1.0), (0.0, 12.0)
    block = hexahedral_block((0, 0, 0), size, (12, 2, 2), 4e6, 0.0, 1e-3)
    x, middle = block.coordinates[:, 0], (0.5, 0.5)
    faces = [RigidFace((end, *middle), np.flatnonzero(np.isclose(x, end))) for end in ends]
    body = craig_bampton(block, [(face, "full") for face in faces], 4).damped(0.02)
    model = Model()
    root, tip = (model.node(name, TURN @ (end, *middle)) for name, end in zip("rt", ends,
                                                                              strict=True))
    model.superelement("block", body, (root, tip), rotation=TURN)
    model.force(tip, TURN[:, 2], NONE, name="push")
    model.fix(root)
    node = int(np.argmin(np.linalg.norm(block.coordinates - (6.0, 0.5, 1.0), axis=1)))
    run, rows = equilibrium(model, 1), [(1e-4, 3.0), (2e-4, 3.0)]
    found = random_response(run, {"push": rows}, f"block.node{node}.stress")
    model.force(tip, TURN[:, 2], [(0.0, 0.01), (1.0, 0.01)], name="still")
    bent = equilibrium(model, 1)[f"block.node{node}.stress"][-1] / 0.01
    assert abs(bent[0]) > 10.0      # of unit loads; 36 by the modulus of the section
    for k in (0, 4):        # xx and zx
        name = f"block.node{node}.stress." + ("xx", "yy", "zz", "yz", "zx", "xy")[k]
        assert found.rms[name] == pytest.approx(np.sqrt(3e-4) * abs(bent[k]), rel=1e-4)
    with pytest.raises(InputError, match="name components of stress"):
        random_response(run, {"push": rows}, f"block.node{node}.von_mises")
    with pytest.raises(InputError, match="most stressed fibre"):
        random_response(cantilever(), {"push": rows}, "bar.node4.stress.xx")


def test_what_is_refused():
    run = equilibrium(oscillator(0.0), 2)
    flat = [(0.1, 1.0), (10.0, 1.0)]
    with pytest.raises(InputError, match=r"motion at 1\.949\d* cycles in a unit of time has no"):
        random_response(run, {"push": flat}, "weight.position")
    outside = random_response(run, {"push": [(3.0, 1.0), (10.0, 1.0)]}, "weight.position")
    assert min(outside.rms.values()) > 0.0
    run = equilibrium(oscillator(0.1), 2)
    with pytest.raises(InputError, match="has no damping; add some"):      # it swings
        random_response(run, {"aside": flat}, "weight.position")
    for rows, said in ([(1.0, 1.0)], "two rows or more"), ([(1.0, 0.0), (2.0, 1.0)], "no zero"), (
            [(2.0, 1.0), (1.0, 1.0)], "ascending"), ([1.0, 2.0], r"give rows \(frequency"):
        with pytest.raises(InputError, match=said):
            random_response(run, {"push": rows}, "weight.position")
    with pytest.raises(InputError, match="shove"):
        random_response(run, {"shove": flat}, "weight.position")
    with pytest.raises(InputError, match="at least one input"):
        random_response(run, {}, "weight.position")


def coherent(values):
    """Two forces along a spring, of the densities 2 and 3, with some coherence."""
    model = oscillator(0.05)
    model.force("weight", ALONG, NONE, name="pull")
    tables = {"push": [(1.0, 2.0), (9.0, 2.0)], "pull": [(1.0, 3.0), (9.0, 3.0)]}
    return random_response(equilibrium(model, 2), tables, "weight.position.x", coherence=values)


@pytest.mark.parametrize("order", [1, -1])
def test_inputs_that_depend_on_each_other(order):
    """``S = |H|^2 (S_a + S_b + 2 Re(g) sqrt(S_a S_b))``: g is a number, or changes linearly."""
    name, pair = "weight.position.x", ("push", "pull")[::order]
    apart = coherent(None)
    for value in (1.0, -0.4, 0.3 + 0.6j, 1j):
        found = coherent({pair: value})
        factor = 1.0 + 2.0 * np.real(value) * np.sqrt(6.0) / 5.0
        assert found.rms[name] == pytest.approx(apart.rms[name] * np.sqrt(factor), rel=1e-9)
    rows = [(2.0, 0.5), (6.0, -0.5 + 0.2j)]
    found = coherent({pair: rows})
    own = np.interp(found.frequency, (2.0, 6.0), (0.5, -0.5))
    w = 2.0 * np.pi * found.frequency
    answer = ALONG[0] / (STIFFNESS - MASS * w**2 + 0.1j * OMEGA * MASS * w)
    assert_allclose(found.psd[name], np.abs(answer)**2 * (5.0 + 2.0 * own * np.sqrt(6.0)),
                    rtol=1e-8)


def test_coherences_that_no_motions_have():
    for values, said in (
            ({("push", "pull"): 1.2}, "coherence at the frequency 1: no motions have such values"),
            ({("push", "push"): 0.1}, "name two inputs that have a psd, push, pull"),
            ({("push", "x"): 0.1}, "name two inputs that have a psd"),
            ({("push", "pull"): [(2.0, 0.1), (1.0, 0.2)]}, "frequencies ascending"),
            ({("push", "pull"): "x"}, "give a complex number"),
            ({("push", "pull"): 0.1, ("pull", "push"): 0.1}, "a pair of inputs is given twice"),
            (3, "give a complex number, or rows")):
        with pytest.raises(InputError, match=said):
            coherent(values)
