"""Equilibria on contacts and by friction: what is unstable is said, what is not found is named."""

import numpy as np
import pytest

from sebody import LimitWarning, Model, SimulationError, plane
from sebody.analysis import equilibrium

HALF, WEIGHT, STIFF = 0.2, 2.0 * 9.81, 1e5


def box(tilt, friction=0.0, sunk=1e-3):
    """A square in its plane whose corners touch a floor, turned against it and sunk a little."""
    turn = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
    corners = HALF * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) @ turn.T
    place = np.array([0.7, -corners[:, 1].min() - sunk])
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    centre = model.node("centre", place)
    model.rigid_body("box", centre, 2.0, 0.1)
    for k, corner in enumerate(corners):
        model.contact(model.attach(f"corner {k}", place + corner, centre), on=plane((0.0, 1.0)),
                      stiffness=STIFF, friction=friction, name=f"touch {k}")
    return model


def sunk(corners):
    """Depth of each of some corners that bear the weight together."""
    return (WEIGHT / corners / STIFF)**(2.0 / 3.0)


def test_a_body_on_edge_falls_on_a_face():
    found = equilibrium(box(np.pi / 4))
    assert found.stability.startswith("stable; left an unstable state at 0.0")
    assert "moved far" not in found.stability
    assert found["centre.position"][-1, 1] == pytest.approx(HALF - sunk(2), rel=1e-8)


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_body_kept_on_edge_is_said_to_be_unstable(friction):
    with pytest.warns(LimitWarning, match="the equilibrium is unstable .*: a disturbance lets it"):
        found = equilibrium(box(np.pi / 4, friction), unstable="keep")
    assert found.stability.startswith("unstable")
    assert found["centre.position"][-1, 1] == pytest.approx(
        HALF * np.sqrt(2.0) - sunk(1), rel=1e-8)


def test_a_body_that_does_not_touch_yet_is_refused_by_the_contact():
    """It would tip over a corner that friction holds."""
    with pytest.raises(SimulationError, match="contact 'touch 0' is open: begin where contacts "
                                              "press, or run the model with damping"):
        equilibrium(box(0.2, 0.5, 0.0), 1)


def linkage(preload=0.0):
    """Three links on hinges with friction, before a spring."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    last = {}
    for k, (coefficient, radius) in enumerate([(0.22, 0.73), (0.39, 0.13), (0.32, 0.46)]):
        node = model.node(f"a{k}", (float(k), 0.0))
        model.rigid_body(f"link {k}", node, 1.0, 0.1, centre=(k + 0.5, 0.0))
        model.revolute(node, name=f"hinge {k}", **last)
        model.friction(f"hinge {k}", coefficient, radius=radius, preload=preload, name=f"dry {k}")
        last = {"to": model.attach(f"end {k}", (k + 1.0, 0.0), node)}
    wall = model.node("wall", (3.0, 2.0), keeps="translation")
    model.fix(wall, "position")
    model.spring(last["to"], wall, 3.0, length=1.5)
    model.torque("a0", 2.3)
    return model


def test_friction_that_is_not_found_is_refused_by_name():
    """The pressure of hinges follows from what their friction holds."""
    with pytest.raises(SimulationError, match=r"'dry \d' (sticks|slides).* depends on the motion "
                                              "before: run the model with damping"):
        equilibrium(linkage(), 1)


def test_friction_that_holds_is_found():
    found = equilibrium(linkage(2e4))
    turned = [found[f"a{k}.rotation"][-1] for k in range(3)]
    assert np.abs(turned).max() < 1e-4
