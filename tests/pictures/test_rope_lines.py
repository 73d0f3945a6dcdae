"""Ropes in pictures: along their tangents and around sheaves, which turn and move."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.pictures.palette import ROPE, SLACK, rgb
from sebody.pictures.scene import scenery
from sebody.results import animate

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
AT = np.array([2.0, -1.0, 0.5])
SEEN = 1e-7         # angles are kept from the iteration before the last one


def hauled(flat):
    """A drum that turns, a sheave with inertia, a ring, a sheave on a body that swings, a weight.

    The rope begins on the drum and is slack at first.
    """
    def place(x, y):
        return (x, y) if flat else AT + TURN @ (x, y, 0.0)

    def about(x, y, z):
        return TURN @ (x, y, z)
    axis, model = ({} if flat else {"axis": -TURN[:, 2]}), Model(planar=flat)
    for name, x, y in (("hub", -2.0, -1.0), ("p", -1.0, 1.0), ("pin", 0.6, 0.9),
                       ("r", 2.0, 1.4), ("b", 3.5, -0.5)):
        model.node(name, place(x, y), "full" if name in ("hub", "p", "pin") else "translation")
    turns = () if flat else (TURN[:, 2],)
    model.rigid_body("drum", "hub", 4.0, 0.1 if flat else (0.1, 0.1, 0.1))
    model.revolute("hub", *turns, name="axle")
    model.fix("p")
    model.fix("r", "position")
    model.rigid_body("arm", "pin", 9.0, 3.0 if flat else (3.0, 3.0, 3.0))
    model.revolute("pin", *turns)
    model.attach("q", place(0.6, 0.2), "pin")
    model.point_mass("weight", "b", 6.0)
    model.gravity((0, -9.81) if flat else about(0, -9.81, 0))
    for name, node, radius, inertia in (("barrel", "hub", 0.3, 0.0), ("wheel", "p", 0.25, 0.02),
                                        ("swung", "q", 0.2, 0.0)):
        model.sheave(name, node, radius, inertia=inertia, **axis)
    sides = "--+" if flat else "++-"        # axes are against the normal in space
    rope = model.rope("rope", ("barrel", "wheel", "swung", "r", "b"), 2e4, damping=50.0,
                      wrap=sides, length=9.0)
    model.torque("hub", *([35.0] if flat else [35.0 * TURN[:, 2]]))
    return model, rope


@pytest.mark.parametrize("flat", [True, False])
def test_ropes_are_drawn_along_tangents_and_arcs(flat, tmp_path):
    """On the circles, at right angles to their radii, on their sides, and as long as the rope."""
    model, rope = hauled(flat)
    result = simulate(model, 2e-3, 0.5)
    drawn = scenery(result, 60)
    n = np.array([0, 0, 1.0]) if flat else TURN[:, 2]
    first, last, spoke = drawn.ropes
    centre = drawn.nodes["p"].position
    rays = spoke.points[:, 1] - centre
    assert np.linalg.norm(rays, axis=1) == pytest.approx(0.25, rel=1e-12)
    turned = np.arctan2(np.cross(rays[0], rays) @ n, rays @ rays[0])
    angle = result["wheel.angle"][drawn.states] * (1.0 if flat else -1.0)   # about its own axis
    assert np.exp(1j * turned) == pytest.approx(np.exp(1j * angle), abs=1e-9)
    assert np.ptp(angle) > 0.1
    assert not any(link.kind == "distance" for link in drawn.links)
    whole = np.concatenate([first.points, last.points], axis=1)
    names = [*first.places, *last.places]
    centres = np.stack([drawn.nodes[name].position for name in names], axis=1)
    radii = np.array([{"hub": 0.3, "p": 0.25, "q": 0.2}.get(name, 0.0) for name in names])
    out = whole - centres
    assert np.linalg.norm(out, axis=2) == pytest.approx(np.tile(radii, (len(out), 1)), abs=1e-9)
    long = 0.0
    for k, (one, other) in enumerate(zip(names, names[1:], strict=False)):
        way = whole[:, k + 1] - whole[:, k]
        long = long + np.linalg.norm(way, axis=1)
        if one == other:
            continue
        for at in (k, k + 1):       # a span, which touches the circles at its ends
            side = {"hub": -1.0, "p": -1.0, "q": 1.0}.get(names[at], 0.0)
            assert np.einsum("fi,fi->f", way, out[:, at]) == pytest.approx(0.0, abs=SEEN)
            moment = np.cross(out[:, at], way) @ n
            assert moment == pytest.approx(side * radii[at] * np.linalg.norm(way, axis=1),
                                           abs=SEEN)
    chords = 2e-4       # of arcs, which are a little longer
    assert long == pytest.approx(result["rope.length"][drawn.states], rel=chords)
    assert np.ptp(out[:, names.index("q")], axis=0).max() > 0.01       # contacts move
    for part, span in ((first, 0), (last, 1)):
        tension = result["rope.tension"][drawn.states, span]
        assert not tension[part.slack].any() and part.slack[0]
        assert not part.slack[tension > 1.0].any() and tension.max() > 50.0
    animate(result, tmp_path / "rope.html")
    assert '"ropes":[{"name":"rope","nodes":[' in (tmp_path / "rope.html").read_text()


def test_slack_ropes_are_pale_in_films(tmp_path):
    from sebody.pictures import film

    drawn = scenery(simulate(hauled(True)[0], 2e-3, 0.5), 60)
    slack, taut = (int(np.argmax(drawn.ropes[1].slack == one)) for one in (True, False))
    for frame, colour in ((slack, SLACK), (taut, ROPE)):
        picture, = film.pictures(drawn, "", [frame], None)
        near = np.abs(picture - 255 * np.array(rgb(colour))).max(axis=2) < 12
        assert near.sum() > 100
