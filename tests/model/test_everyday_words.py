"""Words of other programs and of daily use in the arguments of builders: taken, or set right."""

import numpy as np
import pytest

from sebody import InputError, LimitWarning, Model, simulate
from sebody.fem import Section, circle, i_profile, rectangle, tube

PLACE = (0.3, -0.2, 0.5)


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
