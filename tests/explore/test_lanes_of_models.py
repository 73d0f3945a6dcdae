"""Models of many kinds in lanes: each member equals its single run, in whatever order."""

import numpy as np
import pytest
from lane_models import assert_bits_in_other_company, single
from scipy.spatial.transform import Rotation

from sebody import Model, generalized_alpha, piecewise, simulate
from sebody.analysis import Ensemble, final, maximum
from sebody.compiler.choice import way
from sebody.control import pid
from sebody.explore.ensembles import ensemble
from sebody.explore.ensembles.choice import matrices_at_once
from sebody.fem import Section, straight_beam
from sebody.parameters.table import handle
from sebody.reduction import craig_bampton, reduce

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
FOOT = np.array([3.0, -2.0, 1.0])
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=5.1, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
RUNS = 9        # one group of eight, and one run
H, STEPS = 1e-3, 60
AXIS = TURN @ (0, 0, 1)

pytestmark = pytest.mark.skipif(
    way().__name__.endswith("plain"), reason="the plain way makes runs one by one")


def place(*point: float) -> np.ndarray:
    return FOOT + TURN @ point


def chain(**options) -> Model:
    """Three unequal links on hinges about different axes, created from the tip to the root.

    Their options are those of superelements.
    """
    options = options or {"inertia": "material"}
    made, lengths, nodes = Model(), (40.0, 60.0, 50.0), {}
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    for k in (2, 1, 0):
        ends = place(starts[k], 0, 0), place(starts[k + 1], 0, 0)
        body = craig_bampton(straight_beam(*ends, SECTION, elements=4), [(0, "full"), (4, "full")],
                             modes=4, loads={"wind": np.arange(30.0) % 7.0 - 2.0})
        nodes[k] = [made.node(f"{name} {k}", point)
                    for name, point in zip(("root", "end"), body.coordinates, strict=True)]
        made.superelement(f"link {k}", body, nodes[k], **options)
    for k, axis in enumerate(((0, 0, 1), (0, 0.6, 0.8))):
        made.revolute(nodes[k][1], TURN @ axis, nodes[k + 1][0], name=f"hinge {k}")
    made.revolute(nodes[0][0], axis=TURN @ (0, 1, 0), name="foot")
    made.attach("tip", place(150.0, 1.0, 2.0), nodes[2][1])
    made.force(nodes[2][1], TURN @ (0, 1, 1), [(0, 0), (0.02, 1e4), (0.05, -3e3)], name="load")
    made.gravity((0.0, -400.0, 900.0))
    return made


def many_modes() -> Model:
    """A beam of 32 modes on a turned hinge."""
    body = craig_bampton(straight_beam(place(0, 0, 0), place(100.0, 0, 0), SECTION, elements=8),
                         [(0, "full"), (8, "full")], modes=32)
    made = Model()
    base, tip = (made.node(name, point) for name, point in zip(("base", "tip"), body.coordinates,
                                                               strict=True))
    made.superelement("beam", body, [base, tip], inertia="material")
    made.gravity((0.0, -400.0, 900.0))
    made.revolute(base, axis=TURN @ (0, 0, 1), name="hinge")
    made.force(tip, TURN @ (0, 1, 1), [(0, 0), (0.02, 1e4), (0.05, -3e3)], name="load")
    return made


def beam_on(made: Model, modes: int) -> list:
    """A beam that stands on a coupler, with its nodes."""
    body = craig_bampton(straight_beam(place(0, 30.0, 0), place(70.0, 60.0, 20.0), SECTION,
                                       elements=6), [(0, "full"), (6, "full")], modes=modes)
    nodes = [made.node(name, point) for name, point in zip(("left", "tip"), body.coordinates,
                                                           strict=True)]
    made.superelement("beam", body, nodes, inertia="material")
    return nodes


def redundant(modes: int | None = None) -> Model:
    """A spatial parallelogram of rigid bodies, whose hinges are parallel, perhaps with a beam.

    Three equations of the loop are too many.
    """
    made, axis = Model(), TURN @ (0, 0, 1)
    if modes is None:
        left = made.node("left", place(0, 30.0, 0))
        tip = made.attach("tip", place(70.0, 60.0, 20.0), left)
    else:
        left, tip = beam_on(made, modes)
    made.rigid_body("coupler", left, 30.0, np.diag((3e3, 6e3, 8e3)), place(50.0, 30.0, 0))
    right = made.attach("right", place(100.0, 30.0, 0), left)
    for k, (x, top) in enumerate(((0.0, left), (100.0, right))):
        hub = made.node(f"hub {k}", place(x, 0, 0))
        made.rigid_body(f"bar {k}", hub, 40.0, np.diag((4e3, 5e3, 9e3)), place(x, 15.0, 0))
        made.revolute(hub, axis=axis, name=f"foot {k}")
        made.revolute(made.attach(f"head {k}", top.point, hub), axis, top, name=f"pin {k}")
    made.force(tip, TURN @ (1, 0.3, 0), [(0, 0), (0.02, 4e4), (0.05, -3e4)], name="load")
    made.gravity((0.0, -400.0, 900.0))
    return made


def hinged(method: str) -> Model:
    """A beam of four modes on a turned hinge."""
    body = reduce(straight_beam(place(0, 0, 0), place(100.0, 0, 0), SECTION, elements=6),
                  [(0, "full"), (6, "full")], 4, method)
    made = Model()
    base, tip = (made.node(name, point) for name, point in zip(("base", "tip"), body.coordinates,
                                                               strict=True))
    made.superelement("beam", body, [base, tip], inertia="material")
    made.revolute(base, axis=TURN @ (0, 0, 1), name="hinge")
    made.force(tip, TURN @ (0, 1, 1), [(0, 0), (0.02, 1e4), (0.05, -3e3)], name="load")
    made.gravity((0.0, -400.0, 900.0))
    return made


def massless() -> Model:
    """MacNeal's modes: the tip follows by stiffness without mass."""
    return hinged("macneal")


def twisted() -> Model:
    """A torque twists the beam by a third of a turn: the mean of its nodes is searched for."""
    made = hinged("craig-bampton")
    made.torque("tip", TURN @ (1, 0, 0), [(0, 0), (0.02, 1.8e5), (0.06, 2.2e5)], name="twist")
    return made


def stiff(made: Model) -> list[str]:
    return [f"{name}.stiffness" for name in made.bodies]


@pytest.mark.parametrize(("build", "index"), [
    (chain, 3), (many_modes, 3), (redundant, 3), (lambda: redundant(16), 3),
    (chain, 2), (redundant, 2), (massless, 3), (massless, 2), (twisted, 3)])
def test_members_equal_single_runs(build, index, monkeypatch):
    """Stiffness, loads and gravity vary; alone and backwards the bits are the same."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    rng, made = np.random.default_rng(3), build()
    given = {name: rng.uniform(0.7, 1.5, RUNS) for name in stiff(made)}
    given |= {"load.amplitude": rng.uniform(-1, 2, RUNS), "gravity": rng.uniform(-900, 900,
                                                                               (RUNS, 3))}
    outputs = {"course": "tip.position", "most": maximum("tip.velocity"),
               "energy": final("energy.strain")}
    scheme = generalized_alpha(index=index)
    many = Ensemble(made, H, scheme)
    assert matrices_at_once(many._template) == (build is chain)
    found = many.run(given, STEPS * H, outputs)
    assert found.in_lanes == RUNS and not found.failures
    assert_bits_in_other_company(many, given, STEPS * H, outputs, found)
    for run in (0, 8):
        alone = build()
        for name, values in given.items():
            handle(alone, name).set(np.asarray(values[run], dtype=float))
        result = simulate(alone, H, STEPS * H, scheme)
        size = np.abs(result["tip.position"]).max()
        assert np.abs(found["course"][run] - result["tip.position"]).max() < 1e-10 * size
        speed = np.abs(result["tip.velocity"]).max()
        assert np.abs(found["most"][run] - result["tip.velocity"].max(axis=0)).max() < 1e-8 * speed
        assert found["energy"][run] == pytest.approx(result["energy.strain"][-1], rel=1e-6)


def test_bits_do_not_depend_on_company_where_an_iterate_is_no_number(monkeypatch):
    """Steps are too long: a member whose iteration gives no numbers has its step made anew.

    What members beside it do until then is nothing to it.
    """
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    rng = np.random.default_rng(3)
    given = {"load.amplitude": 4.0 * rng.uniform(-1, 2, 8),
             "gravity": rng.uniform(-900, 900, (8, 3))}
    many, outputs = Ensemble(chain(), 4 * H), {"course": "tip.position"}
    found = many.run(given, 20 * 4 * H, outputs)
    alone = many.run({name: v[:1] for name, v in given.items()}, 20 * 4 * H, outputs)
    assert found.in_lanes == 8 and alone.in_lanes == 1
    np.testing.assert_array_equal(alone["course"][0], found["course"][0])


def test_matrices_at_once_do_not_depend_on_who_wants_new_ones_of_bodies(monkeypatch):
    """Loads on bodies search for frames where matrices of bodies are rotated, too."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    made = chain(frame="mean_axes")
    for body in made.bodies:
        made.body_load(body, "wind", [(0, 0), (0.02, 30.0)])
    rng = np.random.default_rng(0)
    given = {"load.amplitude": 0.1 * rng.uniform(-1, 2, 8),
             "gravity": rng.uniform(-100, 100, (8, 3))}
    many, outputs = Ensemble(made, 2 * H), {"course": "tip.position"}
    assert matrices_at_once(many._template)
    found = many.run(given, 25 * 2 * H, outputs)
    for run in range(8):
        alone = many.run({name: v[run:run + 1] for name, v in given.items()}, 25 * 2 * H, outputs)
        assert alone.in_lanes == 1
        np.testing.assert_array_equal(alone["course"][0], found["course"][run])


def controlled(made: Model, node: str, joint: str, gain: float) -> Model:
    """A slow and noisy sensor, a late one, a motor with a lag and a limit, and a load that jumps.

    The motor of `joint` follows a PID of every third step, which acts late; one without a lag
    turns `node` at every second step, by a signal of the first one's.
    """
    made.sensor("late", f"{joint}.angle", rate=1.0 / (2 * H), delay=2, bias=1e-3, noise=1e-4,
                seed=5)
    made.actuator("motor", joint=joint, lag=2.5e-3, rate=400.0 * gain, limit=6.0 * gain)
    made.actuator("wheel", node=node, direction=AXIS, what="torque")
    made.controller("pid", pid(kp=gain, ki=9.0 * gain, kd=0.02 * gain, reference=0.1),
                    ["late"], ["motor"], 3 * H, delay=2 / 3)
    made.controller("damper", pid(kp=0.05 * gain), ["tip.velocity.y"], ["wheel"], 2 * H)
    made.torque(node, AXIS, piecewise((0.0, 0.4 * gain), (0.0217, -gain)), name="jump")
    return made


def of_chain() -> Model:
    """Eliminated: factorized at every sample and after it."""
    return controlled(chain(), "end 1", "hinge 0", 1e4)


def of_loop() -> Model:
    """Redundant and dense: regularized, so factorized likewise."""
    return controlled(redundant(), "left", "foot 0", 2e6)


def of_beam() -> Model:
    """Dense: both factors are kept between samples."""
    return controlled(hinged("craig-bampton"), "base", "hinge", 4e3)


def flowing(made: Model, node: str, joint: str, gain: float, held: bool = True) -> Model:
    """Continuous controllers: a PID of a joint, and a damper with a lag, which also reads a speed.

    It may be that of a sensor with a rate, `held` between samples.
    """
    if held:
        made.sensor("speed", "tip.velocity.y", rate=1.0 / (2 * H), noise=1e-3, seed=2)
    made.sensor("biased", f"{joint}.angle", bias=2e-3)
    made.actuator("motor", joint=joint, limit=2.0 * gain)
    made.actuator("wheel", node=node, direction=AXIS, what="torque")
    made.controller("pid", pid(kp=gain, ki=9.0 * gain, kd=0.02 * gain, reference=0.1), ["biased"],
                    ["motor"])

    def damper(t, y, x, rates, u, parameters):
        rates[0] = (y[0] - x[0]) / 3e-3
        u[0] = -parameters[0] * (x[0] + 1e-3 * y[1] * abs(y[1]))
    read = ["tip.velocity.y", "speed" if held else "tip.velocity.x"]
    made.controller("damper", damper, read, ["wheel"], states=[0.0], parameters=[5e-5 * gain])
    made.torque(node, AXIS, piecewise((0.0, 0.4 * gain), (0.0217, -gain)), name="jump")
    return made


def gains(made: Model, rng: np.random.Generator) -> np.ndarray:
    """Numbers of the PID's law, each of them another one for each run."""
    numbers = handle(made, "pid.parameters").base
    factors = rng.uniform(0.7, 1.3, (RUNS, numbers.size))
    return np.where(numbers == 3 * H, 1.0, factors) * numbers       # but its period


@pytest.mark.parametrize(("build", "index"), [
    (of_chain, 3), (of_loop, 3), (of_beam, 3),
    (lambda: flowing(chain(), "end 1", "hinge 0", 1e4), 3),
    (lambda: flowing(redundant(16), "left", "foot 0", 2e6, held=False), 2)])
def test_controlled_members_equal_single_runs(build, index, monkeypatch):
    """Gravity, loads and gains vary; alone and backwards the bits are the same."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    rng, made = np.random.default_rng(4), build()
    given = {"load.amplitude": rng.uniform(-1, 2, RUNS),
             "gravity": rng.uniform(-900, 900, (RUNS, 3)), "pid.parameters": gains(made, rng)}
    outputs = {"course": "tip.position", "motor": "motor.value", "end": final("tip.velocity")}
    scheme = generalized_alpha(index=index)
    many = Ensemble(made, H, scheme)
    found = many.run(given, STEPS * H, outputs)
    assert found.in_lanes == RUNS and not found.failures
    assert_bits_in_other_company(many, given, STEPS * H, outputs, found)
    for run in (0, 8):
        result = single(made, {name: v[run] for name, v in given.items()}, H, STEPS * H, scheme)
        for name, quantity in (("course", "tip.position"), ("motor", "motor.value")):
            size = np.abs(result[quantity]).max()
            assert size > 0.0
            assert np.abs(found[name][run] - result[quantity]).max() < 1e-10 * size
