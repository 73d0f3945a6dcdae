"""What editors show of the methods of a model: signatures, by jedi where it is installed."""

import inspect

import pytest

from sebody import Model

BUILDERS = sorted(name for name, one in vars(Model).items() if hasattr(one, "__wrapped__"))


def test_every_builder_has_a_signature():
    """At run time that of the function without the model, which is bound."""
    assert {"node", "revolute", "contact", "beam"} <= set(BUILDERS) and len(BUILDERS) > 35
    for name in BUILDERS:
        own = list(inspect.signature(getattr(Model(), name)).parameters)
        assert own and own[0] != "model" and Model.__dict__[name].__doc__


def test_editors_show_signatures():
    """As a user types: `model.NAME(`."""
    jedi = pytest.importorskip("jedi")
    begun = "from sebody import Model\nmodel = Model()\n"
    for name in BUILDERS:
        line = f"model.{name}("
        shown = jedi.Script(begun + line).get_signatures(3, len(line))
        assert len(shown) == 1, name
        own = [one.name for one in inspect.signature(getattr(Model(), name)).parameters.values()
               if one.kind != one.VAR_KEYWORD]      # in place of it jedi may show what it takes
        assert [one.name for one in shown[0].params][:len(own)] == own, name
