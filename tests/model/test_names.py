"""Names of joints, loads and drives: given ones, default ones, and what they find."""

import numpy as np
import pytest

from sebody import InputError, Model, plane, simulate
from sebody.control import pid
from sebody.model.parts import Element, Joint

RAMP = [(0.0, 0.0), (1.0, 0.3)]
TABLE = [(0.0, 0.0), (0.1, 2.0)]


def two_bodies(planar=False):
    """Two bodies: nodes a and c at one point, b on the first body and d on the second."""
    model = Model(planar=planar)
    d = 2 if planar else 3
    inertia = 0.3 if planar else (0.2, 0.3, 0.4)
    for name, point in (("a", (0.0, 0, 0)), ("b", (1.0, 0.2, 0)), ("c", (0.0, 0, 0)),
                        ("d", (0.0, 2.0, 0))):
        model.node(name, point[:d])
    for name in ("a", "b", "c", "d"):
        model.rigid_body(f"body {name}", name, 1.0, inertia)
    return model


X, Z = (1.0, 0, 0), (0.0, 0, 1)
SPATIAL = {     # every joint, load and drive of space that takes a name
    "revolute": lambda m, **n: m.revolute("a", Z, to="c", **n),
    "universal": lambda m, **n: m.universal("a", X, Z, to="c", **n),
    "cylindrical": lambda m, **n: m.cylindrical("a", Z, to="c", **n),
    "prismatic": lambda m, **n: m.prismatic("a", Z, to="c", **n),
    "slider": lambda m, **n: m.slider("a", X, **n),
    "planar joint": lambda m, **n: m.planar_joint("a", Z, to="c", **n),
    "spherical": lambda m, **n: m.spherical("a", to="c", **n),
    "weld": lambda m, **n: m.weld("a", to="c", **n),
    "distance": lambda m, **n: m.distance("a", "b", **n),
    "angle": lambda m, **n: m.drive_angle("a", RAMP, Z, **n),
    "slide": lambda m, **n: m.drive_slide("a", RAMP, X, to="c", **n),
    "motion": lambda m, **n: m.move("a", X, RAMP, **n),
    "force": lambda m, **n: m.force("b", X, TABLE, **n),
    "torque": lambda m, **n: m.torque("b", X, TABLE, **n),
    "spring": lambda m, **n: m.spring("a", "b", 3.0, **n),
    "torsion spring": lambda m, **n: m.torsion_spring("a", 3.0, **n),
    "bushing": lambda m, **n: m.bushing("a", "c", 3.0, **n)}


@pytest.mark.parametrize("kind", SPATIAL)
def test_every_builder_takes_a_name(kind):
    """What it returns is what the model finds, by its own name or by that of kind and node."""
    own, default = two_bodies(), two_bodies()
    made = SPATIAL[kind](own, name="mine")
    assert own.element("mine") is made and made.name == "mine"
    made = SPATIAL[kind](default)
    assert made.name.startswith(kind) and default.element(made.name) is made


@pytest.mark.parametrize("kind", SPATIAL)
def test_names_are_taken_once(kind):
    model = two_bodies()
    SPATIAL["distance"](model, name="mine")
    with pytest.raises(InputError, match=f"{kind}.* cannot be called 'mine': a joint has that "
                                         "name; give it its own with name="):
        SPATIAL[kind](model, name="mine")
    with pytest.raises(InputError, match="cannot be called 'body a': a rigid body has that name"):
        SPATIAL[kind](model, name="body a")


@pytest.mark.parametrize("name", ["", 3])
def test_names_are_text(name):
    with pytest.raises(InputError, match=f"name of the torque on b.rotation is {name!r}: give a "
                                         "text that is not empty"):
        two_bodies().torque("b", X, name=name)


def test_bodies_take_no_name_of_a_joint():
    model = two_bodies()
    model.distance("a", "b", name="rod")
    with pytest.raises(InputError, match="body 'rod' cannot be called 'rod': a joint has that"):
        model.point_mass("rod", "a", 1.0)
    with pytest.raises(InputError, match="body 'body a' exists already: give it its own name"):
        model.point_mass("body a", "a", 1.0)


@pytest.mark.parametrize("kind", ["force", "torque", "spring", "torsion spring", "bushing"])
def test_loads_take_no_name_of_a_node(kind):
    """In either order: ``c.moment`` would be that of the load."""
    model = two_bodies()
    with pytest.raises(InputError, match="cannot be called 'c': a node has that name; give it its"):
        SPATIAL[kind](model, name="c")
    SPATIAL[kind](model, name="e")
    with pytest.raises(InputError, match=f"a node cannot be called 'e': a {kind} has that name"):
        model.node("e", (5.0, 0, 0))


def test_actuators_contacts_and_sensors_share_one_space_of_names():
    model = two_bodies()
    model.spherical("a", to="c", name="ball")
    floor = {"on": plane((0.0, 0, 1), (0.0, 0, -9)), "stiffness": 1e4}
    for build in (lambda name: model.actuator(name, node="b", direction=X),
                  lambda name: model.contact("b", name=name, **floor),
                  lambda name: model.stop(("b", "d"), upper=9.0, stiffness=1.0, name=name),
                  lambda name: model.friction("ball", 0.1, radius=0.1, name=name),
                  lambda name: model.user_force(name, ["b"], lambda t, x, v, force: None),
                  lambda name: model.sensor(name, "b.position.x")):
        for taken, holder in (("d", "node"), ("ball", "joint"), ("push", "force")):
            model.loads[:] = [one for one in model.loads if one.name != "push"]
            model.own_names.discard("push")
            model.force("b", X, name="push")
            with pytest.raises(InputError, match=f"cannot be called '{taken}': a {holder} has"):
                build(taken)


def test_an_actuator_takes_the_name_of_the_signal_that_sets_it():
    """And nothing else does."""
    model = two_bodies()
    model.controller("law", pid(1.0), ["b.position.x"], ["motor"], 0.1)
    with pytest.raises(InputError, match="cannot be called 'motor': a signal has that name"):
        model.force("b", X, name="motor")
    with pytest.raises(InputError, match="a node cannot be called 'motor': a signal has that"):
        model.node("motor", (5.0, 0, 0))
    assert model.actuator("motor", node="b", direction=X) is model.element("motor")


def test_bodies_and_joints_may_have_the_name_of_a_node():
    """No quantity is one of both."""
    model = two_bodies()
    model.point_mass("d", "d", 1.0)
    assert model.revolute("a", Z, to="c", name="a") is model.element("a")


def test_a_default_name_may_be_given_to_nothing_else():
    model = two_bodies()
    model.distance("a", "b", name="force on b.position")
    with pytest.raises(InputError, match="force on b.position cannot be called 'force on "
                                         "b.position': a joint has that name; give it its own"):
        model.force("b", X)
    assert model.force("b", X, name="push") is model.element("push")


def test_default_names_are_numbered():
    """Two springs between the same nodes, two hinges on one: each is found, none is a guess."""
    model = two_bodies()
    first, second = model.spring("a", "b", 3.0), model.spring("a", "b", 4.0)
    assert (first.name, second.name) == ("spring at a", "spring at a (2)")
    assert model.element("spring at a (2)") is second
    model.distance("a", "b", name="revolute at a (2)")
    names = [model.revolute("a", Z, to=n).name for n in ("c", "c", "c")]
    assert names == ["revolute at a", "revolute at a (3)", "revolute at a (4)"]


@pytest.mark.parametrize("name, message", [
    ("bodya", "element 'bodya' is unknown: did you mean 'body a'"),
    ("mtor", "element 'mtor' is unknown: did you mean 'motor'"),
    ("zzz", "element 'zzz' is unknown: the model has 'body a', .*'motor'"),
    (None, "element None is unknown: the model has")])
def test_unknown_names(name, message):
    model = two_bodies()
    model.torque("b", X, name="motor")
    with pytest.raises(InputError, match=message):
        model.element(name)
    with pytest.raises(InputError, match="element 'x' is unknown: the model has none"):
        Model().element("x")


def test_kinds_of_elements():
    model = two_bodies()
    assert isinstance(model.revolute("a", Z), Joint)
    assert isinstance(model.force("b", X), Element)
    assert isinstance(model.element("body a"), Element)


def test_multipliers_by_a_joints_own_name():
    """What a name changes is the name; a prismatic joint of three constraints has all five."""
    results = []
    for hinge, guide, motor in ((None, None, None), ("hinge", "guide", "motor")):
        model = two_bodies()
        model.gravity((1.0, -2.0, 3.0))
        model.revolute("a", Z, name=hinge)
        model.prismatic("c", (0, 1.0, 0), to="d", name=guide)
        model.fix("d")
        model.torque("a", (0.1, 0.2, 0.3), name=motor)
        results.append(simulate(model, 1e-3, 0.05))
    plain, named = results
    for default, own, size in (("revolute at a", "hinge", 2), ("prismatic at c", "guide", 5)):
        values = named[f"{own}.multipliers"]
        assert values.shape == (51, size) and np.abs(values).max() > 0
        assert (values == plain[f"{default}.multipliers"]).all()
    assert named["motor.work"][-1] > 0
    assert (named["motor.work"] == plain["torque on a.rotation.work"]).all()
    with pytest.raises(InputError, match="'revolute at a.multipliers' is unknown"):
        named["revolute at a.multipliers"]


def test_joints_without_equations():
    """They are found, have no multipliers, and say so."""
    model = two_bodies(planar=True)
    joint = model.revolute("a", to="c", name="pin")
    assert model.element("pin") is joint and joint.multipliers == 0 and not joint.constraints
    model.fix("b")
    model.fix("d")
    with pytest.raises(InputError, match="joint 'pin' has no equations and so no multipliers, "
                                         "since its nodes share coordinates or are fixed; the "
                                         "force on a fixed node is its reaction"):
        simulate(model, 1e-2, 0.02)["pin.multipliers"]


def test_work_of_a_named_motion():
    """A body of mass 2 is pushed to a velocity of 0.3: that takes 0.09."""
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (0.0, 0.0), keeps="translation"), 2.0)
    model.point_mass("other", model.node("other", (0.0, 1.0), keeps="translation"), 1.0)
    motion = (lambda t: 0.15 * t * t, lambda t: 0.3 * t, lambda t: 0.3 + 0.0 * t)
    assert model.move("ball", (1.0, 0.0), motion, name="pusher") is model.element("pusher")
    assert simulate(model, 1e-3, 1.0)["pusher.work"][-1] == pytest.approx(0.09, rel=1e-3)
