"""Curves of paths in pictures: what slides is on them, and they move with their node."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.pictures.contact_surfaces import contact_lines, vertices_of
from sebody.pictures.drawn_nodes import extent
from sebody.pictures.path_curves import APPROACH
from sebody.pictures.scene import scenery
from sebody.results import animate
from sebody.scenes import bridge

TURN = Rotation.from_rotvec((0.5, -0.8, 0.4)).as_matrix()
SHIFT = np.array([3.0, -1.0, 2.0])


def slotted(flat):
    """A bead in a curved slot of a turning disc, another one on a wire on the ground."""
    model = Model(planar=flat)

    def at(*points):
        points = np.array(points)
        return points if flat else points @ TURN[:, :2].T + SHIFT
    model.node("hub", at((0.0, 0.0))[0])
    model.rigid_body("disc", "hub", 1.0, 1.0 if flat else (1.0, 1.0, 1.0))
    model.revolute("hub", **({} if flat else {"axis": TURN[:, 2]}), name="axle")
    model.drive_angle("axle", (lambda t: 2.0 * t, lambda t: 2.0, lambda t: 0.0))
    u = np.linspace(0.0, 1.0, 7)
    slot, wire = at(*zip(u, 0.4 * u**2, strict=True)), at(*zip(2 * u, np.cos(3 * u), strict=True))
    for name, points, carrier, k in (("slot", slot, "hub", 2), ("wire", wire, None, 1)):
        model.node(f"bead of {name}", points[k], "translation")
        model.point_mass(f"mass of {name}", f"bead of {name}", 0.5)
        model.path(name, on=carrier, points=points, ends="straight")
        model.path_joint(f"bead of {name}", name, name=f"in {name}")
    model.gravity(-3.0 * (np.array([0.0, 1.0]) if flat else TURN[:, 1]))
    return model


def off(points, place):
    """Distance of a place from the lines between points."""
    begin, way = points[:-1], np.diff(points, axis=0)
    u = np.clip(np.sum((place - begin) * way, axis=1) / np.sum(way * way, axis=1), 0.0, 1.0)
    return np.linalg.norm(begin + u[:, None] * way - place, axis=1).min()


@pytest.mark.parametrize("flat", [True, False])
def test_what_slides_is_on_its_curve(flat):
    result = simulate(slotted(flat), 2e-3, 0.3)
    drawn = scenery(result, 31)
    curves = {one.name: one for one in drawn.contacts if one.kind == "curve"}
    assert {name: one.node for name, one in curves.items()} == {"slot": "hub", "wire": None}
    for name, one in curves.items():
        assert not len(one.shape.triangles) and len(one.shape.points) == 6 * 8 + 1
        first, *_, last = (vertices_of(one, drawn.nodes, k) for k in range(len(drawn.t)))
        for k, state in enumerate(drawn.states):
            place = np.resize(np.r_[result[f"bead of {name}.position"][state], 0.0], 3)
            assert off(vertices_of(one, drawn.nodes, k), place) < 2e-3
        assert (np.abs(last - first).max() > 0.3) == (name == "slot")


@pytest.mark.filterwarnings("ignore")
def test_approaches_are_drawn_near_their_bridge(tmp_path):
    """Both, a part of the extent long, at the height of the supports."""
    result = simulate(bridge.build().model, 2e-3, 0.1)
    drawn = scenery(result, 5)
    size = extent(drawn.nodes)
    found = [one.shape.points for one in drawn.contacts if one.kind == "curve"]
    assert [points[:, 0].min() for points in found] == pytest.approx([-APPROACH * size, 60.0])
    assert [points[:, 0].max() for points in found] == pytest.approx([0.0, 60 + APPROACH * size])
    assert not np.any([points[:, 1:] for points in found])
    assert len(contact_lines(result.model, drawn.nodes, size)) == 3 * sum(
        len(points) - 1 for points in found)
    page = animate(result, tmp_path / "page.html").read_text()
    assert page.count('"kind":"curve"') == 2
