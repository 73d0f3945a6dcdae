"""Every builder of a model has malformed cases, and every joint is known wherever kinds are told.

A new joint passes the rest of the suite without them, so its tests could be forgotten.
"""

import inspect
import re
from pathlib import Path

import pytest
from malformed import contact_cases, model_cases, path_cases, rope_cases

import sebody.generated
from sebody import Model
from sebody.model.variants.flat_contacts import LAWS
from sebody.model.variants.flat_elements import ELEMENTS, EQUATIONS
from sebody.pictures import glyphs
from sebody.pictures.templates import filled

SPATIAL = (model_cases.BODIES | model_cases.JOINTS | model_cases.LOADS
           | model_cases.CONTROL | contact_cases.CASES)
BUILDERS = [name for name, value in vars(Model).items()
            if inspect.isfunction(value) and not name.startswith("_") and name != "summary"]
# refused by `planar(model)` by name: their planar kernels exist, the way from space is not written
WITHOUT = {f"{way}_{part}" for way in ("line", "slide", "turn") for part in ("motor", "rotor")}
# on coordinates of a body, see variants/planar.py
OF_BODIES = ("body_load_", "body_contact_", "body_path_", "path_turn_", "path_across_",
             "path_load_", "mode_force", "friction_way", "way_")


def variants(right):
    """A right call, and others by equations or to the ground, where there is a choice."""
    parameters = inspect.signature(right.function).parameters
    choices = [{}]
    if "explicit" in parameters:
        choices.append({"explicit": True})
    one_end = "to" in parameters and parameters["to"].default is None
    if one_end and right.function is not Model.spring:      # which is along a path then
        choices += [{**choice, "to": None} for choice in choices]
    yield from ({**right.arguments, **choice} for choice in choices)


def joints():
    """All joints that the right calls build, with the models they are in."""
    for make, cases in ((model_cases.spatial, SPATIAL), (model_cases.planar, model_cases.FLAT),
                        (path_cases.railway, path_cases.CASES),
                        (rope_cases.hoist, rope_cases.CASES)):
        for right in cases.values():
            for arguments in variants(right):
                model = make()
                right.function(model, **arguments)
                yield from ((model, joint) for joint in model.joints)


@pytest.mark.parametrize("name", BUILDERS)
def test_every_builder_has_malformed_cases(name):
    cases = [right for right in (SPATIAL | model_cases.FLAT | path_cases.CASES
                                | rope_cases.CASES).values()
             if inspect.unwrap(right.function) is inspect.unwrap(getattr(Model, name))]
    assert cases, (f"Model.{name} has no malformed cases: add them to "
                   "tests/malformed/model_cases.py")
    assert all(case.wrong for case in cases)


def constraints_and_others():
    """Kinds of the spatial elements that are shipped: equations of joints, and all others."""
    kinds: dict[bool, set[str]] = {True: set(), False: set()}
    for path in Path(sebody.generated.__file__).parent.glob("element_*.py"):
        kind = path.stem.removeprefix("element_")
        count = int(re.search(r"^MULTIPLIERS = (\d+)", path.read_text(), re.MULTILINE)[1])
        if not kind.startswith(("planar_", *OF_BODIES)):
            kinds[count > 0].add(kind)
    return kinds[True], kinds[False]


def test_every_element_has_a_planar_form():
    equations, others = constraints_and_others()
    assert len(equations) > 8 and len(others) > 8
    unknown = (equations - EQUATIONS.keys()) | (others - ELEMENTS.keys() - LAWS.keys()) - WITHOUT
    assert not unknown, (f"{sorted(unknown)} have no planar form: add them to EQUATIONS or "
                         "ELEMENTS in sebody/model/variants/flat_elements.py")


def test_every_equation_is_built_by_a_case():
    """So the pictures of all joints are looked at below."""
    built = {equation.kind for model, joint in joints() for equation in joint.constraints
             if not model.planar and not equation.kind.startswith(OF_BODIES)}
    assert built == constraints_and_others()[0]


def test_every_joint_is_drawn():
    """By a sign that the page has a shape for, or by lines between its nodes."""
    text = filled("shapes.js", {})
    shapes = set(re.findall(r"^  (\w+): \[\[", text[text.index("const SIGNS"):], re.MULTILINE))
    assert {"revolute", "ground"} <= shapes
    for model, joint in joints():
        nodes = {node.name for node in (*model.nodes.values(), *model.grounds)}
        kinds = {sign.kind for sign in glyphs.signs(model, nodes) if sign.name == joint.name}
        ends = {link.ends for link in glyphs.links(model, nodes, {"beam"})}
        assert kinds or any(joint.node.name in pair for pair in ends), (
            f"pictures show nothing of joint {joint.kind!r}: give it axes, or a link in "
            "sebody/pictures/glyphs.py")
        assert kinds <= shapes, (f"the page has no shape for {joint.kind!r}: add one to SIGNS in "
                                 "sebody/pictures/page/shapes.js")
