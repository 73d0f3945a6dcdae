"""Words of other programs and of daily use in the arguments of builders: taken, or set right."""

import copy
import pickle
import warnings

import numpy as np
import pytest

from sebody import InputError, LimitWarning, Model, simulate
from sebody.fem import Section, circle, i_profile, rectangle, straight_beam, tube
from sebody.reduction import craig_bampton

PLACE = (0.3, -0.2, 0.5)
STEEL = 2.1e11, 0.3, 7850.0


def block(planar=False, place=PLACE):
    model = Model(planar=planar)
    n = model.dimension
    model.node("a", place[:n])
    model.node("b", tuple(np.add(place, (1.0, 0.5, 0.2)))[:n])
    model.rigid_body("block", "a", 1.0, 0.4 if planar else (1.0, 2.0, 2.5))
    return model


@pytest.mark.parametrize("build", [
    lambda m, to: m.revolute("a", (1, 2, 0), to=to),
    lambda m, to: m.revolute("a", (1, 2, 0), to=to, explicit=True),
    lambda m, to: m.universal("a", (1, 0, 0), (0, 1, 0), to=to),
    lambda m, to: m.cylindrical("a", (1, 2, 0), to=to),
    lambda m, to: m.slider("a", (1, 2, 0), to=to),
    lambda m, to: m.spherical("a", to=to), lambda m, to: m.spherical("a", to=to, explicit=False),
    lambda m, to: m.weld("a", to=to), lambda m, to: m.weld("a", to=to, explicit=True),
    lambda m, to: m.torsion_spring("a", 5.0, axis=(1, 2, 0), to=to),
    lambda m, to: m.bushing("a", to=to, stiffness=(1.0, 2.0, 3.0))])
def test_the_ground_has_a_name(build):
    """The same elements and fixed DOF blocks as without `to`."""
    made = []
    for to in ("ground", None):
        model = block()
        build(model, to)
        made.append([(one.kind, one.name, {key: np.asarray(value).tolist() for key, value in
                                           one.constants.items()}) for one in
                     (*model.constraints, *model.loads)]
                    + [node.position.fixed for node in model.nodes.values()])
    assert made[0] == made[1]


def test_a_node_may_be_called_ground():
    model = block()
    model.node("ground", PLACE)
    assert model.revolute("a", to="ground").to is model.nodes["ground"]


@pytest.mark.parametrize("name, axis", [("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z", (0, 0, 1)),
                                        ("-y", (0, -1, 0))])
def test_axes_have_names(name, axis):
    assert block().revolute("a", axis=name).axis.tolist() == list(axis)
    assert block().prismatic("a", name).axis.tolist() == list(axis)
    model = block()
    assert np.cross(*(model.torsion_spring("a", 1.0, axis=name).vector(v) for v in "nm")
                    ).tolist() == list(axis)


def test_axes_of_planar_models_have_names():
    model = block(planar=True)
    model.revolute("a", axis="z")
    assert block(planar=True).prismatic("a", "y").axis.tolist() == [0, 1]
    for model, kind, given, remedy in (
            (block(planar=True), "prismatic", "z", "2 finite numbers, or x or y"),
            (block(), "revolute", "w", "3 finite numbers, or x or y or z")):
        said = f"axis of the {kind} joint at 'a' is '{given}': give {remedy}"
        with pytest.raises(InputError, match=said):
            getattr(model, kind)("a", given)


def test_translation_and_position_are_one_word():
    model = block()
    model.fix("a", "translation")
    assert model.nodes["a"].position.fixed and not model.nodes["a"].rotation.fixed
    assert model.node("c", PLACE, keeps="position").rotation is None


def test_a_weld_at_a_distance_says_what_holds_it():
    with pytest.raises(InputError, match="weld: nodes 'a' and 'b' do not coincide: give both the "
                                         r"same point, or hold what is apart by attach, or rigid"):
        block().weld("a", to="b")


@pytest.mark.parametrize("make, names", [
    (lambda **m: rectangle(1.0, 2.0, **m), "rectangle"), (lambda **m: circle(1.0, **m), "circle"),
    (lambda **m: tube(1.0, 0.1, **m), "tube"),
    (lambda **m: i_profile(1.0, 1.0, 0.1, 0.1, **m), "i_profile"),
    (lambda **m: Section(1.0, 1.0, 1.0, 1.0, **m), "Section")])
def test_symbols_of_materials_are_set_right(make, names):
    with pytest.raises(InputError, match=f"{names} has no E=, nu=, rho=: give youngs_modulus, "
                                         "poisson_ratio, density"):
        make(E=2e11, nu=0.3, rho=7800.0)
    with pytest.raises(InputError, match="has no G=: give youngs_modulus and poisson_ratio, of "):
        make(youngs_modulus=2e11, G=8e10, density=7800.0)
    assert make(youngs_modulus=2e11, poisson_ratio=0.3, density=7800.0).density == 7800.0


def test_limits_in_degrees_are_warned_of():
    model = block()
    model.revolute("a", "x", name="hinge")
    with pytest.warns(LimitWarning, match="stop of 'hinge': lower is -90, which is 14.3 turns: "
                                          "angles are in radians, -90 degrees are -1.5708"):
        model.stop("hinge", lower=-90.0, upper=0.5, stiffness=10.0)


def test_a_result_says_what_is_meant():
    model = block()
    model.fix("b")
    result = simulate(model, 0.01, 0.02)
    for name, use in (("time", "result.t"), ("plot", r"sebody.results.plot\(result, "),
                      ("at", r"result\[")):
        with pytest.raises(AttributeError, match=f"'Result' object has no attribute '{name}': use "
                                                 f"{use}"):
            getattr(result, name)
    nothing = "nothing"
    with pytest.raises(AttributeError, match="has no attribute 'nothing'$"):
        getattr(result, nothing)


@pytest.mark.parametrize("name, words", [
    ("hinge", "that is revolute"), ("ball", "that is spherical"), ("motor", "that is actuator"),
    ("damper", "spring with damping="), ("revolut", "did you mean revolute"), ("qqq", "no 'qqq'")])
def test_a_model_says_what_other_programs_names_are_here(name, words):
    """Also copies and pickles of models, which ask for names that none has."""
    with pytest.raises(AttributeError, match=words):
        getattr(Model(), name)
    assert not hasattr(copy.deepcopy(pickle.loads(pickle.dumps(Model()))), name)


@pytest.mark.parametrize("planar", [False, True])
def test_forces_act_along_named_axes(planar):
    """As along vectors; a planar torque is a number."""
    model, n = block(planar), 2 if planar else 3
    assert np.array_equal(model.force("a", "-y").constants["d"], -np.eye(n)[1])
    if not planar:
        assert np.array_equal(model.torque("a", "z").constants["d"], (0.0, 0.0, 1.0))
    with pytest.raises(InputError, match="x or y.*, with a minus or not"):
        model.force("a", "up")


def test_what_looks_like_another_number_is_warned_of():
    """The inner radius of a tube for its wall; degrees for a rest; solid rods are no tubes."""
    with pytest.warns(LimitWarning, match="leaves a hole of radius 0.003"):
        tube(0.03, 0.027, *STEEL)
    model = block()
    model.revolute("a", "z", name="hinge")
    with pytest.warns(LimitWarning, match="rest is 30, .* 30 degrees are 0.523599"):
        model.torsion_spring("hinge", 10.0, rest=30.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tube(0.03, 0.03, *STEEL)
        tube(0.03, 0.02, *STEEL)
        model.torsion_spring("hinge", 10.0, rest=-3.1)


def test_a_joint_between_fixed_nodes_is_told():
    """Not where one of the nodes is free."""
    def said(fix):
        model = block()
        model.rigid_body("other", "b", 1.0, (1.0, 1.0, 1.0))
        model.revolute("a", "z", name="hinge", explicit=True)
        fix(model)
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always")
            simulate(model, 0.01, 0.01)
        return [str(one.message) for one in seen if "cannot move" in str(one.message)]

    assert said(lambda model: None) == []
    assert said(lambda model: model.fix("b", "rotation")) == []
    message, = said(lambda model: model.fix("a"))
    assert message.startswith("joint 'hinge' cannot move: its nodes are fixed")


def test_nodes_in_another_order_are_put_right():
    """The message has the order that fits, which does; other places are those of before."""
    model = Model()
    first, last = model.node("first", (1.0, 2.0, 0.5)), model.node("last", (3.0, 2.0, 0.5))
    beam = craig_bampton(straight_beam((0, 0, 0), (2, 0, 0), circle(0.1, *STEEL), 4),
                         [(0, "full"), (4, "full")], 1)
    with pytest.raises(InputError, match="give them in the order first, last"):
        model.superelement("bar", beam, (last, first))
    model.superelement("bar", beam, (first, last))


def test_other_joints_name_their_ways_otherwise():
    """A rate asked of what slides, and a speed of what turns."""
    model = block()
    model.rigid_body("other", "b", 1.0, (1.0, 1.0, 1.0))
    model.revolute("a", "z", name="turns")
    model.prismatic("b", axis="x", name="slides")
    result = simulate(model, 0.01, 0.01)
    for asked, own in (("turns.speed", "turns.rate"), ("turns.displacement", "turns.angle"),
                       ("slides.rate", "slides.speed"), ("slides.angle", "slides.displacement")):
        with pytest.raises(InputError, match=f"ask for {own}"):
            result[asked]
        assert result[own].shape == (2,)


@pytest.mark.parametrize("call, message", [
    (lambda m: simulate(m, dt=0.01, t_end=1.0), "simulate has no dt=: its arguments are model, h,"),
    (lambda m: m.spring("a", "b", k=3.0, c=1.0), "spring has no k=, c=: its arguments are node, "),
    (lambda m: rectangle(b=1.0, h=2.0), "rectangle has no b=, h=: its arguments are height")])
def test_arguments_by_other_names_are_told(call, message):
    """The model is left as it was; what misses an argument is told by Python's own words."""
    model = block()
    with pytest.raises(TypeError, match=message):
        call(model)
    assert not model.loads
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'inertia'"):
        model.rigid_body("other", "b", 1.0)
