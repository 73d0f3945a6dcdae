"""Builders of a model refuse wrong arguments in words, and change nothing then."""

import pytest
from malformed import contact_cases, model_cases, path_cases, rope_cases
from malformed.cases import alike, listed

from sebody import InputError, Model

SPATIAL = (model_cases.BODIES | model_cases.JOINTS | model_cases.LOADS
           | model_cases.CONTROL | contact_cases.CASES)
MODELS = {**dict.fromkeys(SPATIAL, model_cases.spatial),
          **dict.fromkeys(path_cases.CASES, path_cases.railway),
          **dict.fromkeys(rope_cases.CASES, rope_cases.hoist)}


def described(model: Model) -> list:
    """All that a builder may change."""
    parts = [sorted(model.own_names), dict(model.default_names), model.gravity_field]
    parts += [[one.name for one in group] for group in (
        model.nodes.values(), model.bodies.values(), model.rigid_bodies.values(), model.joints,
        model.loads, model.grounds, model.sensors.values(),
        model.controllers.values(), model.paths.values(), model.sheaves.values(),
        model.ropes.values())]
    parts.append([id(one) for one in model.connections])
    for dof_block in model.dof_blocks():
        parts.append([dof_block.name, dof_block.fixed, dof_block.given, id(dof_block.root),
                      dof_block.rate,
                      len(dof_block.arms), [motion.name for motion in dof_block.motions]])
    return parts


def refuse(model, right, argument, value, said):
    before = described(model)
    with pytest.raises(InputError) as caught:
        right.function(model, **{**right.arguments, argument: value})
    assert said in str(caught.value)
    assert alike(described(model), before), "the refused call has changed the model"


@pytest.mark.parametrize("right, argument, value, said", listed(SPATIAL))
def test_in_space(right, argument, value, said):
    refuse(model_cases.spatial(), right, argument, value, said)


@pytest.mark.parametrize("right, argument, value, said", listed(model_cases.FLAT))
def test_in_a_plane(right, argument, value, said):
    refuse(model_cases.planar(), right, argument, value, said)


@pytest.mark.parametrize("right, argument, value, said", listed(path_cases.CASES))
def test_paths(right, argument, value, said):
    refuse(path_cases.railway(), right, argument, value, said)


@pytest.mark.parametrize("right, argument, value, said", listed(rope_cases.CASES))
def test_ropes(right, argument, value, said):
    refuse(rope_cases.hoist(), right, argument, value, said)


@pytest.mark.parametrize("name", MODELS)
def test_the_corrected_call_is_accepted(name):
    """In a notebook, say: after all refused ones, on the same model."""
    right, model = (SPATIAL | path_cases.CASES | rope_cases.CASES)[name], MODELS[name]()
    for argument, wrong in right.wrong.items():
        for value, _ in wrong:
            with pytest.raises(InputError):
                right.function(model, **{**right.arguments, argument: value})
    right.function(model, **right.arguments)
