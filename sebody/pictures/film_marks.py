"""Links, signs, paths and loads of a film."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sebody.pictures.contact_surfaces import ContactSurface, vertices_of
from sebody.pictures.palette import (
    BODIES,
    CONTACT,
    DRIVE,
    GROUND,
    JOINT,
    LINK,
    LOAD,
    ROPE,
    SLACK,
    SPRING,
    rgb,
)
from sebody.pictures.plots import ACCENT
from sebody.pictures.rendering import Eye, Painter, Solid, ribbon
from sebody.pictures.scene import Scenery

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HALF, THIN = 0.007, 0.003       # half the width of links and of ropes, of the model's extent
ARROW = 0.2             # length of the largest force, of the model's extent
TURN = 0.07             # radius of the largest torque, likewise
SKIN, LINES = 0.14, 1.0     # opacities of contact surfaces
SHAPES = {"ground": ("^", GROUND), "drive": ("o", DRIVE), "mass": ("o", JOINT)}


class Marks:
    """Marks that are drawn besides bodies, moved from picture to picture."""

    def __init__(self, axes: "Axes", drawn: Scenery, eye: Eye) -> None:
        self._drawn, self._eye, self._axes = drawn, eye, axes
        self._trace = eye.seen(drawn.nodes[drawn.farthest].position)
        self._path, = axes.plot([], [], color=ACCENT, linewidth=1.2, zorder=2)
        self._springs, = axes.plot([], [], color=SPRING, linewidth=1.6, zorder=4)
        self._marks = [(self._mark(sign.kind), sign.node) for sign in drawn.signs]
        self._loads: list = []
        self._largest = {kind: max((np.linalg.norm(one.values, axis=1).max()
                                    for one in drawn.arrows if one.kind == kind), default=1.0)
                         for kind in ("force", "torque")}
        self._contacts = Painter(axes, zorder=1.2)      # behind all bodies
        self._colours = {k: entry.colour for entry in drawn.entries for k in entry.links}

    def draw(self, k: int) -> None:
        """Signs, contact surfaces, springs, the path so far and loads in a frame."""
        self._draw_contacts(k)
        nodes = self._drawn.nodes
        self._path.set_data(*self._trace[:k + 1, :2].T)
        self._springs.set_data(*self._zigzags(k))
        for mark, node in self._marks:
            mark.set_data(*self._eye.seen(nodes[node].position[k:k + 1])[:, :2].T)
        for load in self._loads:
            load.remove()
        self._loads = [self._arrow(line) for line in self._arrows(k)]

    def _draw_contacts(self, k: int) -> None:
        """Contact surfaces in a frame."""
        self._contacts.draw(self._eye, [solid for one in self._drawn.contacts
                                        for solid in self._skin_and_lines(one, k)])

    def _skin_and_lines(self, one: ContactSurface, k: int) -> list[Solid]:
        points, shape = vertices_of(one, self._drawn.nodes, k), one.shape
        colour = np.array(rgb(CONTACT))
        return [Solid(points, shape.triangles, colour, shape.lines[:0], SKIN),
                Solid(points, shape.triangles[:0], colour, shape.lines, LINES, CONTACT)]

    def links(self, k: int) -> list[tuple[NDArray, str, float]]:
        """Flat polygons of links and ropes in a frame, their colours and depths."""
        polygons = []
        for number, link in enumerate(self._drawn.links):
            if link.kind != "spring":
                ends = self._ends(link.ends, k)
                colour = self._colours.get(number, BODIES[0]) if link.kind == "body" else LINK
                polygons.append((ribbon(ends, HALF), colour, float(ends[:, 2].mean())))
        for rope in self._drawn.ropes:
            points, colour = self._eye.seen(rope.points[k]), SLACK if rope.slack[k] else ROPE
            polygons += [(ribbon(ends, THIN), colour, float(ends[:, 2].mean()))
                         for ends in np.stack([points[:-1], points[1:]], axis=1)]
        return polygons

    def _ends(self, names: tuple[str, str], k: int) -> NDArray:
        return self._eye.seen(np.array([self._drawn.nodes[name].position[k] for name in names]))

    def _mark(self, kind: str):
        shape, colour = SHAPES.get(kind, ("o", JOINT))
        mark, = self._axes.plot([], [], shape, color=colour, zorder=1.5 if shape == "^" else 4,
                                markersize=10 if shape == "^" else 4.5)
        return mark

    def _zigzags(self, k: int) -> tuple[NDArray, NDArray]:
        """Springs, with gaps between them."""
        part = np.linspace(0.0, 1.0, 17)
        side = np.where((part > 0.1) & (part < 0.9), 2 * HALF * (-1.0)**np.arange(17), 0.0)
        points = [np.zeros((0, 2))]
        for link in self._drawn.links:
            if link.kind == "spring":
                a, b = self._ends(link.ends, k)[:, :2]
                aside = np.array([a[1] - b[1], b[0] - a[0]]) / max(np.linalg.norm(b - a), 1e-12)
                points += [a + part[:, None] * (b - a) + side[:, None] * aside,
                           [[np.nan, np.nan]]]
        return tuple(np.concatenate(points).T)

    def _arrows(self, k: int) -> list[NDArray]:
        """Lines (n, 2) of the loads in a frame."""
        lines, size = [], self._eye.size
        bodies = {body.name: body for body in self._drawn.bodies}
        for arrow in self._drawn.arrows:
            value = arrow.values[k] / self._largest[arrow.kind]
            long = np.linalg.norm(value)
            if long < 0.01:
                continue
            at = (bodies[arrow.at].origin[k] if arrow.on_body
                  else self._drawn.nodes[arrow.at].position[k])
            if arrow.kind == "force":
                line = at + np.outer([0.0, 1.0], ARROW * size * value * (0.15 / long + 0.85))
            else:
                line = at + _turn(value / long) * TURN * size * (0.35 + 0.65 * long)
            lines.append(self._eye.seen(line)[:, :2])
        return lines

    def _arrow(self, line: NDArray):
        """A line with a head at its end."""
        from matplotlib.patches import FancyArrowPatch
        from matplotlib.path import Path

        return self._axes.add_patch(FancyArrowPatch(
            path=Path(line), arrowstyle="-|>", mutation_scale=11, color=LOAD, linewidth=1.6,
            zorder=5, joinstyle="miter"))


def _turn(axis: NDArray) -> NDArray:
    """Three quarters of a circle about an axis, (n, 3)."""
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    angle = np.linspace(0.0, 1.5 * np.pi, 28)[:, None]
    return np.cos(angle) * side + np.sin(angle) * np.cross(axis, side)
