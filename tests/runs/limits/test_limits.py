"""The spin at which one body diverges: closed forms, growth of small motion, warnings."""

import itertools
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from stiffened_models import TURN as TURNED, block

from sebody import LimitWarning, Model, Simulation
from sebody.analysis import equilibrium, modes
from sebody.fem import Section, StiffnessSection, planar_beam, straight_beam
from sebody.reduction import ReducedBody, craig_bampton
from sebody.runs.limits.body_limits import Finding
from sebody.runs.limits.spin_stability import cautious_limit, first_frequency, reach
from sebody.runs.limits.thresholds import FAST
from sebody.runs.limits.watch import Watch, spin_limit

LENGTH = 2.0
SLENDER = Section(area=1.0, inertia_y=1e-4, inertia_z=1e-4, torsion=1e-4, youngs_modulus=3e4,
                  poisson_ratio=0.3, density=1.0)


@pytest.mark.parametrize("masses", [(1.0, 4.0), (4.0, 1.0)])
@pytest.mark.parametrize("axis", [np.array([0.0, 0.0, 1.0]), None])
def test_the_worst_pivot_counts(masses, axis):
    """A bar without mass between two point masses, its frame along the first end.

    About either end the other mass bends the bar as the tip of a cantilever does, with the
    stiffness ``3 EI / L^3``: the heavier one diverges first.
    """
    bar = craig_bampton(planar_beam((0, 0), (LENGTH, 0), SLENDER, 1), [(0, "full"), (1, "full")], 0)
    mass = np.diag(np.array([*np.repeat(masses, 2), 1e-3, 1e-3]))
    model = Model(planar=True)
    ends = model.node("left", (0.0, 0.0)), model.node("right", (LENGTH, 0.0))
    body = model.superelement("bar", ReducedBody(bar.stiffness, mass, bar.coordinates, bar.keeps),
                              ends, frame="node", inertia="material")
    stiffness = 3 * SLENDER.youngs_modulus * SLENDER.inertia_z / LENGTH**3
    assert stiffness < SLENDER.youngs_modulus * SLENDER.area / LENGTH
    assert spin_limit(body, axis) == pytest.approx(np.sqrt(stiffness / max(masses)), rel=1e-9)


TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()


def blade(frame="converged_mean", inertia="material", torsion=0.1, stiffened=True, modes=0,
          length=1.0,
          mass=1.0, held="root"):
    """A turned cantilever of unit bending stiffness over cubed length and mass, any units."""
    force = mass * length           # in seconds
    section = StiffnessSection(axial=1e5 * force, bending_y=force * length**2,
                               bending_z=force * length**2, torsion=torsion * force * length**2,
                               mass=mass / length, inertia_x=2e-6 * mass * length,
                               inertia_y=1e-6 * mass * length, inertia_z=1e-6 * mass * length)
    ends = np.array([[0.0], [length]] if held == "root" else [[-length], [0.0]]) * TURN[:, 0]
    fe_model = straight_beam(*ends, section, 8, up=TURN[:, 2])
    if not stiffened:
        fe_model = replace(fe_model, geometric_stiffness=None)
    body = craig_bampton(fe_model, [(0, "full"), (8, "full")], modes)
    model = Model()
    nodes = [model.node(name, x) for name, x in zip(("root", "tip"), body.coordinates,
                                                    strict=True)]
    model.superelement("blade", body, nodes, frame=frame, inertia=inertia)
    model.fix(held)
    return model


def limit_of(model, axis):
    return spin_limit(model.bodies["blade"], TURN @ np.array(axis))


@pytest.mark.parametrize("units", [(1.0, 1.0), (1e3, 1e-3)])
@pytest.mark.parametrize(("frame", "square"), [("converged_mean", 80.0), ("node", 16.8)])
@pytest.mark.parametrize("torsion", [0.1, 1e-3])
def test_torsion_of_option_b(units, frame, square, torsion):
    """About an axis across a beam, of the cubic shapes alone: ``W^2 = 80`` and 16.8 G J / m L^4.

    A twist ``t`` of the tip against the frame by w takes ``-w^2 p . (t x (t x n)) / 2`` of the
    momenta about the spin, ``-m L^3 / 20`` at the tip and ``m L^3 / 30`` at the root, and turns the
    spin into bending, ``m L^3 / 105`` at a node and ``-m L^3 / 140`` between them.
    """
    found = limit_of(blade(frame, "b", torsion, length=units[0], mass=units[1]), (0, 0, 1))
    # rotary inertia of 1e-6
    assert found == pytest.approx(np.sqrt(square * torsion), rel=1e-4)


GROWS = [("converged_mean", "material", 0.1, True, "root"),
         ("converged_mean", "material", 1e3, True, "tip"),
         ("converged_mean", "frame_axes", 0.1, True, "tip"),
         ("converged_mean", "floating_field", 0.1, False, "root"),
         ("node", "material", 0.1, True, "root"), ("node", "material", 1e3, True, "tip"),
         ("node", "floating_field", 0.1, False, "tip"),
         ("converged_mean", "rigid_part", 0.01, True, "root"),
         ("node", "rigid_part", 0.01, True, "tip")]


@pytest.mark.parametrize(("frame", "inertia", "torsion", "stiffened", "held"), GROWS)
def test_motion_grows_from_the_limit_on(frame, inertia, torsion, stiffened, held):
    """Small motion about the turning equilibrium, by the kernels; it is stable below.

    Held at the node that gives the limit: frames on one node are softer seen from the other.
    """
    model = blade(frame, inertia, torsion, stiffened, held=held)
    limit = limit_of(model, (0, 0, 1))
    for part, grows in ((0.96, False), (1.04, True)):
        spin = TURN @ [0.0, 0.0, part * limit]
        # the stretch of the turning equilibrium, W^2 / 1e5, is not in the limit
        assert (modes(equilibrium(model, 2, spin=spin), spin).growth.max() > 1e-2) == grows


@pytest.mark.parametrize("frame", ["converged_mean", "node"])
def test_a_stiffened_body_has_the_limits_of_the_beam(frame):
    """Across: what stretches it, ``sqrt(3 E A / m L^2)``; about itself: its first frequency."""
    model = blade(frame, "c", 1e-3, modes=4)
    # the first axial shape alone, as it has no axial modes
    assert limit_of(model, (0, 0, 1)) == pytest.approx(np.sqrt(3e5), rel=1e-5)
    lowest = min(limit_of(model, (1, 0, 0)), first_frequency(model.bodies["blade"]))
    assert lowest == pytest.approx(3.516 if frame == "converged_mean" else 2.467, rel=1e-3)


def test_the_cautious_limit_is_below_all():
    """It decides whether a spin is looked at: of options, frames, soft and stiff torsion."""
    axes = np.vstack([np.eye(3), np.random.default_rng(4).normal(size=(3, 3))])
    for frame in ("converged_mean", "node"):
        for inertia, torsion in itertools.product("abcd", (1e-3, 0.1, 1e3)):
            if (frame, inertia) == ("node", "frame_axes"):
                continue
            model = blade(frame, inertia, torsion, stiffened=False)
            body = model.bodies["blade"]
            lowest = min(spin_limit(body, axis) for axis in axes)
            assert cautious_limit(body) <= first_frequency(body)
            assert cautious_limit(body) <= lowest
            assert spin_limit(body, None) <= lowest


def said(run):
    """Messages of limits of spin."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        run()
    return [str(w.message) for w in found if "spin" in str(w.message)]


def turning(axis, speed, **options):
    """An equilibrium of the blade, and small motion about it."""
    model, spin = blade(modes=4, **options), TURN @ np.array(axis) * speed
    result = []
    messages = said(lambda: result.append(equilibrium(model, 2, spin=spin)))
    return messages, said(lambda: modes(result[0], spin))


@pytest.mark.parametrize("frame", ["converged_mean", "node"])
def test_equilibria_and_small_motion_are_warned_of_the_limit(frame):
    """Torsion of option B; bending of plain C, which spins about itself without any limit."""
    limit = limit_of(blade(frame, torsion=0.01), (0, 0, 1))
    for messages in turning((0, 0, 1), 1.01 * limit, frame=frame, torsion=0.01):
        assert len(messages) == 1 and messages[0].startswith(
            f"spin {1.01 * limit:.3g} rad/s is above the limit {limit:.3g} of body 'blade'")
        assert messages[0].endswith("divide the body in two, or take inertia='floating_field'")
    plain = {"frame": frame, "inertia": "floating_field", "stiffened": False}
    limit = limit_of(blade(modes=4, **plain), (0, 0, 1))
    assert all(messages[0].endswith("divide the body in two, or give its FE model a geometric "
                                    "stiffness")
               for messages in turning((0, 0, 1), 1.01 * limit, **plain))
    assert turning((1, 0, 0), 2 * limit, **plain) == ([], [])
    assert turning((0, 0, 1), 6.0, frame=frame, inertia="floating_field", torsion=1e-3) == ([], [])


def test_a_free_blade_is_warned_of_while_it_is_straight():
    """The limit is that of theory, not of what has grown."""
    model = blade(torsion=0.01)
    model.nodes["root"].position.fixed = model.nodes["root"].rotation.fixed = False
    limit = limit_of(model, (0, 0, 1))
    model.rigid_velocity((0, 0, 0), 1.05 * limit * TURN[:, 2])
    messages = said(lambda: Simulation(model, 1e-3).run_to(1e-2))
    assert len(messages) == 1 and f"is above the limit {limit:.3g} of body 'blade'" in messages[0]


@pytest.mark.parametrize("option", [{"inertia": "material"}, {"inertia": "rigid_part"},
                                    {"inertia": "floating_field", "stiffened": False}])
def test_fast_spins_without_stiffening_are_warned_of(option):
    """At a quarter of the first frequency flapping is off by a per cent: Southwell's coefficient.

    ``omega^2 = omega_1^2 + 1.19334 W^2`` for small spins of a cantilever.
    """
    option = option | {"torsion": 1.0}      # stiff enough that bending comes first
    first = first_frequency(blade(**option, modes=4).bodies["blade"])
    assert first == pytest.approx(3.516, rel=1e-3)
    spin = TURN @ [0.0, 0.0, 0.25 * first]
    found = modes(equilibrium(blade(**option, modes=4), 2, spin=spin), spin).omega
    flap = np.sqrt(first**2 + 1.19334 * spin @ spin)
    assert 3e-3 < 1 - found[np.argmin(np.abs(found - flap))] / flap < 1.5e-2
    assert turning((0, 0, 1), 0.24 * first, **option) == ([], [])
    for messages in turning((0, 0, 1), 0.26 * first, **option):
        assert len(messages) == 1
        assert "'blade' spins at 0.914 rad/s, more than a quarter of 3.52, the body's first f" in (
            messages[0])
        assert "frequencies have errors of 1 % and more; divide the body in two" in messages[0]


def test_a_blade_with_soft_torsion_is_warned_of_before_it_diverges():
    """Growth begins at 0.28, a quarter of which counts."""
    for messages in turning((0, 0, 1), 0.08, torsion=1e-3):
        assert len(messages) == 1
        assert "more than a quarter of 0.283, where it diverges" in messages[0]


@pytest.mark.parametrize("option", [{"inertia": "material"}, {"inertia": "rigid_part"},
                                    {"inertia": "floating_field", "stiffening": False}])
def test_a_body_without_a_kept_rotation_is_warned_of(option):
    """Its spin is found from its corners, which fly, too; the part that stresses it counts."""
    body, axis = block(option).bodies["block"], TURNED[:, 2]
    limit, felt = spin_limit(body, axis), reach(body, axis)

    def messages(speed):
        return said(lambda: Simulation(block(option, (30.0, 4.0, -5.0), speed * axis),
                                       1e-6).run_to(1e-5))
    fast = FAST * min(limit, first_frequency(body)) / felt
    assert messages(0.98 * fast) == []
    text, = messages(1.02 * fast)
    assert text.startswith(f"body 'block' spins at {1.02 * fast:.3g} rad/s, more than a quarter of")
    speed = 1.02 * limit / felt
    text, = messages(speed)
    assert text.startswith(f"spin {speed:.3g} rad/s is above the limit {limit:.3g} of body 'block'")
    assert text.endswith("let it stiffen with stiffening=True"
                         if option["inertia"] == "floating_field" else
                         "take inertia='floating_field'")


def test_a_planar_beam_known_by_its_ends_is_warned_of():
    """Of pinned ends, in an oblique place; it flies, too."""
    body = craig_bampton(planar_beam((1.0, 2.0), (1.0 + 0.6 * LENGTH, 2.0 - 0.8 * LENGTH), SLENDER,
                                     8), [(0, "translation"), (8, "translation")], 2)
    model = Model(planar=True)
    ends = [model.node(f"n{k}", x, "translation") for k, x in enumerate(body.coordinates)]
    beam = model.superelement("beam", body, ends, frame="positions", inertia="material")
    speed = -1.01 * FAST * min(spin_limit(beam, None), first_frequency(beam))
    model.rigid_velocity((3.0, -1.0), speed)
    text, = said(lambda: Simulation(model, 1e-4).run_to(1e-3))
    assert text.startswith(f"body 'beam' spins at {-speed:.3g} rad/s, more than a quarter of")


def test_a_stiffened_body_without_a_kept_rotation_has_no_limit_to_be_warned_of():
    model = block({}, spin=1e3 * TURNED[:, 2])
    assert said(lambda: Simulation(model, 1e-6).run_to(1e-5)) == []


def test_a_warning_is_of_the_body_that_exceeds_its_limit_most():
    """And names the others, whatever their order; once for each kind."""
    watch = Watch()
    found = [Finding("spin", name, excess, f"{name} spins") for name, excess in (
        ("slow", 1.1), ("fast", 3.0), ("middle", 2.0))]
    with pytest.warns(LimitWarning) as caught:
        watch.say_of_bodies([*found, Finding("bent", "slow", 1.5, "slow bends")])
        watch.say_of_bodies(found)
    assert [str(one.message) for one in caught] == watch.messages == [
        "fast spins (also 2 other bodies: 'slow', 'middle')", "slow bends"]
