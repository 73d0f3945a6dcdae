"""A point inside an imported body touches: named by its label in the FE program."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from sebody import InputError, Model, plane, simulate


def test_a_node_of_an_imported_body_touches(beam_body):
    """It is where the field of the body has it; force and weight give the momentum."""
    recovery = beam_body.recovery
    axis = beam_body.coordinates[1] - beam_body.coordinates[0]
    length = np.linalg.norm(axis)
    middle = beam_body.coordinates.mean(axis=0)
    place = int(np.argmin(np.linalg.norm(recovery.points - middle, axis=1)))
    label = recovery.called(place)
    up = np.linalg.svd(axis[None])[2][1]
    model = Model()
    ends = [model.node(name, point) for name, point in zip(
        ("root", "tip"), beam_body.coordinates, strict=True)]
    model.superelement("beam", beam_body, ends)
    model.initial_velocity("root", -up * length)
    model.initial_velocity("tip", -up * length)
    stiffness = 1e3 * beam_body.total_mass / 1e-4 / np.sqrt(1e-3 * length)
    model.contact(f"beam.node{label}", on=plane(up, recovery.points[place] - 1e-3 * length * up),
                  stiffness=stiffness, restitution=0.8, at_speed=length, name="hit")
    result = simulate(model, 2e-5, 8e-3)
    push = result["hit.normal_force"]
    assert push.max() > 0 and push[0] == 0
    heights = result.field("beam").at(place if recovery.nodes is None else
                                      recovery.number(place)).position @ up
    gap = heights - recovery.points[place] @ up + 1e-3 * length
    np.testing.assert_allclose(result["hit.gap"], gap, atol=1e-7 * length)
    gained = (result["momentum"][-1] - result["momentum"][0]) @ up
    impulse = trapezoid(push, result["t"])
    assert gained == pytest.approx(impulse, rel=1e-3)
    missing = int(recovery.labels.max()) + 7
    with pytest.raises(InputError, match=f"has no FE node '{missing}'"):
        model.contact(f"beam.node{missing}", on=plane(up), stiffness=1.0)
