"""Axial forces of bodies without stiffening: closed forms, tangents of kernels, warnings."""

import warnings

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, SimulationError, simulate
from sebody.analysis import equilibrium, vibrations
from sebody.fem import StiffnessSection, straight_beam
from sebody.reduction import craig_bampton
from sebody.runs.limits.axial import Axial
from sebody.runs.limits.thresholds import AXIAL

TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
PLACE = np.array([3.0, -5.0, 2.0])
E, UP = TURN[:, 0], TURN[:, 2]
EULER = np.pi**2
UNITS = {"one": (1.0, 1.0), "small": (2e-3, 5.0)}      # length, E I


def rod(inertia="material", frame="converged_mean", units=(1.0, 1.0), nodes=(0, 8), backwards=False,
        modes=0, ends="pinned"):
    """A turned rod of eight elements, one body that keeps some nodes; its model and unit of force.

    Pinned ones turn about an axis across; their second end slides along the rod.
    """
    length, bending = units
    force = bending / length**2
    section = StiffnessSection(axial=1e6 * force, bending_y=bending, bending_z=bending,
                               torsion=bending, mass=1.0, inertia_x=2e-4 * length**2,
                               inertia_y=1e-4 * length**2, inertia_z=1e-4 * length**2)
    fe_model = straight_beam(PLACE * length, PLACE * length + E * length, section, 8, up=UP)
    body = craig_bampton(fe_model, [(k, "full") for k in (nodes[::-1] if backwards else nodes)],
                         modes)
    model = Model()
    names = [model.node(f"node {k}", x) for k, x in enumerate(body.coordinates)]
    model.superelement("rod", body, names, frame=frame, inertia=inertia)
    if backwards:
        names = names[::-1]
    if ends == "pinned":
        model.revolute(names[0], TURN[:, 1])
        model.slider(names[-1], E)
    else:
        model.fix(names[0])
    return model, names[-1].name, force


def pulled(force, **options):
    """The model of a rod under an axial force, in E I / L^2, and its pulled end."""
    model, end, unit = rod(**options)
    model.force(end, force * unit * E)
    return model, end


def said(run):
    """What a function returns or raises, and the warnings it gives."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        try:
            answer = run()
        except SimulationError as error:
            answer = str(error)
    return answer, [str(w.message) for w in found]


@pytest.mark.parametrize("units", UNITS.values(), ids=UNITS)
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize(("frame", "limit"), [("converged_mean", 12.0), ("node", 3.0)])
def test_limits_of_a_rod(frame, limit, backwards, units):
    """Against closed forms: 3 E I / L^2, and 12 or 3 of them at which it folds up in its frame."""
    model, _, unit = rod(frame=frame, units=units, backwards=backwards, modes=2)
    part = model.bodies["rod"]
    own = np.zeros((2, 3))
    own[0], own[1] = -E, E
    if backwards:
        own = -own
    pull = np.concatenate([0.75 * unit * own.ravel(), np.zeros(6 + 2)])
    y = np.linalg.pinv(part.reduced.stiffness) @ pull
    for sign in (1.0, -1.0):
        load = Axial.of(part).load(sign * y)
        assert load.force == pytest.approx(sign * 0.75 * unit, rel=1e-6)
        assert load.share == pytest.approx(0.25, rel=1e-5)
        assert load.folding == pytest.approx(0.75 / limit if sign > 0.0 else 0.0, rel=1e-5)
        assert load.tilt < 1e-6
        # on the positions as they are, which are 1e-6 further apart
        assert load.share < Axial.of(part).bound(sign * y[None])[0] * (1.0 + 1e-5)


LAYOUTS = {"two nodes": {"frame": "converged_mean"}, "on one node": {"frame": "node"},
           "three nodes": {"nodes": (0, 3, 8)}, "four, backwards": {"nodes": (0, 1, 5, 8),
                                                                     "backwards": True},
           "option D": {"inertia": "rigid_part"}}


@pytest.mark.parametrize("options", LAYOUTS.values(), ids=LAYOUTS)
def test_straight_rods_lose_their_stiffness_at_the_limit(options):
    """The predicted tension against the tangents of the kernels: stable below, unstable above."""
    model, end = pulled(0.1, **options)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        y = np.linalg.pinv(model.bodies["rod"].reduced.stiffness)
        positions = np.zeros(len(y))
        d = 3 * len(model.bodies["rod"].positions)
        first, last = (0, d - 3) if not options.get("backwards") else (d - 3, 0)
        positions[first:first + 3], positions[last:last + 3] = -E, E
        limit = 1.0 / Axial.of(model.bodies["rod"]).load(y @ positions).folding
        stable = vibrations(equilibrium(pulled(0.98 * limit, **options)[0], 3))
        assert stable.omega.min() > 0.0
        with pytest.raises(SimulationError, match=r"the equilibrium at 1 of the load is unstable: "
                           r"body 'rod' folds up in its frame under tension .* \(limit .*\), as "
                           "its stiffness does not grow with tension: divide the body in two, or "
                           "take "
                           "inertia='floating_field'"):
            equilibrium(pulled(1.02 * limit, **options)[0], 1)


@pytest.mark.parametrize("inertia", "bd")
@pytest.mark.parametrize("units", UNITS.values(), ids=UNITS)
def test_rods_that_fold_up_are_refused(inertia, units):
    """At 20 E I / L^2 with a moment at an end a rod was 68 % longer; with stiffening it is not."""
    found = {}
    for option in (inertia, "floating_field"):
        model, end = pulled(20.0, inertia=option, units=units)
        model.torque("node 0", 0.17 * units[1] / units[0] * TURN[:, 1])
        found[option] = said(lambda model=model: equilibrium(model, 10))
    refused, _ = found[inertia]
    assert "of the load is not that of the structure: the frame is" in refused
    assert "rad off the line of the nodes: body 'rod' folds up" in refused
    result, messages = found["floating_field"]
    stretch = (result[f"{end}.position"][-1] - PLACE * units[0]) @ E / units[0] - 1.0
    assert not messages
    # the moment tilts the ends by some 0.17 / sqrt(20), which takes half its square of the length
    assert abs(stretch - 20e-6) < 1e-3


@pytest.mark.parametrize("backwards", [False, True])
def test_clamped_rods_stretch_rightly_and_warn(backwards):
    """Beyond the limit of its frame: the clamp holds the frame, the stiffness alone is wrong."""
    model, end = pulled(5.0, frame="node", ends="clamped", backwards=backwards)
    # the frame on the clamped node
    if backwards:
        model.bodies["rod"].alpha[:] = model.bodies["rod"].alpha[::-1].copy()
        model.bodies["rod"].alpha_r[:] = model.bodies["rod"].alpha_r[::-1].copy()
    result, (message,) = said(lambda: equilibrium(model))
    assert (result[f"{end}.position"][-1] - PLACE) @ E == pytest.approx(1.0 + 5e-6, abs=1e-9)
    assert message.startswith(
        "tension 5 in body 'rod' counts 1.7 times as much as its own bending stiffness (limit a "
        "third), which does not depend on it: bending has errors of 10 % and more, and under 3 the "
        "body folds up in its frame unless its ends are clamped; divide the body in two, or take "
        "inertia='floating_field'")


@pytest.mark.parametrize("inertia", "bd")
def test_compression_is_warned_of(inertia):
    """At a quarter of Euler's load moments at the ends bend a rod by a third more than the body."""
    model, _ = pulled(-EULER / 4.0, inertia=inertia)
    moment = 1e-3
    for node, sign in (("node 0", 1.0), ("node 1", -1.0)):
        model.torque(node, sign * moment * TURN[:, 1])
    result, (message,) = said(lambda: equilibrium(model))
    assert message.startswith("compression 2.47 in body 'rod' counts 0.82 times as much as its own "
                              "bending stiffness (limit a third)")
    assert "and the body does not buckle at the right load; divide the body in two" in message
    angle = Rotation.from_matrix(result["node 0.rotation"][-1]).magnitude()
    k = np.sqrt(EULER / 4.0)
    beam = moment * np.tan(k / 2.0) / k       # M tan(k L / 2) / k E I of a beam
    assert angle == pytest.approx(moment / 2.0, rel=1e-3) and beam / angle == pytest.approx(
        4.0 / np.pi, rel=1e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_threshold(sign):
    """Nothing is said below a third of 3 E I / L^2, nor of bodies that stiffen."""
    counts = [len(said(lambda f=f, o=o: equilibrium(pulled(3.0 * sign * f, inertia=o)[0], 2))[1])
              for f, o in ((0.98 * AXIAL, "material"), (1.02 * AXIAL, "material"),
                           (5.0 * AXIAL, "floating_field"))]
    assert counts == [0, 1, 0]


def test_runs_and_small_motion_warn_once():
    """Of a tension in a divided rod: the body with the largest, and the names of others."""
    section = StiffnessSection(axial=1e4, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                               inertia_x=2e-3, inertia_y=1e-3, inertia_z=1e-3)
    model = Model()
    ends = [model.node(name, PLACE + s * E) for name, s in (("a", 0.0), ("b", 4.0))]
    model.beam("rod", ends, section, 8, 4, 0, up=UP, inertia="material")
    model.fix("a")
    model.force("b", 2.0 * E)
    for node, more in zip(["rod 2", "rod 4"], (0.2, 0.1), strict=False):
        if node in model.nodes:
            model.force(node, more * E)
    _, messages = said(lambda: simulate(model, 1e-3, 0.1))
    strong = [m for m in messages if m.startswith("tension")]
    assert len(strong) == 1 and "(also " in strong[0] and strong[0].count("'") >= 4


def random_rows(seed):
    """Three points in a plane, free in all directions, and rotations that one direction lets go."""
    rng = np.random.default_rng(seed)
    points = np.array([[1.0, 0.1, 0.0], [-0.6, 0.9, 0.0], [-0.4, -1.0, 0.0]])
    turn = Rotation.random(random_state=seed).as_matrix()
    own = rng.normal(size=(9, 9))
    directions = np.outer(turn[:, 2], turn[:, 2]) if seed % 2 else np.diag(rng.random(3))
    return Axial(own @ own.T, np.eye(9).reshape(3, 3, 9), points @ turn.T, directions[None],
                 np.eye(9))


def test_no_share_is_above_its_bound():
    """The bound is by traces: of a virial that presses from all sides, 0.47 of it is reached."""
    shares = []
    for seed in range(40):
        rows, rng = random_rows(seed), np.random.default_rng(100 + seed)
        states = 1e-6 * rng.normal(size=(20, 9))
        states[0] = np.linalg.solve(rows.stiffness, 1e-6 * rows.points.ravel())     # all outwards
        shares += [rows.load(y).share / bound for y, bound in zip(states, rows.bound(states),
                                                                 strict=True)]
    assert max(shares) < 1.0
    assert max(shares) > 0.45
