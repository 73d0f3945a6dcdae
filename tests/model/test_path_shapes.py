"""Cautions about bodies whose internal modes do not bend a path."""

import numpy as np
import pytest
from model.test_path_numbers import structure
from model.test_paths import TURN, arm
from model.test_ways import swinging

from sebody import Model
from sebody.model.path_shapes import bending, cautions
from sebody.reduction import PathLoads, craig_bampton


def crane(modes, loads=(), gravity=(0.0, 0.0, -9.81)):
    """Two girders, of which the first vibrations are lateral: off by 27 % with 4 of them."""
    fe, girders = structure()
    body = craig_bampton(fe, [(corner, "full") for corner in range(4)], modes, paths={
        "rail": PathLoads(girders[0], *loads)} if loads else None)
    model = Model()
    corners = [model.node(f"corner {k}", point) for k, point in enumerate(body.coordinates)]
    model.superelement("crane", body, corners, stiffening=False)
    model.gravity(gravity)
    model.path("rail", on="crane", nodes=corners[:2])
    return model


@pytest.mark.parametrize("modes, loads, count", [
    (0, (), 0), (4, (), 0), (8, (), 1), (12, (), 2), (0, (3,), 3), (4, (3, "z"), 3)])
def test_the_trap_of_a_crane_is_told(modes, loads, count):
    """Against the errors of these reductions: 0.27, 0.27, 9e-3 (under the wheel 4e-2), the rest
    1.1e-2 and less under the wheel."""
    model = crane(modes, loads)
    assert bending(model.paths["rail"].pieces[0], np.array([0.0, 0.0, -1.0])) == count
    said = [line for line in model.summary().splitlines() if line.startswith("caution")]
    assert len(said) == (count < 2)
    if said:
        words = "1 internal mode" if count else "no internal mode"
        assert f"path 'rail': {words} of 'crane' bends it in the direction of gravity" in said[0]
        assert "reduce the body with paths=" in said[0]


def test_without_gravity_and_with_gravity_along_the_path():
    """Any direction across the path counts then."""
    for gravity in ((0.0, 0.0, 0.0), (9.81, 0.0, 0.0)):
        four, none = crane(4, (), gravity), crane(0, (), gravity)
        assert not cautions(four, four.paths["rail"])
        assert "bends it, so" in cautions(none, none.paths["rail"])[0]


def test_in_general_position_and_of_several_bodies():
    """As many modes of a turned beam in space as of one in the plane; in other units; in pieces."""
    flat, space = swinging(modes=8), swinging(flat=False, turned=TURN, modes=12)
    for model in (flat, space):
        down = model.gravity_field / np.linalg.norm(model.gravity_field)
        assert bending(model.paths["rail"].pieces[0], down) == 8
    small, large = (arm(modes=3, flat=False, scale=scale) for scale in (1.0, 1e3))
    counts = [bending(model.paths["rail"].pieces[0], None) for model in (small, large)]
    assert counts == [3, 3]
    for bodies, modes, told in ((1, 0, 1), (1, 1, 1), (2, 0, 2), (4, 0, 0), (2, 2, 0)):
        model = swinging(bodies=bodies, modes=modes)
        assert len(cautions(model, model.paths["rail"])) == told
