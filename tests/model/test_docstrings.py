"""Docstrings of what builds a model: parameters, and examples that run."""

import doctest
import inspect

import numpy as np
import pytest

from sebody import Model
from sebody.model import joints

PLACE = np.array([0.3, -0.2, 0.1])
BUILDERS = [name for name, one in vars(Model).items()
            if not name.startswith("_") and inspect.isfunction(one)
            and inspect.signature(one).return_annotation is not inspect.Signature.empty
            and one.__module__.startswith("sebody.model.") and len(
                inspect.signature(one).parameters) > 1]
JOINTS = [name for name, one in vars(joints).items()
          if inspect.isfunction(one) and one.__module__ == joints.__name__ and name != "fix"]


def made():
    """A model whose nodes have the names and places that examples use."""
    model = Model()
    for name, offset in (("hub", 0.0), ("arm", 0.0), ("cart", 0.7)):
        node = model.node(name, PLACE + np.array([offset, 0.0, 0.0]))
        model.rigid_body(f"body of {name}", node, 1.0, (1.0, 2.0, 2.5))
    return model


@pytest.mark.parametrize("name", BUILDERS)
def test_builders_name_their_parameters(name):
    text = inspect.getdoc(getattr(Model, name))
    assert "Parameters\n----------" in text
    listed = text.partition("Parameters\n----------\n")[2].partition("\n\n")[0]
    named = {one.strip(" *") for line in listed.splitlines() if not line.startswith(" ")
             for one in line.partition(" : ")[0].split(",")}
    missing = set(inspect.signature(getattr(Model, name)).parameters) - named - {
        "self", "model", "node", "name", "to", "placing"}
    assert not missing


@pytest.mark.parametrize("name", [*JOINTS, "force", "torque"])
def test_examples_of_joints_run(name):
    model = made()
    text = inspect.getdoc(getattr(Model, name))
    examples = doctest.DocTestParser().get_doctest(text, {"model": model}, name, None, None)
    assert examples.examples
    assert not doctest.DocTestRunner(verbose=False).run(examples).failed
    assert len(model.joints) == (name in JOINTS) and len(model.loads) == (name not in JOINTS)
